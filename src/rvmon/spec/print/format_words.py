"""The words of an item as the formatter sees them: canonical, with their comments."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from rvmon.spec.checked.operators import OPERATORS
from rvmon.spec.syntax.parse import grammar
from rvmon.spec.syntax.words import OPERATOR_TERMINALS

_OPERATORS = {
    **{text: op.entry.word for op in OPERATORS for text in op.spellings},
    "∞": "inf",
    "=": "==",
}
_REWRITTEN = (*OPERATOR_TERMINALS, "NOT", "INFINITE", "COMPARE")
_NUMBER = re.compile(r"(\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)[ \t]*(.*)", re.DOTALL)
_COMMENT = re.compile(r"#[^\n]*")


@dataclass(frozen=True, slots=True)
class Piece:
    """A token in canonical spelling.

    Attributes:
        kind: the terminal of the grammar.
        text: as it is printed.
        above: comments that stand on lines of their own before it.
        behind: the comment that ends its line, or empty.
        depth: how many brackets are open around it.
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
    place = 0
    for token in tokens:
        gap = text[place : token.start_pos]
        above = _comments(gap)
        if pieces and above and "\n" not in gap[: gap.index("#")]:
            pieces[-1] = replace(pieces[-1], behind=above.pop(0))
        pieces.append(Piece(token.type, _canonical(token.type, str(token)), tuple(above)))
        place = token.end_pos
    rest = text[place:]
    comment = re.match(r"[ \t]*(#[^\n]*)", rest)
    if comment:
        pieces[-1] = replace(pieces[-1], behind=comment[1].rstrip())
        rest = rest[comment.end() :]
    return _with_colon(_with_windows(_with_depth(pieces))), rest


def _comments(gap: str) -> list[str]:
    return [comment.rstrip() for comment in _COMMENT.findall(gap)]


def _canonical(kind: str, text: str) -> str:
    if kind == "STRING":
        return text
    if kind == "NUMBER":
        found = _NUMBER.match(text)
        return f"{found[1]} {found[2]}".rstrip() if found else text
    words = " ".join(text.split())
    if kind in _REWRITTEN:
        return _OPERATORS.get(words, words)
    if kind == "PATH":
        return words.replace(" ", "")
    return words


_OPENING = ("LPAR", "LSQB", "LBRACE", "CALL")
_CLOSING = ("RPAR", "RSQB", "RBRACE")


def _with_depth(pieces: Sequence[Piece]) -> list[Piece]:
    found = []
    depth = 0
    for piece in pieces:
        depth -= piece.kind in _CLOSING
        found.append(replace(piece, depth=depth))
        depth += piece.kind in _OPENING
    return found


def _with_windows(pieces: list[Piece]) -> list[Piece]:
    """A round bracket with a comma of its own opens a window; nothing else has one there."""
    open_brackets: list[int] = []
    for number, piece in enumerate(pieces):
        if piece.kind in _OPENING:
            open_brackets.append(number)
        elif piece.kind in _CLOSING:
            open_brackets.pop()
        elif piece.kind == "COMMA" and open_brackets:
            opening = open_brackets[-1]
            if pieces[opening].kind == "LPAR":
                pieces[opening] = replace(pieces[opening], opens_window=True)
    return pieces


def _with_colon(pieces: list[Piece]) -> list[Piece]:
    """`at end` is followed by a colon."""
    found: list[Piece] = []
    for piece in pieces:
        if found and found[-1].kind == "AT_END" and piece.kind != "COLON":
            comment = found[-1].behind  # it ends the line of the colon then
            found[-1] = replace(found[-1], behind="")
            found.append(Piece("COLON", ":", behind=comment))
        found.append(piece)
    return found
