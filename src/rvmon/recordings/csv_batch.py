"""CSV text as columns, in blocks: what is odd is read by itself, and no more than that."""

from __future__ import annotations

import csv
import io
from collections.abc import Generator, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from rvmon.errors import TraceError
from rvmon.recordings.batch import NO_UPDATE, UNKNOWN, YES, Batch, Cells
from rvmon.recordings.cells import batch_of, cells_of_labels, kept
from rvmon.recordings.csv_rows import (
    NEVER_WRITTEN,
    Column,
    Layout,
    csv_samples,
    split_lines,
    unended,
)
from rvmon.recordings.csv_text import CsvText, native_csv
from rvmon.recordings.places import bounded_lines, is_short_of_memory
from rvmon.recordings.rows import Row
from rvmon.recordings.values import as_declared, scalar_of_text
from rvmon.trace.schema import Kind
from rvmon.trace.stamps import ticks_of_cell

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ALL, _ROW = 0, 2
"""The ways a call ends: with the text, or at an odd row; else its room is used up."""

_ODD = 4096  # cells of a call that are read one by one

_LABELS = 2048
"""Labels of a call that are told apart, at first: where there are more, of a later call more."""

_MOST_LABELS = 1 << 16  # from here on not


def csv_batches(
    text: CsvText[Found], layout: Layout, ignoring: frozenset[str]
) -> Iterator[Batch | Iterator[Row]]:
    """The rows of a text, in order.

    Raises:
        TraceError: with the line's number; the rows above it have been given out.
        UnicodeDecodeError: it is no text.
    """
    reader = _Reader(layout)
    if not (text.is_whole or is_short_of_memory()):  # each thread reserves some
        text.read_ahead(reader.read)
    try:
        while True:
            ended, end = yield from reader.batch(text)
            if ended == _ROW:
                before = text.line
                yield csv_samples(_split(text.cut(end), before), layout)
            elif ended == _ALL and not text.read_on():
                break
    finally:
        text.close()
    if text.start < len(text.rest):
        before = text.line
        tail = _split(text.cut(len(text.rest)), before)
        for line, t, values, text.lost in unended(tail, layout, ignoring):
            yield iter([(line, t, values)])


def _split(text: str, before: int) -> Iterator[tuple[int, list[str]]]:
    """The rows of a text before which so many lines stand."""
    return split_lines(bounded_lines(io.StringIO(text, newline=""), before), before)


class Found(Struct, frozen=True):
    """Rows of a text that were found together, and how far that came: see `csv.h`."""

    batch: Batch | None  # with lines as if the text began with line 0; `None`: there is no row
    fault: tuple[int, TraceError] | None  # what is wrong in the row behind it; its line, so counted
    ended: int  # the way it ended
    at: int  # the start of the rest
    end: int  # the end of an odd row
    lines: int  # those that were passed
    labels: int  # those that were told apart
    room: int  # the most labels that could be


