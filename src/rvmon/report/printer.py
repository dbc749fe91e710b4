"""Text for people: lines of pieces in styles, sentences and tables, as wide as the terminal."""

from __future__ import annotations

import io
import os
import sys
import textwrap
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from itertools import chain, zip_longest
from typing import TextIO

from rvmon.diagnostics import RESET, columns_of, wants_colour
from rvmon.texts import shown, shown_line

Piece = str | tuple[str, str]  # a text, or a text with its style: words of `_CODES`
Line = list[Piece]  # the pieces of a line
Cell = Piece | Line  # what stands in a table

_Styled = list[tuple[str, str]]

_CODES = {
    "bold": "1",
    "dim": "2",
    "italic": "3",
    "red": "31",
    "green": "32",
    "yellow": "33",
    "bright_black": "90",
}

_USUAL_WIDTH = 80  # columns where there is no terminal

_GAP = "   "
_NARROWEST = 12  # the least columns of a column that is wrapped


class Printer:
    """Prints to a terminal or a file, which obeys nothing that a text says.

    Args:
        file: to print to; default standard output.
        width: columns of a line; default those of the terminal.
        has_colour: whether styles are shown; default: if the file is a terminal that shows them.
    """

    def __init__(
        self,
        file: TextIO | None = None,
        width: int | None = None,
        *,
        has_colour: bool | None = None,
    ) -> None:
        self._file = sys.stdout if file is None else file
        self._has_colour = wants_colour(self._file) if has_colour is None else has_colour
        self.width = _terminal_width() if width is None else width  # columns of a line
        self._is_below_table = False

    def line(self, *pieces: Piece) -> None:
        """Print pieces, which may be of several lines, and end the line."""
        self._file.write("".join(map(self._drawn, pieces)) + "\n")
        self._is_below_table = False

    def sentences(self, text: str, style: str = "") -> None:
        """Print a text in lines that fit; its own line breaks are kept."""
        lines = (textwrap.fill(line, self.width) for line in text.split("\n"))
        self.line(("\n".join(lines), style))

    def table(
        self,
        heads: Sequence[Cell],
        rows: Sequence[Sequence[Cell]],
        right: Collection[int] = (),
        *,
        over: Sequence[Cell] = (),
        foot: Sequence[Cell] = (),
        wraps: Collection[int] | None = None,
        is_cut: bool = False,
    ) -> None:
        """Print a table between blank lines, of which two tables share one.

        Args:
            heads: of its columns.
            rows: of one cell for each column.
            right: places of the columns that are aligned to the right.
            over: a line of heads above the others.
            foot: a row below a blank line.
            wraps: places of the columns that are wrapped where the table does not fit, if a cell
                is of one piece; default: the last.
            is_cut: whether what does not fit is cut there, so that a row is one line.
        """
        head = [_bold(row) for row in (over, heads) if row]
        cells = [*head, *([_cell(cell) for cell in row] for row in rows)]
        cells += [_bold(foot)] if foot else []
        wraps = [len(heads) - 1] if wraps is None else wraps
        blocks, width = self._lines(cells, _GAP, right, wraps, is_cut=is_cut)
        if foot:
            blocks.insert(-1, [""])
        blocks.insert(len(head), [" " + "─" * width])
        blank = [] if self._is_below_table else [""]
        self._file.write("\n".join([*blank, *chain.from_iterable(blocks), "", ""]))
        self._is_below_table = True

    def columns(
        self,
        rows: Sequence[Sequence[Cell]],
        right: Collection[int] = (),
        *,
        wraps: Collection[int] = (),
    ) -> None:
        """Print rows without heads, in columns."""
        cells = [[_cell(cell) for cell in row] for row in rows]
        for line in chain.from_iterable(self._lines(cells, _GAP[1:], right, wraps)[0]):
            self._file.write(f"{line}\n")
        self._is_below_table = False

    def fits(self, rows: Sequence[Sequence[Cell]]) -> bool:
        """Whether a table of rows fits without wrapping."""
        widths = _widths([[_cell(cell) for cell in row] for row in rows])
        return sum(widths) + len(_GAP) * (len(widths) - 1) + 2 <= self.width

    def _lines(
        self,
        rows: Sequence[Sequence[_Styled]],
        gap: str,
        right: Collection[int],
        wraps: Collection[int],
        *,
        is_cut: bool = False,
    ) -> tuple[list[list[str]], int]:
        """The lines of each row, and the columns that the table takes."""
        widths = _widths(rows)
        between = len(gap) * (len(widths) - 1)
        while sum(widths) + between > self.width - 2 and wraps:
            widest = max(wraps, key=widths.__getitem__)
            if widths[widest] <= _NARROWEST:
                break
            widths[widest] -= 1
        is_right = [place in right for place in range(len(widths))]
        blocks = [
            [
                f" {gap.join(map(self._padded, line, widths, is_right))}".rstrip()
                for line in _folded(row, widths, wraps, is_cut=is_cut)
            ]
            for row in rows
        ]
        return blocks, sum(widths) + between

    def _padded(self, cell: _Styled, width: int, is_right: bool) -> str:
        blank = " " * (width - _size(cell))
        drawn = "".join(map(self._drawn, cell))
        return blank + drawn if is_right else drawn + blank

    def _drawn(self, piece: Piece) -> str:
        text, style = _styled(piece)
        if not (text and style and self._has_colour):
            return shown(text)
        return f"\x1b[{';'.join(_CODES[word] for word in style.split())}m{shown(text)}{RESET}"


