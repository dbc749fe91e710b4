"""Reading of CSV by rows: a header, a time column, a column per signal, event or payload field."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from struct import pack
from typing import Any

from msgspec import Struct

from rvmon.errors import TraceError
from rvmon.recordings.places import LONGEST_LINE
from rvmon.recordings.values import as_declared, scalar_of_text
from rvmon.texts import shorten
from rvmon.trace.sample import Scalar, Value
from rvmon.trace.schema import Gaps, Kind, Schema, Stamps
from rvmon.trace.stamps import stamps_among, ticks_of_cell

# As `csv.h` numbers them.
_KINDS = {Kind.BOOL: 0, Kind.INT: 1, Kind.REAL: 2, Kind.LABEL: 3}
_ANY = 4
_STAMPS = {"iso": 5, "s": 15, "ms": 12, "us": 9, "ns": 6}  # by unit


class Column(Struct, frozen=True):
    """A column that the spec reads: a signal, an event, or a payload field of an event."""

    index: int
    name: str
    field: str | None
    kind: Kind

    @property
    def called(self) -> str:
        """The declared name, `event.field` for a payload field."""
        return self.name if self.field is None else f"{self.name}.{self.field}"


class Layout(Struct, frozen=True, dict=True):
    """The columns of a header, and how to read their cells."""

    header: tuple[str, ...]  # names of the columns
    time: int  # index of the time column
    stamps: Stamps  # name and unit of the time column
    signals: tuple[Column, ...]  # columns of signals
    events: tuple[Column, ...]  # columns of events and of their payload fields
    ignored: tuple[str, ...]  # names of the columns that the spec does not declare
    gaps: Gaps  # values that mean "no update"
    # whether cells are read before their kinds are known: as labels, of which one number may stand
    # for all numbers of its sort (0, 1, whole, other); a last line without an end counts, too
    is_look: bool = False

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns that the spec reads, without the time column."""
        return self.signals + self.events

    @property
    def names_read(self) -> list[str]:
        """The header names of the time column, first, and of the columns that the spec reads."""
        return [
            self.header[place] for place in (self.time, *(column.index for column in self.columns))
        ]

    @cached_property
    def names(self) -> frozenset[str]:
        """The declared names that have a column."""
        return frozenset(column.name for column in self.columns)

    @cached_property
    def numbers(self) -> tuple[bytes, bytes]:
        """The arguments `slots` and `kinds` of `native_csv.read`, as packed int32.

        By cell of a row, the index of its column (0 is the time, -1 is not read); by column, its
        kind.
        """
        places = {column.index: place for place, column in enumerate(self.columns, 1)}
        places[self.time] = 0
        slots = [places.get(index, -1) for index in range(len(self.header))]
        own = [_ANY if self.is_look else _KINDS[column.kind] for column in self.columns]
        kinds = [_STAMPS[self.stamps.unit], *own]
        return pack(f"={len(slots)}i", *slots), pack(f"={len(kinds)}i", *kinds)


def read_layout(header: list[str], schema: Schema) -> Layout:
    """Match the names of a header with the declared names.

    Raises:
        TraceError: a name is in the header twice, or there is not one time column.
    """
    seen: dict[str, int] = {}
    for index, name in enumerate(header):
        if name in seen:
            more = ": are these values? Put a line with the names of columns above them"
            if any(map(str.isalpha, "".join(header))):
                more = ""
            raise TraceError(f"column `{shorten(name)}` appears twice in the header{more}")
        seen[name] = index
    stamps = stamps_among(header, schema)
    return layout_of(header, stamps, schema)


def layout_of(header: Sequence[str], stamps: Stamps, schema: Schema) -> Layout:
    """Match distinct column names, except that of the time column, with the declared names."""
    aliases = schema.aliases
    signals, events, ignored = [], [], []
    for index, column in enumerate(header):
        name = aliases.get(column, column)
        event, _, field = name.rpartition(".")
        if column == stamps.column:
            continue
        if name in schema.signals:
            signals.append(Column(index, name, None, schema.signals[name]))
        elif name in schema.events:
            events.append(Column(index, name, None, Kind.BOOL))
        elif field in schema.events.get(event, {}):
            events.append(Column(index, event, field, schema.events[event][field]))
        elif column:  # one without a name is the index of a data frame
            ignored.append(column)
    return Layout(
        tuple(header),
        header.index(stamps.column),
        stamps,
        tuple(signals),
        tuple(events),
        tuple(ignored),
        schema.gaps,
    )


NEVER_WRITTEN = (
    "there are zero bytes, as in a file of which a block was never written: lines may be missing: "
    "copy it again, or cut it off there"
)


class CopiedLines:
    """An iterator of lines that keeps a copy of those read, to get the text of the last row."""

    def __init__(self, lines: Iterable[str]) -> None:
        self._lines = lines
        self._read: list[str] = []

    def __iter__(self) -> Iterator[str]:
        for line in self._lines:
            self._read.append(line)
            yield line

    def taken(self) -> str:
        """The text read since the previous call; the last line of the file may lack its end."""
        text = "".join(self._read)
        self._read.clear()
        return text


