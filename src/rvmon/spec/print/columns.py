"""Declarations in columns."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.spec.print.format_words import Piece
from rvmon.spec.print.layout import text_of

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
    kinds = [piece.kind for piece in pieces]
    depths = [piece.depth for piece in pieces]
    cuts = [1]
    for cut in (("COLON",), ("ROLE",), ("IGNORE_NAN", "STALE_AFTER")):
        found = [n for n, kind in enumerate(kinds) if kind in cut and depths[n] == 0]
        cuts.append(found[0] if found else -1)
    end = len(pieces)
    stale = cuts[3] if cuts[3] >= 0 else end
    role = cuts[2] if cuts[2] >= 0 else stale
    colon = cuts[1] if cuts[1] >= 0 else role
    texts = (pieces[1:colon], pieces[colon:role], pieces[role:stale], pieces[stale:end])
    return pieces[0].text, *map(text_of, texts)  # type: ignore[return-value]
