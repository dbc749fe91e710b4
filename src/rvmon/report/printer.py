"""Reports as lines of text: pieces in styles, and tables, as wide as the terminal."""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from typing import TextIO

from rvmon.diagnostics import RESET, columns_of, wants_colour
from rvmon.texts import shown, shown_line

Piece = str | tuple[str, str]
"""A text, or a text with its style: words of `_CODES`."""

_CODES = {
    "bold": "1",
    "dim": "2",
    "italic": "3",
    "red": "31",
    "green": "32",
    "yellow": "33",
    "bright_black": "90",
}

_USUAL_WIDTH = 80
"""Columns where there is no terminal."""

_GAP = "   "
_NARROWEST = 12
"""The least columns of the last column of a table."""


class Printer:
    """Prints to a terminal or a file, which obeys nothing that a text says.

    Args:
        file: to print to; default standard output.
        width: columns of a line; default those of the terminal.

    Attributes:
        width: columns of a line.
    """

    def __init__(self, file: TextIO | None = None, width: int | None = None) -> None:
        self._file = sys.stdout if file is None else file
        self._has_colour = wants_colour(self._file)
        self.width = _terminal_width() if width is None else width

    def line(self, *pieces: Piece) -> None:
        """Print pieces, which may be of several lines, and end the line."""
        self._file.write("".join(map(self._drawn, pieces)) + "\n")

    def table(
        self,
        heads: Sequence[str],
        rows: Sequence[Sequence[Piece]],
        right: Collection[int] = (),
    ) -> None:
        """Print a table between blank lines; its last column is wrapped where it does not fit.

        Args:
            heads: of its columns.
            rows: of one cell for each column.
            right: places of the columns that are aligned to the right.
        """
        cells = [[(shown_line(head), "bold") for head in heads]]
        cells += ([(shown_line(text), style) for text, style in map(_styled, row)] for row in rows)
        sizes = [[columns_of(text) for text, _ in row] for row in cells]
        widths = [*map(max, zip(*sizes, strict=True))]
        others = sum(widths[:-1]) + len(_GAP) * (len(widths) - 1)
        widths[-1] = min(widths[-1], max(self.width - others - 2, _NARROWEST))
        is_right = [place in right for place in range(len(widths))]
        # The head is one line: the last column, which alone is wrapped, has room for its word.
        head, *body = (
            f" {_GAP.join(map(self._cell, line, taken, widths, is_right))}".rstrip()
            for row, own in zip(cells, sizes, strict=True)
            for line, taken in _lines(row, own, widths[-1])
        )
        rule = " " + "─" * (others + widths[-1])
        self._file.write("\n".join(["", head, rule, *body, "", ""]))

    def _cell(self, cell: tuple[str, str], taken: int, width: int, is_right: bool) -> str:
        blank = " " * (width - taken)
        drawn = self._drawn(cell)
        return blank + drawn if is_right else drawn + blank

    def _drawn(self, piece: Piece) -> str:
        text, style = _styled(piece)
        if not (text and style and self._has_colour):
            return shown(text)
        return f"\x1b[{';'.join(_CODES[word] for word in style.split())}m{shown(text)}{RESET}"


def _styled(piece: Piece) -> tuple[str, str]:
    return (piece, "") if isinstance(piece, str) else piece


def _lines(
    row: Sequence[tuple[str, str]], sizes: Sequence[int], width: int
) -> Iterator[tuple[Sequence[tuple[str, str]], Sequence[int]]]:
    """The lines of a row, of which only the last cell may have more than one, and their columns."""
    if sizes[-1] <= width:
        yield row, sizes
        return
    *others, (text, style) = row
    *taken, _ = sizes
    for line in textwrap.wrap(text, width):
        yield (*others, (line, style)), (*taken, columns_of(line))
        others, taken = [("", "")] * len(others), [0] * len(taken)


def _terminal_width() -> int:
    """The columns of the terminal, also where only what is typed or complained of is at one."""
    given = os.environ.get("COLUMNS", "")
    if given.isascii() and given.isdigit():
        return int(given) or _USUAL_WIDTH
    for stream in range(3):
        with suppress(OSError):  # it is closed, or none
            return os.get_terminal_size(stream).columns or _USUAL_WIDTH
    return _USUAL_WIDTH