def split_lines(
    lines: Iterable[str], before: int = 0, separator: str = ","
) -> Iterator[tuple[int, list[str]]]:
    """Split CSV text into rows, each with the number of the line on which it ends.

    Blank lines are skipped. `before`: the number of lines before the text.

    Raises:
        TraceError: with the line's number: a row is malformed or too long, or has zero bytes.
    """
    began, taken = 1, 0

    def of_row() -> Iterator[str]:
        nonlocal taken
        for line in lines:
            taken += len(line)
            if taken > LONGEST_LINE:
                raise TraceError(
                    f"line {began}: a row of more than {LONGEST_LINE:,} characters begins here: "
                    "close its quotes"
                )
            if "\0" in line:
                raise TraceError(f"line {before + reader.line_num + 1}: {NEVER_WRITTEN}")
            yield line

    reader = csv.reader(of_row(), delimiter=separator, strict=True)
    while True:
        began, taken = before + reader.line_num + 1, 0
        try:
            row = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            why, more = f"not a CSV row ({error})", ""
            if "field limit" in str(error):
                why = f"a cell has more than {csv.field_size_limit():,} characters"
                more = ": leave its column out, or allow more by csv.field_size_limit in Python"
            line = before + reader.line_num
            if began < line:
                more = f"; the row begins on line {began}: close its quotes"
            raise TraceError(f"line {line}: {why}{more}") from None
        if row and not (len(row) == 1 and row[0].isspace()):
            yield before + reader.line_num, [cell.strip() for cell in row]


def read_row(row: list[str], layout: Layout) -> tuple[int, dict[str, Value]]:
    """Read a row: its ticks, and its values by name; an empty cell is no update.

    Raises:
        TraceError: a cell is missing or cannot be read; the message names the column.
    """
    if len(row) != len(layout.header):
        split = len(row) > len(layout.header) and all(re.fullmatch(r"[-+]?\d+", one) for one in row)
        fix = ": if the comma is the decimal sign, separate the cells by `;`" if split else ""
        raise TraceError(f"{len(row)} cells where the header has {len(layout.header)}{fix}")
    t = ticks_of_cell(row[layout.time], layout.stamps)
    no_update = layout.gaps.no_update
    absent = "" if no_update is None else str(no_update)
    given = (
        (column, _scalar(cell, column))
        for column in layout.columns
        if (cell := row[column.index]) and cell != absent
    )
    return t, row_values(given, layout.gaps)


def row_values(cells: Iterable[tuple[Column, Any]], gaps: Gaps) -> dict[str, Value]:
    """The values of a row by name: the one definition of what cells mean, in every format.

    A signal is updated by its cell. An event with a payload cell occurs unless its own cell is
    false. An event without payload cells occurs if its own cell is true.

    >>> from rvmon.trace.schema import NO_GAPS
    >>> columns = [Column(1, "pick", None, Kind.BOOL), Column(2, "pick", "id", Kind.INT)]
    >>> [row_values(zip(columns, cells), NO_GAPS) for cells in ([True, 7.0], [False, 7], [1])]
    [{'pick': {'id': 7}}, {'pick': False}, {'pick': True}]
    """
    values: dict[str, Any] = {}
    payloads: dict[str, dict[str, Scalar]] = {}
    has_gaps = bool(gaps)
    for column, cell in cells:
        if has_gaps and gaps.holds(cell):
            continue
        value = as_declared(cell, column.kind)
        if column.field is None:
            values[column.name] = value
        else:
            payloads.setdefault(column.name, {})[column.field] = value
    for name, payload in payloads.items():
        if values.get(name) is not False:
            values[name] = payload
    return values


def _scalar(cell: str, column: Column) -> Scalar:
    try:
        return scalar_of_text(cell, column.kind)
    except TraceError as error:
        raise TraceError(f"column `{column.called}`: {error}") from None


def csv_samples(
    rows: Iterator[tuple[int, list[str]]], layout: Layout
) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
    """Yield the line number, ticks and values of each row.

    Raises:
        TraceError: with the line's number.
    """
    for line, row in rows:
        try:
            t, values = read_row(row, layout)
        except TraceError as error:
            raise TraceError(f"line {line}: {error}") from None
        yield line, t, values


def unended(
    rows: Iterator[tuple[int, list[str]]], layout: Layout, ignoring: frozenset[str]
) -> Iterator[tuple[int, int, Mapping[str, Value], frozenset[str]]]:
    """Yield rows as `csv_samples` does, of a last line without an end, and the names made unknown.

    The file may have been cut off in the last cell, so the name that this cell updates becomes
    unknown, unless the cell is a whole truth value. If it is the stamp, all names become unknown.

    Raises:
        TraceError: with the line's number; also if unknown is no update for such a name.
    """
    for line, row in rows:
        try:
            t, values = read_row(row, layout)
        except TraceError as error:
            raise TraceError(f"line {line}: {error}; the file ends here: was it cut off?") from None
        last = len(row) - 1
        lost = frozenset(
            column.name
            for column in layout.columns
            if not layout.is_look
            and (
                layout.time == last
                or (column.index == last and (column.kind is not Kind.BOOL or not row[last]))
            )
        )
        for name in sorted(lost & ignoring):
            raise TraceError(
                f"line {line}: it has no end: if it was cut off, `{name}` had another value: end "
                "the line, or leave it out"
            )
        yield line, t, {**values, **dict.fromkeys(lost)}, lost
