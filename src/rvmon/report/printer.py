"""Text output for people: styled lines, sentences and tables that fit the terminal."""

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
from rvmon.texts import escaped, escaped_line

Piece = str | tuple[str, str]  # a text, or a text with its style, which is words of `_CODES`
Line = list[Piece]  # the pieces of a line
Cell = Piece | Line  # the content of a table cell

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

_USUAL_WIDTH = 80  # columns without a terminal

_GAP = "   "
_NARROWEST = 12  # the least width of a wrapped table column


class Printer:
    """Prints to a terminal or a file; control characters in texts are written as escapes.

    Args:
        file: to print to; default standard output.
        width: columns of a line; default those of the terminal.
        has_colour: whether to use styles; default: if the file is a terminal with colours.
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
        """Print pieces, which may contain line breaks, and end the line."""
        self._file.write("".join(map(self._drawn, pieces)) + "\n")
        self._is_below_table = False

    def sentences(self, text: str, style: str = "") -> None:
        """Print a text wrapped to the width; its own line breaks are kept."""
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
        """Print a table between blank lines; adjacent tables share one blank line.

        Args:
            heads: the column heads.
            rows: each with one cell per column.
            right: indices of the columns that are aligned to the right.
            over: a line of heads above `heads`.
            foot: a last row, separated by a blank line.
            wraps: indices of the columns that are narrowed if the table does not fit; only cells of
                one piece are wrapped. Default: the last column.
            is_cut: whether cells of these columns are cut instead, so that a row is one line.
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
        """Print rows in columns without heads; arguments as for `table`."""
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
        """The lines of each row, and the width of the table."""
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
            return escaped(text)
        return f"\x1b[{';'.join(_CODES[word] for word in style.split())}m{escaped(text)}{RESET}"


TEXT_WIDTH = 100  # columns of texts written to files


def text_of(show: Callable[[Printer], object]) -> str:
    r"""The output of a function that prints, as text without styles.

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
    return [(escaped_line(text), style) for text, style in map(_styled, pieces)]


def _bold(row: Sequence[Cell]) -> list[_Styled]:
    return [[(text, style or "bold") for text, style in _cell(cell)] for cell in row]


def _size(cell: _Styled) -> int:
    return sum(columns_of(text) for text, _ in cell)


def _widths(rows: Sequence[Sequence[_Styled]]) -> list[int]:
    return [max(map(_size, column)) for column in zip(*rows, strict=True)]


def _folded(
    row: Sequence[_Styled], widths: Sequence[int], wraps: Collection[int], *, is_cut: bool
) -> Iterator[Sequence[_Styled]]:
    """The lines of a row; cells in the columns `wraps` that do not fit have several."""
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
    """The columns of the terminal to which any of the three standard streams is connected."""
    given = os.environ.get("COLUMNS", "")
    if given.isascii() and given.isdigit():
        return int(given) or _USUAL_WIDTH
    for stream in range(3):
        with suppress(OSError):  # the stream is closed, or no terminal
            return os.get_terminal_size(stream).columns or _USUAL_WIDTH
    return _USUAL_WIDTH
