"""Formats a specification in the canonical layout and keeps its meaning and its comments.

Each item is turned into pieces (tokens in canonical spelling, with their comments), and the pieces
are laid out in lines.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from msgspec import Struct
from msgspec.structs import replace

from rvmon.diagnostics import Source, render_full
from rvmon.errors import SpecError
from rvmon.language.checked.operators import OPERATORS
from rvmon.language.rules import Findings
from rvmon.language.syntax.keywords import OPERATOR_TERMINALS, split_items
from rvmon.language.syntax.parse import grammar, parse_spec

_CLAUSES = {
    "UPON", "WHENEVER", "THEN", "MONITOR_AS_RESPONSE", "MONITOR_AS_WRITTEN", "MONITOR_AS_COVER",
    "TEXT_CLAUSE", "SEVERITY", "TAGS", "LET", "FOR_EACH", "AT_END", "PROPERTY", "SCOPE",
    "RUN_SHARE", "GOAL", "WEIGHT", "UNWANTED",
}  # fmt: skip
"""Terminals that start a new line inside an item."""


class Block(Struct):
    """An item with its layout."""

    pieces: list[Piece]
    lines: list[str]  # its layout; until `_align` that of the item alone
    before: list[str]  # comments and blank lines between the previous item and this one


def format_text(text: str, *, name: str = "<string>") -> str:
    r"""Format a specification in the canonical layout.

    Args:
        text: a specification without syntax errors.
        name: its name in messages.

    Raises:
        SpecError: an item has a syntax error.

    >>> format_text("requirement R G(a->F b)")
    'requirement R\n  always (a -> eventually b)\n'
    """
    findings = Findings()
    parse_spec(Source(name, text), findings)
    if findings.diagnostics:
        raise SpecError(findings.diagnostics, render_full(findings.diagnostics))
    places = split_items(text)
    if not places:
        remarks = "\n".join(_gap_lines(text.split("\n"))).strip("\n")
        return f"{remarks}\n" if remarks else ""
    blocks: list[Block] = []
    gap = text[: places[0][0]].split("\n")[:-1]
    for start, end in places:
        pieces, rest = pieces_of(text[start:end])
        comments, following = _own_comments(rest)
        lines = _item_lines(pieces) + [f"  {comment}" for comment in comments]
        blocks.append(Block(pieces, lines, _gap_lines(gap)))
        gap = following.split("\n")[1:-1] if end < len(text) else following.split("\n")[1:]
    _align(blocks)
    return _joined(blocks, _gap_lines(gap))


def _item_lines(pieces: Sequence[Piece]) -> list[str]:
    """The head of an item on the first line, then one line for each clause."""
    clauses: list[list[Piece]] = [[pieces[0]]]
    for number, piece in enumerate(pieces[1:], 1):
        if _starts_line(pieces, number):
            clauses.append([])
        clauses[-1].append(piece)
    lines = []
    for number, clause in enumerate(clauses):
        lines += lines_of(clause, 2 if number else 0)
    return lines


def _starts_line(pieces: Sequence[Piece], number: int) -> bool:
    piece = pieces[number]
    if piece.kind in _CLAUSES and piece.depth == 0:
        return piece.kind != "THEN" or not _within_choice(pieces[:number])
    if pieces[0].kind != "REQUIREMENT":
        return False
    # A bare formula has no keyword that starts its line. It follows the name and the text, if any.
    return number == (3 if pieces[2].kind == "STRING" else 2)


def _within_choice(before: Sequence[Piece]) -> bool:
    """Whether the next `then` belongs to an `if` rather than to the requirement."""
    kinds = [piece.kind for piece in before if piece.depth == 0]
    return kinds.count("IF") > kinds.count("ELSE")


def _own_comments(rest: str) -> tuple[list[str], str]:
    """The indented comments right below an item, which belong to it, and the remaining text."""
    comments = []
    while comment := re.match(r"\n[ \t]+(#[^\n]*)", rest):
        comments.append(comment[1].rstrip())
        rest = rest[comment.end() :]
    return comments, rest


def _gap_lines(lines: Sequence[str]) -> list[str]:
    """The lines between items: comments at the left margin, no two blank lines in a row."""
    kept: list[str] = []
    for line in lines:
        comment = line.strip()
        if comment or not kept or kept[-1]:
            kept.append(comment)
    return kept


def _align(blocks: Sequence[Block]) -> None:
    """Align runs of adjacent declarations in columns."""
    runs: list[list[Block]] = [[]]
    for block in blocks:
        row = block.pieces[0].kind in ("SIGNAL", "EVENT") and len(block.lines) == 1
        if not row or block.before:
            runs.append([])
        if row:
            runs[-1].append(block)
    for run in runs:
        lines = aligned([block.pieces for block in run])
        # One long declaration must not widen the columns of all others.
        if all(len(line) <= WIDTH for line in lines):
            for block, line in zip(run, lines, strict=True):
                block.lines = [line]


Row = tuple[str, str, str, str, str]
"""The cells of a declaration: word, names, type, role, and `ignore NaN` with `stale after`."""


def aligned(items: Sequence[Sequence[Piece]]) -> list[str]:
    """One line per `signal` or `event`, with names, types and roles in columns."""
    rows = [_row(pieces) for pieces in items]
    typed = [row for row in rows if row[2]]
    word = max(len(row[0]) for row in rows) if rows else 0
    names, types, roles = (max((len(row[n]) for row in typed), default=0) for n in (1, 2, 3))
    lines = []
    for (item, listed, type_, role, stale), pieces in zip(rows, items, strict=True):
        cells = (
            [f"{listed:<{names}} {type_:<{types}}", f"{role:<{roles}}"] if type_ else [listed, role]
        )
        cells += [stale, next((piece.comment_after for piece in pieces if piece.comment_after), "")]
        lines.append(
            "  ".join([f"{item:<{word}} {cells[0]}", *filter(str.strip, cells[1:])]).rstrip()
        )
    return lines


def _row(pieces: Sequence[Piece]) -> Row:
    def first(kinds: Sequence[str], otherwise: int) -> int:
        alone = (n for n, piece in enumerate(pieces) if piece.kind in kinds and not piece.depth)
        return next(alone, otherwise)

    end = len(pieces)
    stale = first(("IGNORE_NAN", "STALE_AFTER"), end)
    role = first(("ROLE",), stale)
    colon = first(("COLON",), role)
    texts = (pieces[1:colon], pieces[colon:role], pieces[role:stale], pieces[stale:end])
    return pieces[0].text, *map(text_of, texts)  # type: ignore[return-value]  # four of them


def _joined(blocks: Sequence[Block], end: Sequence[str]) -> str:
    """The whole text: blank lines stay, and one is added around each item of several lines."""
    lines: list[str] = []
    for number, block in enumerate(blocks):
        above = blocks[number - 1] if number else None
        tall = any(
            one is not None and (one.pieces[0].kind == "REQUIREMENT" or len(one.lines) > 1)
            for one in (above, block)
        )
        if tall and (not block.before or block.before[0]):
            lines.append("")
        lines += block.before
        lines += block.lines
    return "\n".join([*lines, *end]).strip("\n") + "\n"


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


class Piece(Struct, frozen=True):
    """A token in canonical spelling."""

    kind: str  # the terminal of the grammar
    text: str  # the canonical spelling
    comments_before: tuple[str, ...] = ()  # comments on lines of their own before it
    comment_after: str = ""  # the comment at the end of its line, or empty
    depth: int = 0  # the number of brackets around it
    opens_window: bool = False  # whether it is a round bracket that opens an interval


def pieces_of(text: str) -> tuple[list[Piece], str]:
    """The pieces of an item without syntax errors, and the text after the last piece."""
    interactive: Any = grammar().parse_interactive(text, start="item")
    tokens = list(interactive.iter_parse())
    pieces: list[Piece] = []
    brackets: list[int] = []
    place = 0
    for token in tokens:
        gap = text[place : token.start_pos]
        above = [comment.rstrip() for comment in _COMMENT.findall(gap)]
        if pieces and above and "\n" not in gap[: gap.index("#")]:
            pieces[-1] = replace(pieces[-1], comment_after=above.pop(0))
        # The grammar accepts `at end pass` and `at end: pass`; the second form is printed.
        if pieces and pieces[-1].kind == "AT_END" and token.type != "COLON":
            colon = Piece("COLON", ":", comment_after=pieces[-1].comment_after)
            pieces[-1:] = replace(pieces[-1], comment_after=""), colon
        if token.type in _CLOSING:
            brackets.pop()
        elif token.type == "COMMA" and brackets and pieces[brackets[-1]].kind == "LPAR":
            # Only an interval has a comma directly inside `(`: a call's bracket is part of `CALL`.
            pieces[brackets[-1]] = replace(pieces[brackets[-1]], opens_window=True)
        canonical = _canonical(token.type, str(token))
        pieces.append(Piece(token.type, canonical, tuple(above), depth=len(brackets)))
        if token.type in _OPENING:
            brackets.append(len(pieces) - 1)
        place = token.end_pos
    rest = text[place:]
    comment = re.match(r"[ \t]*(#[^\n]*)", rest)
    if comment:
        pieces[-1] = replace(pieces[-1], comment_after=comment[1].rstrip())
        rest = rest[comment.end() :]
    return pieces, rest


def _canonical(kind: str, text: str) -> str:
    if kind == "STRING":
        return text
    if kind == "NUMBER":
        number = _NUMBER.match(text)
        return f"{number[1]} {number[2]}".rstrip() if number else text
    words = " ".join(text.split())
    if kind in _REWRITTEN:
        return _CANONICAL.get(words, words)
    if kind == "PATH":
        return words.replace(" ", "")
    return words


WIDTH = 100  # longer lines are broken where operators or commas allow it

_OPERATORS = ("LEADS_TO", "IFF", "IMPLIES", "OR", "XOR", "AND", "INFIX")
"""The operators at which long formulas are broken, the loosest binding first."""

_TAKES_WINDOW = ("TEMPORAL", "INFIX", "PATH", "CTL", "QUANTIFIER", "LEADS_TO")
_PLAIN = re.compile(r"\d+(\.\d+)?([eE][+-]?\d+)?")
_OPERANDS = ("NAME", "NUMBER", "RPAR", "RSQB", "TRUTH", "START", "END", "STRING")


def lines_of(pieces: Sequence[Piece], indent: int) -> list[str]:
    """Lay pieces out on one line, or on several if they are long or have comments.

    The first line is indented by `indent` columns, continuation lines by two more.
    """
    lines: list[str] = []
    step = indent
    for segment in _segments(pieces):
        lines += [" " * step + comment for comment in segment[0].comments_before]
        lines += _wrapped(segment, step)
        if segment[-1].comment_after:
            lines[-1] += f"  {segment[-1].comment_after}"
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
    """Split pieces where a line break is needed.

    A break is needed before comments on their own lines, after comments that end a line, and where
    the meaning would change on one line.
    """
    segments = [[pieces[0]]]
    for left, right in pairwise(pieces):
        if left.comment_after or right.comments_before or _would_be_unit(left, right):
            segments.append([])
        segments[-1].append(right)
    return segments


def _would_be_unit(left: Piece, right: Piece) -> bool:
    """Whether a name would be read as the unit of the number before it if both share a line."""
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
    """Split before the outermost operators; of these, before those that bind most loosely."""
    places = [
        (piece.depth, _OPERATORS.index(piece.kind), number)
        for number, piece in enumerate(pieces)
        if number and piece.kind in _OPERATORS
    ]
    cuts = [number for *how, number in places if tuple(how) == min(places)[:2]]
    return [pieces[a:b] for a, b in pairwise([0, *cuts, len(pieces)])] if cuts else []


def _cut_at_commas(pieces: Sequence[Piece], indent: int) -> list[Sequence[Piece]]:
    """Split after an outermost comma: the last that fits on the line, or else the first."""
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
