"""Reading of CSV text in batches of columns; the C reader leaves odd cells and rows to Python."""

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
"""Why a call of the C reader ended: the text ended, or at an odd row; otherwise, room ran out."""

_ODD = 4096  # the most odd cells of a call, which Python reads one by one

_LABELS = 2048
"""Room for distinct labels in the first call; later calls get more if it was too little."""

_MOST_LABELS = 1 << 16  # room for this many labels or more does not grow

_SORTS = 5  # labels that a call may note of a column before it takes a row


def csv_batches(
    text: CsvText[Parsed], layout: Layout, ignoring: frozenset[str]
) -> Iterator[Batch | Iterator[Row]]:
    """Yield the rows of a text in order: as batches, and odd rows one by one.

    Raises:
        TraceError: with the line's number; the rows before it are yielded first.
        UnicodeDecodeError: the file is not UTF-8.
    """
    reader = _Reader(layout)
    if not (text.is_whole or is_short_of_memory()):  # each thread reserves address space
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
    """Split a text, which follows `before` lines, into rows."""
    return split_lines(bounded_lines(io.StringIO(text, newline=""), before), before)


class Parsed(Struct, frozen=True):
    """The result of one call of the C reader; see `csv.h`."""

    batch: Batch | None  # line numbers are relative to the text; `None`: there is no row
    fault: tuple[int, TraceError] | None  # line and error of the row after the batch, if wrong
    ended: int  # why the call ended: `_ALL`, `_ROW` or another number
    at: int  # the offset of the text not read
    end: int  # the end of the odd row at `at`
    lines: int  # the number of lines read
    labels: int  # the number of distinct labels found
    room: int  # the most distinct labels that had room


class _Reader:
    """Reads batches of rows, with the room that earlier calls have shown to be enough."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        no_update = layout.gaps.no_update
        self._absent = None if no_update is None else str(no_update).encode()
        self._row_bytes = 2.0 * len(layout.header)
        has_labels = any(column.kind is Kind.LABEL for column in layout.columns)
        self._labels = max(_LABELS if has_labels else 0, _SORTS * (1 + len(layout.columns)))

    def read(self, text: bytes, start: int = 0, *, is_ended: bool = False) -> Parsed:
        """Read rows of a text from offset `start` on, as many as one call can.

        `is_ended`: whether the text ends with its last row. May run in several threads.
        """
        # Enough if rows are as long as earlier ones; otherwise a second call reads the rest.
        room = int(1.1 * (len(text) - start) / self._row_bytes) + 16
        columns = 1 + len(self.layout.columns)
        numbers = np.empty((columns, room), np.int64)
        states = np.empty((columns, room), np.uint8)
        lines = np.empty(room, np.int64)
        odd = np.empty((max(_ODD, columns), 4), np.int64)
        labels = np.empty((self._labels, 4), np.int64)
        table = np.zeros(2 * len(labels), np.int32)
        ended, rows, at, end, passed, odd_count, label_count = native_csv.read(
            text, start, is_ended, csv.field_size_limit(), *self.layout.numbers, self._absent,
            numbers, states, lines, odd, labels, table,
        )  # fmt: skip
        fault = None
        if (hole := text.find(b"\0", start, at)) >= 0:
            line = len(text[start : hole + 1].splitlines())
            # Keep the rows before that line.
            rows = int(lines[:rows].searchsorted(line))
            fault = line, TraceError(NEVER_WRITTEN)
        # Cells that C does not read (unusual notations, quotes) are read by the functions for
        # single rows, so that both ways give the same values.
        for row, place, *ends in odd[:odd_count].tolist():
            if row >= rows:
                break
            try:
                self._read_odd(_cell(text, *ends), place, row, numbers, states)
            except TraceError as error:
                rows, fault = row, (lines.item(row), error)
                break
        batch = None
        if rows:
            words = [(of, _cell(text, *ends)) for of, *ends, _ in labels[:label_count].tolist()]
            cells = {
                column: self._cells(
                    column, numbers[place, :rows], states[place, :rows], words, place
                )
                for place, column in enumerate(self.layout.columns, 1)
            }
            first = lines.item(0)
            own = None if lines.item(rows - 1) - first == rows - 1 else lines[:rows]
            batch = batch_of(numbers[0, :rows], self.layout, cells, first, own)
        return Parsed(batch, fault, ended, at, end, passed, label_count, len(labels))

    def batch(self, text: CsvText[Parsed]) -> Generator[Batch, None, tuple[int, int]]:
        """Yield the next batch, if any; return why the call ended, and the end of an odd row."""
        source, before = text.rest, text.line
        if text.start == len(source):
            return _ALL, 0
        if text.result is not None:
            found, text.result = text.result(), None
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
            # The next call makes room for rows of this average length, and a tenth more.
            self._row_bytes = (found.at - text.start) / len(batch.times)
        if found.labels == found.room < _MOST_LABELS:
            self._labels = 4 * found.labels
        text.start = found.at
        text.line += found.lines
        return found.ended, found.end

    def _read_odd(
        self, text: str, place: int, row: int, numbers: NDArray[Any], states: NDArray[Any]
    ) -> None:
        """Read an odd cell as single rows are read, and store it at its column and row."""
        if place == 0:
            numbers[0, row] = ticks_of_cell(text, self.layout.stamps)
            return
        column = self.layout.columns[place - 1]
        if not text or text.encode() == self._absent:
            states[place, row] = NO_UPDATE
            return
        try:
            value = as_declared(scalar_of_text(text, column.kind), column.kind)
            states[place, row] = UNKNOWN if value is None else YES
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
        states: NDArray[Any],
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
            given = states == YES
            if "" in labels:  # a cell of non-ASCII spaces, which only Python strips
                given &= places != labels[""]
            return cells_of_labels(places, given, tuple(labels) or ("",), gaps)
        made = values.view(np.float64) if column.kind is Kind.REAL else values
        if column.kind is Kind.BOOL:
            made = values.astype(np.bool_)
        if gaps:
            if gaps.nan:
                states[states == UNKNOWN] = NO_UPDATE
            states[~kept(made, gaps) & (states == YES)] = NO_UPDATE
        cells = Cells(made, None if states.min() == states.max() == YES else states)
        _ = cells.unknown  # cached: this thread has the values at hand
        return cells


def _cell(text: bytes, start: int, end: int) -> str:
    """The text of a cell; a negative `end` (the complement) marks a cell with doubled quotes."""
    if end >= 0:
        return text[start:end].decode().strip()
    return text[start:~end].decode().replace('""', '"').strip()
