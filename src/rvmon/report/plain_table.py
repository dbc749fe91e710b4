"""Rows of text as a table for the terminal, without lines."""

from __future__ import annotations

from collections.abc import Sequence


def plain_table(rows: Sequence[Sequence[str]]) -> str:
    """A line per row, columns aligned.

    Args:
        rows: the first one is the head; all of one length.

    >>> print(plain_table([("", "verdict"), ("R1", "P")]), end="")
        verdict
    R1  P
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
    return "\n".join(lines) + "\n"
