"""The words of an item, canonical, with their comments; and pieces to lines: spaces and breaks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from rvmon.language.checked.operators import OPERATORS
from rvmon.language.syntax.keywords import OPERATOR_TERMINALS
from rvmon.language.syntax.parse import grammar

_CANONICAL = {
    **{text: op.entry.word for op in OPERATORS for text in op.spellings},
    "∞": "inf",
    "=": "==",
}
_REWRITTEN = (*OPERATOR_TERMINALS, "NOT", "INFINITE", "COMPARE")
_NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)[ \t]*(.*)", re.DOTALL)
_COMMENT = re.compile(r"#[^\n]*")
_OPENING = ("LPAR", "LSQB", "LBRACE", "CALL")
_CLOSING = ("RPAR", "RSQB", "RBRACE")


@dataclass(frozen=True, slots=True)
class Piece:
    """A token in canonical spelling.

    Attributes:
        kind: the terminal of the grammar.
        text: as it is printed.
        above: comments that stand on lines of their own before it.
        behind: the comment that ends its line, or empty.
        depth: the number of open brackets around it.
        opens_window: whether it is a round bracket that opens an interval.
    """

    kind: str
    text: str
    above: tuple[str, ...] = ()
    behind: str = ""
    depth: int = 0
    opens_window: bool = False


def pieces_of(text: str) -> tuple[list[Piece], str]:
    """The pieces of an item that can be read.

    Returns:
        The pieces, and what follows the last of them.
    """
    interactive: Any = grammar().parse_interactive(text, start="item")
    tokens = list(interactive.iter_parse())
    pieces: list[Piece] = []
    brackets: list[int] = []
    place = 0
    for token in tokens:
        gap = text[place : token.start_pos]
        above = [comment.rstrip() for comment in _COMMENT.findall(gap)]
        if pieces and above and "\n" not in gap[: gap.index("#")]:
            pieces[-1] = replace(pieces[-1], behind=above.pop(0))
        if pieces and pieces[-1].kind == "AT_END" and token.type != "COLON":
            colon = Piece("COLON", ":", behind=pieces[-1].behind)
            pieces[-1:] = replace(pieces[-1], behind=""), colon
        if token.type in _CLOSING:
            brackets.pop()
        elif token.type == "COMMA" and brackets and pieces[brackets[-1]].kind == "LPAR":
            # A round bracket with a comma of its own opens a window; nothing else has one there.
            pieces[brackets[-1]] = replace(pieces[brackets[-1]], opens_window=True)
        canonical = _canonical(token.type, str(token))
        pieces.append(Piece(token.type, canonical, tuple(above), depth=len(brackets)))
        if token.type in _OPENING:
            brackets.append(len(pieces) - 1)
        place = token.end_pos
    rest = text[place:]
    comment = re.match(r"[ \t]*(#[^\n]*)", rest)
    if comment:
        pieces[-1] = replace(pieces[-1], behind=comment[1].rstrip())
        rest = rest[comment.end() :]
    return pieces, rest


def _canonical(kind: str, text: str) -> str:
    if kind == "STRING":
        return text
    if kind == "NUMBER":
        found = _NUMBER.match(text)
        return f"{found[1]} {found[2]}".rstrip() if found else text
    words = " ".join(text.split())
    if kind in _REWRITTEN:
        return _CANONICAL.get(words, words)
    if kind == "PATH":
        return words.replace(" ", "")
    return words


WIDTH = 100
"""Longer lines are broken where operators or commas allow it."""

_OPERATORS = ("LEADS_TO", "IFF", "IMPLIES", "OR", "XOR", "AND", "INFIX")
"""The operators at which long formulas are broken, the loosest first."""

_TAKES_WINDOW = ("TEMPORAL", "INFIX", "PATH", "CTL", "QUANTIFIER", "LEADS_TO")
_PLAIN = re.compile(r"\d+(\.\d+)?([eE][+-]?\d+)?")
_OPERANDS = ("NAME", "NUMBER", "RPAR", "RSQB", "TRUTH", "START", "END", "STRING")


def lines_of(pieces: Sequence[Piece], indent: int) -> list[str]:
    """Lay out what belongs on one line, in several lines if it is long or holds comments.

    Args:
        pieces: at least one.
        indent: columns before the first line; further lines have two more.
    """
    lines: list[str] = []
    step = indent
    for segment in _segments(pieces):
        lines += [" " * step + comment for comment in segment[0].above]
        lines += _wrapped(segment, step)
        if segment[-1].behind:
            lines[-1] += f"  {segment[-1].behind}"
        step = indent + 2
    return lines


def text_of(pieces: Sequence[Piece]) -> str:
    """Pieces on one line."""
    if not pieces:
        return ""
    text = pieces[0].text
    before = ""
    for left, right in pairwise(pieces):
        unary = left.kind == "MINUS" and before not in _OPERANDS
        text += ("" if unary or not _spaced(left, right) else " ") + right.text
        before = left.kind
    return text


def _spaced(left: Piece, right: Piece) -> bool:
    if left.kind in _OPENING or right.kind in (*_CLOSING, "COMMA", "COLON"):
        return False
    window = right.kind == "LSQB" or right.opens_window
    return not (window and left.kind in _TAKES_WINDOW)


def _segments(pieces: Sequence[Piece]) -> list[list[Piece]]:
    """Cut before comments on their own line, behind those that end a line, and where it matters."""
    segments = [[pieces[0]]]
    for left, right in pairwise(pieces):
        if left.behind or right.above or _would_be_unit(left, right):
            segments.append([])
        segments[-1].append(right)
    return segments


def _would_be_unit(left: Piece, right: Piece) -> bool:
    """Whether a name would be read as the unit of the number before it, on one line."""
    plain = left.kind == "NUMBER" and _PLAIN.fullmatch(left.text) is not None
    return plain and right.kind in ("NAME", "CALL")


def _wrapped(pieces: Sequence[Piece], indent: int) -> list[str]:
    line = " " * indent + text_of(pieces)
    if len(line) <= WIDTH or len(pieces) == 1:
        return [line]
    if pieces[0].kind == "COVERPOINT" and any(piece.kind == "RBRACE" for piece in pieces):
        return _a_line_per_bin(pieces, indent)
    parts = _cut_at_operators(pieces) or _cut_at_commas(pieces, indent)
    if len(parts) < 2:
        return [line]
    lines = _wrapped(parts[0], indent)
    for part in parts[1:]:
        lines += _wrapped(part, indent + 2)
    return lines


def _a_line_per_bin(pieces: Sequence[Piece], indent: int) -> list[str]:
    kinds = [piece.kind for piece in pieces]
    start, end = kinds.index("LBRACE") + 1, len(kinds) - kinds[::-1].index("RBRACE") - 1
    depth = pieces[start].depth
    commas = [n + 1 for n in range(start, end) if kinds[n] == "COMMA" and pieces[n].depth == depth]
    lines = [" " * indent + text_of(pieces[:start])]
    for first, last in pairwise([start, *commas, end]):
        lines += _wrapped(pieces[first:last], indent + 2)
    return [*lines, " " * indent + text_of(pieces[end:])]


def _cut_at_operators(pieces: Sequence[Piece]) -> list[Sequence[Piece]]:
    """Cut before the loosest operators that stand within the fewest brackets."""
    places = [
        (piece.depth, _OPERATORS.index(piece.kind), number)
        for number, piece in enumerate(pieces)
        if number and piece.kind in _OPERATORS
    ]
    cuts = [number for *how, number in places if tuple(how) == min(places)[:2]]
    return [pieces[a:b] for a, b in pairwise([0, *cuts, len(pieces)])] if cuts else []


def _cut_at_commas(pieces: Sequence[Piece], indent: int) -> list[Sequence[Piece]]:
    """Cut behind the last comma of the fewest brackets that still fits on the line."""
    depths = [piece.depth for piece in pieces[:-1] if piece.kind == "COMMA"]
    if not depths:
        return []
    best = 0
    for number, piece in enumerate(pieces[:-1], 1):
        if piece.kind == "COMMA" and piece.depth == min(depths):
            fits = indent + len(text_of(pieces[:number])) <= WIDTH
            if best == 0 or fits:
                best = number
    return [pieces[:best], pieces[best:]]
