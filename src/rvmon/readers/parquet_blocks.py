"""Parquet files of numbers and truth values as columns, a block of rows at a time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.errors import TraceError
from rvmon.readers.arrow_columns import block_of_arrays
from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.cells import array_of
from rvmon.readers.parquet import columns_read, parquet_batches, parquet_layout
from rvmon.readers.plain import Seam, expect_plain_columns
from rvmon.readers.ticks import ticks_of_column
from rvmon.trace.schema import Schema, Stamps

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def parquet_blocks(
    path: str | Path, schema: Schema, fillable: frozenset[str] = frozenset()
) -> Iterator[Block]:
    """Read a file of numbers and truth values.

    Args:
        path: of the file.
        schema: the declared names.
        fillable: the names of which "no update" may be read as what was there before: of signals
            the value, of events that they do not occur.

    Raises:
        NotPlainError: there are gaps of other names or before the first value, payloads or labels,
            or the instants do not increase or are out of range; or the file is damaged.
    """
    try:
        yield from _plain_blocks(path, schema, fillable)
    except TraceError:  # whoever reads rows says in which it is
        raise NotPlainError("it cannot be read in blocks") from None


def _plain_blocks(path: str | Path, schema: Schema, fillable: frozenset[str]) -> Iterator[Block]:
    layout = parquet_layout(path, schema)
    expect_plain_columns(layout)
    seam = Seam(layout)
    for stamps, *arrays in parquet_batches(path, columns_read(layout)):
        times = _instants(stamps, layout.stamps)
        yield seam.joined(block_of_arrays(times, arrays, layout, fillable, seam.held))


def _instants(column: Any, stamps: Stamps) -> NDArray[np.int64]:
    if column.null_count or stamps.unit == "iso":
        raise NotPlainError("its stamps are no plain numbers")
    return ticks_of_column(array_of(column, "i" if stamps.unit == "ns" else "fi"), stamps)
