"""Tables in memory, and their stamps, as columns, without copies if possible."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.readers.batch import Batch, NotPlainError
from rvmon.readers.cells import batch_of, cells_of_column
from rvmon.readers.csv_rows import Layout
from rvmon.trace.schema import NO_GAPS, Kind, Stamps
from rvmon.trace.stamps import ticks_of_stamp
from rvmon.trace.time import TICKS_PER_UNIT, TIME_LIMIT, whole_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray


def ticks_of_column(values: NDArray[Any], stamps: Stamps) -> NDArray[np.int64]:
    """A column of stamps as ticks, each rounded once as `ticks_of_stamp` does.

    Args:
        values: int[n] or float[n]; of ticks themselves, int[n].
        stamps: says their unit, not `iso`.

    Raises:
        TraceError: a number is not finite or out of range.
    """
    if not len(values):
        return np.empty(0, np.int64)
    if stamps.unit == "ns":
        return ticks_in_range(values)
    scale = TICKS_PER_UNIT[stamps.unit]
    most = TIME_LIMIT // scale
    if values.dtype.kind == "i":
        _refuse(values, most, stamps)
        return values.astype(np.int64) * scale
    ticks = np.empty(len(values), np.int64)
    for start in range(0, len(values), _PIECE):
        piece = slice(start, start + _PIECE)
        ticks[piece] = _rounded(values[piece].astype(np.float64, copy=False), stamps, scale, most)
    return ticks_in_range(ticks)


_PIECE = 1 << 14
"""Instants that are worked out together, near the processor."""


def _rounded(
    values: NDArray[np.float64], stamps: Stamps, scale: int, most: int
) -> NDArray[np.int64]:
    """Instants in units of so many ticks as ticks."""
    _refuse(values, most + 1, stamps)
    whole = np.floor(values)
    parts = (values - whole) * float(scale)
    ticks = whole.astype(np.int64) * scale + np.rint(parts).astype(np.int64)
    for row in np.flatnonzero(np.abs(parts - np.floor(parts) - 0.5) < 1e-5):
        ticks[row] = ticks_of_stamp(float(values[row]), stamps)
    return ticks


def ticks_in_range(ticks: NDArray[Any]) -> NDArray[np.int64]:
    """Integers as ticks.

    Only the ends are looked at: if these are in range, and whoever judges the column finds that it
    ascends, all are. To read all of a long column costs as much as to judge it.

    Raises:
        TraceError: the first or the last is out of range.
    """
    made = ticks.astype(np.int64, copy=False)
    for end in made[:: max(len(made) - 1, 1)].tolist():
        whole_ticks(end)
    return made


def _refuse(values: NDArray[Any], most: int, stamps: Stamps) -> None:
    """Refuse stamps beyond those bounds, and what is no number."""
    if not -most <= values.min() <= values.max() <= most:
        fine = (values >= -most) & (values <= most)
        ticks_of_stamp(values[~fine][0].item(), stamps)


def batch_of_table(columns: Mapping[str, Any], layout: Layout) -> Batch:
    """A table as one batch.

    Args:
        columns: of the table, by name.
        layout: what they are.

    Raises:
        NotPlainError: a column holds something else, or stamps are dates; who reads rows says what.
    """
    try:
        times = instants(columns[layout.stamps.column], layout.stamps)
        cells = {
            one: cells_of_column(
                one.called, columns[layout.header[one.index]], one.kind, layout.gaps
            )
            for one in layout.columns
        }
    except TraceError:
        raise NotPlainError("a column is none") from None
    if any(len(one.values) != len(times) for one in cells.values()):
        raise NotPlainError("its columns are not equally long")
    return batch_of(times, layout, cells)


def instants(column: Any, stamps: Stamps) -> NDArray[np.int64]:
    """A column of stamps as ticks.

    Raises:
        NotPlainError: these are no plain numbers.
        TraceError: one is not finite or out of range.
    """
    if stamps.unit == "iso":
        raise NotPlainError("its stamps are dates")
    kind = Kind.INT if stamps.unit == "ns" else Kind.REAL
    if kind is Kind.REAL and _is_whole(column):
        kind = Kind.INT
    made = cells_of_column(stamps.column, column, kind, NO_GAPS)
    if made.says is not None:
        raise NotPlainError("its stamps are no plain numbers")
    return ticks_of_column(made.values, stamps)


def _is_whole(column: Any) -> bool:
    """Whether a column is of whole numbers, which doubles may not hold."""
    kind = getattr(column, "type", getattr(column, "dtype", ""))
    return str(kind).lower().startswith(("int", "uint"))
