"""The canonical layout of a specification: same meaning, same comments, always the same form."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.diagnostics import Source, render_full
from rvmon.errors import SpecError
from rvmon.language.print.layout import WIDTH, Piece, lines_of, pieces_of, text_of
from rvmon.language.rules import Findings
from rvmon.language.syntax.keywords import split_items
from rvmon.language.syntax.parse import parse_spec

Row = tuple[str, str, str, str, str]
"""Word, names, type, role, what it ignores and its limit of staleness."""


def aligned(items: Sequence[Sequence[Piece]]) -> list[str]:
    """One line per declaration: their names, types and roles stand below each other.

    Args:
        items: pieces of `signal` and `event` items.
    """
    rows = [_row(pieces) for pieces in items]
    typed = [row for row in rows if row[2]]
    word = max(len(row[0]) for row in rows) if rows else 0
    names, types, roles = (max((len(row[n]) for row in typed), default=0) for n in (1, 2, 3))
    lines = []
    for (item, listed, type_, role, stale), pieces in zip(rows, items, strict=True):
        cells = (
            [f"{listed:<{names}} {type_:<{types}}", f"{role:<{roles}}"] if type_ else [listed, role]
        )
        cells += [stale, next((piece.behind for piece in pieces if piece.behind), "")]
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


_CLAUSES = frozenset(
    {
        *("UPON", "WHENEVER", "THEN", "MONITOR_AS_RESPONSE", "MONITOR_AS_WRITTEN"),
        "MONITOR_AS_COVER",
        *("TEXT_CLAUSE", "SEVERITY", "TAGS"),
        *(
            "LET",
            "FOR_EACH",
            "AT_END",
            "PROPERTY",
            "SCOPE",
            "RUN_SHARE",
            "GOAL",
            "WEIGHT",
            "UNWANTED",
        ),
    }
)
"""Terminals that start a line inside an item."""


@dataclass(slots=True)
class Block:
    """An item ready for print.

    Attributes:
        pieces: of the item.
        lines: as laid out by itself.
        before: comments and blank lines between the item above and this one.
    """

    pieces: list[Piece]
    lines: list[str]
    before: list[str]


def format_text(text: str, *, name: str = "<string>") -> str:
    r"""Lay a specification out in the canonical form.

    Args:
        text: a specification whose items can all be read.
        name: its name in messages.

    Raises:
        SpecError: an item cannot be read.

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
        own, following = _own_comments(rest)
        lines = _item_lines(pieces) + [f"  {comment}" for comment in own]
        blocks.append(Block(pieces, lines, _gap_lines(gap)))
        gap = following.split("\n")[1:-1] if end < len(text) else following.split("\n")[1:]
    _align(blocks)
    return _joined(blocks, _gap_lines(gap))


def _item_lines(pieces: Sequence[Piece]) -> list[str]:
    """The head on the first line, then a line for each clause."""
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
    return number == (3 if pieces[2].kind == "STRING" else 2)


def _within_choice(before: Sequence[Piece]) -> bool:
    """Whether an `if` waits for its `then`."""
    kinds = [piece.kind for piece in before if piece.depth == 0]
    return kinds.count("IF") > kinds.count("ELSE")


def _own_comments(rest: str) -> tuple[list[str], str]:
    """The indented comments right below an item, which belong to it; and what follows."""
    own = []
    while found := re.match(r"\n[ \t]+(#[^\n]*)", rest):
        own.append(found[1].rstrip())
        rest = rest[found.end() :]
    return own, rest


def _gap_lines(lines: Sequence[str]) -> list[str]:
    """Comments at the left margin, and never two blank lines in a row."""
    found: list[str] = []
    for line in lines:
        comment = line.strip()
        if comment or not found or found[-1]:
            found.append(comment)
    return found


def _align(blocks: Sequence[Block]) -> None:
    """Bring declarations that stand right below each other into columns."""
    runs: list[list[Block]] = [[]]
    for block in blocks:
        row = block.pieces[0].kind in ("SIGNAL", "EVENT") and len(block.lines) == 1
        if not row or block.before:
            runs.append([])
        if row:
            runs[-1].append(block)
    for run in runs:
        lines = aligned([block.pieces for block in run])
        if all(len(line) <= WIDTH for line in lines):
            for block, line in zip(run, lines, strict=True):
                block.lines = [line]


def _joined(blocks: Sequence[Block], end: Sequence[str]) -> str:
    """A blank line around whatever takes several lines, and where there was one."""
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