class _Reader:
    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        no_update = layout.gaps.no_update
        self._absent = None if no_update is None else str(no_update).encode()
        self._row_bytes = 2.0 * len(layout.header)
        has_labels = any(column.kind is Kind.LABEL for column in layout.columns)
        self._labels = max(_LABELS if has_labels else 0, 1 + len(layout.columns))

    def read(self, text: bytes, start: int = 0, *, is_ended: bool = False) -> Found:
        """Find rows in a text from a place on, as far as one call can."""
        # If rows are as long as those before; for more, there is a second call.
        room = int(1.1 * (len(text) - start) / self._row_bytes) + 16
        columns = 1 + len(self.layout.columns)
        numbers = np.empty((columns, room), np.int64)
        says = np.empty((columns, room), np.uint8)
        lines = np.empty(room, np.int64)
        odd = np.empty((max(_ODD, columns), 4), np.int64)
        labels = np.empty((self._labels, 3), np.int64)
        table = np.zeros(2 * len(labels), np.int32)
        ended, rows, at, end, passed, odd_count, label_count = native_csv.read(
            text, start, is_ended, csv.field_size_limit(), *self.layout.numbers, self._absent,
            numbers, says, lines, odd, labels, table,
        )  # fmt: skip
        fault = None
        if (hole := text.find(b"\0", start, at)) >= 0:
            line = len(text[start : hole + 1].splitlines())
            rows = int(lines[:rows].searchsorted(line))
            fault = line, TraceError(NEVER_WRITTEN)
        # Cells that C does not read (other notations, quotes) go the way of single rows, so there
        # is one meaning.
        for row, place, *ends in odd[:odd_count].tolist():
            if row >= rows:
                break
            try:
                self._read_odd(_cell(text, *ends), place, row, numbers, says)
            except TraceError as error:
                rows, fault = row, (lines.item(row), error)
                break
        batch = None
        if rows:
            words = [(of, _cell(text, *ends)) for of, *ends in labels[:label_count].tolist()]
            cells = {
                column: self._cells(column, numbers[place, :rows], says[place, :rows], words, place)
                for place, column in enumerate(self.layout.columns, 1)
            }
            first = lines.item(0)
            own = None if lines.item(rows - 1) - first == rows - 1 else lines[:rows]
            batch = batch_of(numbers[0, :rows], self.layout, cells, first, own)
        return Found(batch, fault, ended, at, end, passed, label_count, len(labels))

    def batch(self, text: CsvText[Found]) -> Generator[Batch, None, tuple[int, int]]:
        """Take what can be read at once; gives how that ended, and where an odd row ends."""
        source, before = text.rest, text.line
        if text.start == len(source):
            return _ALL, 0
        if text.found is not None:
            found, text.found = text.found(), None
        else:
            found = self.read(source, text.start, is_ended=text.is_ended)
        batch, fault = found.batch, found.fault
        if batch is not None:
            lines = None if batch.lines is None else before + batch.lines
            is_last = text.is_whole and found.at == len(source) and fault is None
            yield replace(batch, first=before + batch.first, lines=lines, is_last=is_last)
        if fault is not None:
            line, error = fault
            raise TraceError(f"line {before + line}: {error}")
        if batch is not None:
            # The next call makes room for as many rows as it will find, with a tenth to spare.
            self._row_bytes = (found.at - text.start) / len(batch.times)
        if found.labels == found.room < _MOST_LABELS:
            self._labels = 4 * found.labels
        text.start = found.at
        text.line += found.lines
        return found.ended, found.end

    def _read_odd(
        self, text: str, place: int, row: int, numbers: NDArray[Any], says: NDArray[Any]
    ) -> None:
        """Put down what a cell says that is read as readers of rows do."""
        if place == 0:
            numbers[0, row] = ticks_of_cell(text, self.layout.stamps)
            return
        column = self.layout.columns[place - 1]
        if not text or text.encode() == self._absent:
            says[place, row] = NO_UPDATE
            return
        try:
            value = as_declared(scalar_of_text(text, column.kind), column.kind)
            says[place, row] = UNKNOWN if value is None else YES
            if column.kind is Kind.REAL:
                numbers[place].view(np.float64)[row] = value
            else:
                numbers[place, row] = value or 0
        except TraceError as error:
            raise TraceError(f"column `{column.called}`: {error}") from None

    def _cells(
        self,
        column: Column,
        values: NDArray[Any],
        says: NDArray[Any],
        words: Sequence[tuple[int, str]],
        place: int,
    ) -> Cells:
        gaps = self.layout.gaps
        if column.kind is Kind.LABEL:
            own = {number: label for number, (of, label) in enumerate(words) if of == place}
            labels = {label: at for at, label in enumerate(dict.fromkeys(own.values()))}
            renumbered = np.zeros(len(words) + 1, np.int32)
            renumbered[list(own)] = [labels[label] for label in own.values()]
            places = renumbered[values]
            given = says == YES
            if "" in labels:  # of spaces that are no ASCII
                given &= places != labels[""]
            return cells_of_labels(places, given, tuple(labels) or ("",), gaps)
        made = values.view(np.float64) if column.kind is Kind.REAL else values
        if column.kind is Kind.BOOL:
            made = values.astype(np.bool_)
        if gaps:
            if gaps.nan:
                says[says == UNKNOWN] = NO_UPDATE
            says[~kept(made, gaps) & (says == YES)] = NO_UPDATE
        cells = Cells(made, None if says.min() == says.max() == YES else says)
        _ = cells.unknown  # kept, found by the thread that has just written the values
        return cells


def _cell(text: bytes, start: int, end: int) -> str:
    """The text of a cell; where its end is negative, quotes in it are doubled."""
    if end >= 0:
        return text[start:end].decode().strip()
    return text[start:~end].decode().replace('""', '"').strip()
