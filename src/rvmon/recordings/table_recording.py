"""Recordings of tables in memory: columns become batches, or samples row by row."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.recordings.batch import Batch, NotPlainError
from rvmon.recordings.cells import batch_of, cells_of_column
from rvmon.recordings.csv_rows import Layout, layout_of, row_values
from rvmon.recordings.rows import LOOKED_AT, Row, Rows, doubt_unit
from rvmon.recordings.tables import cells_of, is_of_dates, is_of_durations, nanoseconds_of
from rvmon.recordings.values import plain
from rvmon.trace.sample import Health, Sample
from rvmon.trace.schema import NO_GAPS, Kind, Schema, Stamps
from rvmon.trace.stamps import stamps_among, ticks_of_stamp
from rvmon.trace.time import TICKS_PER_UNIT, TIME_LIMIT, whole_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray


class TableRecording:
    """A recording of a table in memory.

    >>> from rvmon.trace.schema import Kind
    >>> table = TableRecording({"t": [0, 1], "v": [2, None]}, Schema({"v": Kind.REAL}, {}))
    >>> [sample.values for sample in table]
    [{'v': 2.0}, {}]
    """

    end: int | None = None  # `None`: it ends with its last row
    path = "a table"
    outages: tuple[()] = ()

    def __init__(self, columns: Mapping[str, Any], schema: Schema, *, ordered: bool = True) -> None:
        """Match the names of the columns with those in the schema; no cell is read yet.

        Raises:
            TraceError: there is not one time column.
        """
        self._schema = schema
        self.columns = columns  # by name, see `rvmon.recordings.tables.columns_by_name`
        header = list(columns)
        stamps = stamps_among(header, schema)
        given = columns[stamps.column]
        stamps = stamps_of_column(stamps, given)
        if is_of_durations(given):
            self.columns = {**columns, stamps.column: nanoseconds_of(given)}
        self.layout: Layout = layout_of(header, stamps, schema)
        self.names: frozenset[str] | None = self.layout.names  # declared names that have a column
        self.ignored = Counter(self.layout.ignored)  # the columns for which no name is declared
        self.rows = Rows(schema, "row", ordered=ordered)  # turns its rows into samples

    def pieces(self) -> Iterator[Batch | Sample]:
        """Yield the table in order, as batches if all cells fit the declared kinds, else samples.

        Raises:
            TraceError: a cell cannot be read, or columns differ in length.
            TimeOrderError: time goes backwards.
        """
        return self.rows.pieces(self._batches()) if self.rows.ordered else iter(self)

    def _batches(self) -> Iterator[Batch | Iterator[Row]]:
        try:
            yield batch_of_table(self.columns, self.layout)
        except NotPlainError:
            yield self._read()

    def __iter__(self) -> Iterator[Sample]:
        """Yield samples in order of time, with equal stamps merged; errors as in `pieces`."""
        return self.rows.samples(self._read())

    def _read(self) -> Iterator[Row]:
        """Yield the number (from 0), ticks and values of each row."""
        layout = self.layout
        cells = {name: cells_of(name, self.columns[name]) for name in layout.names_read}
        lengths = {name: len(column) for name, column in cells.items()}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"`{name}` {length}" for name, length in lengths.items())
            raise TraceError(f"columns differ in length: {listed}")
        yield from rows_of_cells(cells.values(), layout, 0)

    @property
    def unread(self) -> list[str]:
        """The columns for which no name is declared."""
        return list(self.ignored)

    def stamp_doubts(self) -> list[Health]:
        """Report stamps that look like milliseconds, by the first ones."""
        stamps = self.layout.stamps
        if stamps.is_stated or stamps.unit != "s":
            return []
        if self.rows.first:
            return doubt_unit(self.rows.first, stamps)
        column = self.columns[stamps.column]
        first = cells_of(stamps.column, getattr(column, "iloc", column)[:LOOKED_AT])
        return doubt_unit([_ticks(cell, stamps, row) for row, cell in enumerate(first)], stamps)

    parts, doubts = pieces, stamp_doubts  # the protocol `rvmon.recordings.joined.File`


def stamps_of_column(stamps: Stamps, column: Any) -> Stamps:
    """The stamps of a column, whose type may say that they are dates or durations.

    A unit that the user has stated takes precedence over dates, but not over durations.
    """
    if not stamps.is_stated and is_of_dates(column):
        return Stamps(stamps.column, "iso", is_stated=True)
    if is_of_durations(column):
        return Stamps(stamps.column, "ns", is_stated=True)
    return stamps


def rows_of_cells(columns: Iterable[Sequence[Any]], layout: Layout, first: int) -> Iterator[Row]:
    """Yield rows of columns of values, the stamps first; a cell of `None` is no update.

    `first`: the number of the first row.

    Raises:
        TraceError: a stamp cannot be read; the message has the number of the row.
    """
    for row, (stamp, *cells) in enumerate(zip(*columns, strict=True), first):
        found = zip(layout.columns, map(plain, cells), strict=True)
        given = ((column, cell) for column, cell in found if cell is not None)
        yield row, _ticks(stamp, layout.stamps, row), row_values(given, layout.gaps)


def _ticks(stamp: Any, stamps: Stamps, row: int) -> int:
    """The instant of a row (ticks); nanoseconds may be floats with whole values."""
    whole = stamps.unit == "ns" and isinstance(stamp, float) and stamp.is_integer()
    try:
        return ticks_of_stamp(int(stamp) if whole else stamp, stamps)
    except TraceError as error:
        raise TraceError(f"row {row}: {error}") from None


def ticks_of_column(values: NDArray[Any], stamps: Stamps) -> NDArray[np.int64]:
    """Convert a column of stamps to ticks, each rounded once as by `ticks_of_stamp`.

    Args:
        values: int[n] or float[n]; int[n] for nanoseconds.
        stamps: gives their unit, which is not `iso`.

    Raises:
        TraceError: a stamp is not finite or out of range.
    """
    if not len(values):
        return np.empty(0, np.int64)
    if stamps.unit == "ns":
        return ticks_in_range(values)
    scale = TICKS_PER_UNIT[stamps.unit]
    most = TIME_LIMIT // scale
    if values.dtype.kind in "iu":
        _refuse(values, most, stamps)
        return values.astype(np.int64) * scale
    ticks = np.empty(len(values), np.int64)
    for start in range(0, len(values), _PIECE):
        piece = slice(start, start + _PIECE)
        ticks[piece] = _rounded(values[piece].astype(np.float64, copy=False), stamps, scale, most)
    return ticks_in_range(ticks)


_PIECE = 1 << 14  # instants that are computed together: their arrays fit into the cache


def _rounded(
    values: NDArray[np.float64], stamps: Stamps, scale: int, most: int
) -> NDArray[np.int64]:
    """Instants in units of `scale` ticks, float64[n], as ticks; `most`: the largest whole stamp."""
    _refuse(values, most + 1, stamps)
    whole = np.trunc(values)
    parts = values - whole
    found = np.rint(parts * float(scale))
    sizes = np.spacing(np.abs(values))
    # Where neighbouring doubles are more than a tick apart, the writer meant the shortest decimal
    # that reads as this double.
    if (sizes * scale > 1).any():
        found = np.where(sizes * scale > 1, _of_fewest_digits(parts, sizes / 2, scale), found)
    ticks = whole.astype(np.int64) * scale + found.astype(np.int64)
    # Near the middle of two ticks the product of doubles may round to the wrong side. The few
    # stamps there are computed exactly.
    unsure = np.abs(np.abs(parts * scale - np.trunc(parts * scale)) - 0.5) < 1e-5
    for row in np.flatnonzero(unsure & (sizes * scale <= 1)):
        ticks[row] = ticks_of_stamp(float(values[row]), stamps)
    return ticks


def _of_fewest_digits(
    parts: NDArray[np.float64], halves: NDArray[np.float64], scale: int
) -> NDArray[np.float64]:
    """Fractions as ticks, rounded to the fewest digits that identify the double; see `exact`.

    `halves`: half the distance to the neighbouring doubles, float64[n].
    """
    power, found = float(scale), np.rint(parts * float(scale))
    while power > 1:
        power /= 10
        fewer = np.rint(parts * power)
        fits = np.abs(fewer - parts * power) <= halves * power
        if not fits.any():
            break
        found = np.where(fits, fewer * (scale / power), found)
    return found


def ticks_in_range(ticks: NDArray[Any]) -> NDArray[np.int64]:
    """Integers as ticks, int64[n], contiguous.

    Only the first and last one are checked. All are in range if these are and the column ascends,
    which is checked while it is judged; reading all of a long column here would cost as much as
    judging it. A column of a two-dimensional array is copied, as it is not contiguous.

    Raises:
        TraceError: the first or last one is out of range.
    """
    made = np.ascontiguousarray(ticks, np.int64)
    for end in made[:: max(len(made) - 1, 1)].tolist():
        whole_ticks(end)
    return made


def _refuse(values: NDArray[Any], most: int, stamps: Stamps) -> None:
    """Raise `TraceError` if a stamp is NaN or beyond ±`most`."""
    if not -most <= values.min() <= values.max() <= most:
        fine = (values >= -most) & (values <= most)
        ticks_of_stamp(values[~fine][0].item(), stamps)


def batch_of_table(columns: Mapping[str, Any], layout: Layout) -> Batch:
    """Convert a table to one batch.

    Raises:
        NotPlainError: the table must be read row by row, which also reports what is wrong with it.
    """
    try:
        times = instants(columns[layout.stamps.column], layout.stamps)
        cells = {
            column: cells_of_column(
                column.called, columns[layout.header[column.index]], column.kind, layout.gaps
            )
            for column in layout.columns
        }
    except TraceError:
        raise NotPlainError("a column is none") from None
    if any(len(cell.values) != len(times) for cell in cells.values()):
        raise NotPlainError("its columns are not equally long")
    return batch_of(times, layout, cells)


def instants(column: Any, stamps: Stamps) -> NDArray[np.int64]:
    """Convert a column of stamps to ticks, int64[n].

    Raises:
        NotPlainError: the stamps are no plain numbers.
        TraceError: a stamp is not finite or out of range.
    """
    if stamps.unit == "iso":
        raise NotPlainError("its stamps are dates")
    kind = Kind.INT if stamps.unit == "ns" else Kind.REAL
    if kind is Kind.REAL and _is_whole(column):
        kind = Kind.INT
    made = cells_of_column(stamps.column, column, kind, NO_GAPS)
    if made.states is not None:
        raise NotPlainError("its stamps are no plain numbers")
    return ticks_of_column(made.values, stamps)


def _is_whole(column: Any) -> bool:
    """Whether a column has an integer type, whose values doubles may not hold exactly."""
    kind = getattr(column, "type", getattr(column, "dtype", ""))
    return str(kind).lower().startswith(("int", "uint"))