TEXT_WIDTH = 100  # columns of a text that is written to a file


def text_of(show: Callable[[Printer], object]) -> str:
    r"""What a function prints, as a text without styles.

    >>> text_of(lambda printer: printer.columns([("R1", "P"), ("R10", "F")]))
    ' R1   P\n R10  F\n'
    """
    text = io.StringIO()
    show(Printer(text, TEXT_WIDTH, has_colour=False))
    return text.getvalue()


def plain(line: Line) -> str:
    """A line without its styles."""
    return "".join(text for text, _ in map(_styled, line))


def _styled(piece: Piece) -> tuple[str, str]:
    return (piece, "") if isinstance(piece, str) else piece


def _cell(cell: Cell) -> _Styled:
    pieces = cell if isinstance(cell, list) else [cell]
    return [(shown_line(text), style) for text, style in map(_styled, pieces)]


def _bold(row: Sequence[Cell]) -> list[_Styled]:
    return [[(text, style or "bold") for text, style in _cell(cell)] for cell in row]


def _size(cell: _Styled) -> int:
    return sum(columns_of(text) for text, _ in cell)


def _widths(rows: Sequence[Sequence[_Styled]]) -> list[int]:
    return [max(map(_size, column)) for column in zip(*rows, strict=True)]


def _folded(
    row: Sequence[_Styled], widths: Sequence[int], wraps: Collection[int], *, is_cut: bool
) -> Iterator[Sequence[_Styled]]:
    """The lines of a row, of which cells of one piece have several where they do not fit."""
    columns: list[list[_Styled]] = [[cell] for cell in row]
    for place in wraps:
        if len(row[place]) == 1 and _size(row[place]) > widths[place]:
            [(text, style)] = row[place]
            lines = textwrap.wrap(text, widths[place])
            if is_cut:
                lines = [f"{text[: widths[place] - 1]}…"]
            columns[place] = [[(line, style)] for line in lines]
    yield from zip_longest(*columns, fillvalue=[])


def _terminal_width() -> int:
    """The columns of the terminal, also where only what is typed or complained of is at one."""
    given = os.environ.get("COLUMNS", "")
    if given.isascii() and given.isdigit():
        return int(given) or _USUAL_WIDTH
    for stream in range(3):
        with suppress(OSError):  # it is closed, or none
            return os.get_terminal_size(stream).columns or _USUAL_WIDTH
    return _USUAL_WIDTH
