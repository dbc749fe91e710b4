"""Tables in memory as columns, without copies if possible."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.readers.batch import Batch, NotPlainError
from rvmon.readers.cells import batch_of, cells_of_column
from rvmon.readers.csv_rows import Layout
from rvmon.readers.ticks import ticks_of_column
from rvmon.trace.gaps import NO_GAPS
from rvmon.trace.schema import Kind, Stamps

if TYPE_CHECKING:
    from numpy.typing import NDArray


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
    kind = getattr(getattr(column, "dtype", None), "kind", "")
    return kind == "i" or str(getattr(column, "type", getattr(column, "dtype", ""))).lower()[
        :3
    ] in (
        "int",
        "uin",
    )
