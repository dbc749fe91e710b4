"""Plain CSV text as columns by Arrow's reader, which uses all cores."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow
from pyarrow.csv import ConvertOptions, ParseOptions, ReadOptions, read_csv

from rvmon.readers.arrow_columns import array_of, block_of_arrays
from rvmon.readers.blocks import Block
from rvmon.readers.csv_rows import Layout
from rvmon.readers.decimals import PLACES
from rvmon.readers.values import FALSE_WORDS, TRUE_WORDS
from rvmon.trace.schema import Kind

_DIGITS = 28
"""Of decimals that hold every instant."""

_TYPES = {Kind.BOOL: pyarrow.bool_(), Kind.INT: pyarrow.int64(), Kind.REAL: pyarrow.float64()}

_STAMPS = {"ns": pyarrow.int64()} | {
    unit: pyarrow.decimal128(_DIGITS, places) for unit, places in PLACES.items()
}


def arrow_block(
    body: bytes, layout: Layout, fillable: frozenset[str], held: Mapping[str, Any]
) -> Block | None:
    r"""Some rows.

    Args:
        body: lines that each end with `\n`; ASCII without quotes and spaces.
        layout: what their cells are: numbers and truth values.
        fillable: the names of which "no update" may be read as what was there before.
        held: what signals held before the first row.

    Returns:
        `None` if there is a cell that Arrow does not read, or not as whoever reads rows does.

    Raises:
        NotPlainError: a cell is empty where it may matter.
    """
    unit = layout.stamps.unit
    if unit not in _STAMPS or not _is_ordinary(body, layout):
        return None
    types = {str(layout.time): _STAMPS[unit]}
    types |= {str(column.index): _TYPES[column.kind] for column in layout.columns}
    try:
        table = read_csv(
            pyarrow.BufferReader(body),
            ReadOptions(column_names=[str(place) for place in range(len(layout.header))]),
            ParseOptions(quote_char=False),
            ConvertOptions(
                column_types=types,
                include_columns=list(types),
                null_values=[""],
                true_values=sorted(TRUE_WORDS),
                false_values=sorted(FALSE_WORDS),
            ),
        )
        stamps, *arrays = (column.combine_chunks() for column in table.columns)
        if stamps.null_count or any(map(_has_infinity, arrays)):
            return None
        # As whole numbers the digits of such decimals are ticks.
        ticks = stamps if unit == "ns" else stamps.view(pyarrow.decimal128(_DIGITS, 0))
        times = array_of(ticks.cast(pyarrow.int64()), "i")
    except MemoryError:  # of Arrow, too
        raise
    except (pyarrow.ArrowException, OSError):
        return None
    return block_of_arrays(times, arrays, layout, fillable, held)


def _is_ordinary(body: bytes, layout: Layout) -> bool:
    """Whether there is nothing that Arrow alone takes: 0x1F, nan(1), cells of any length."""
    kinds = {column.kind for column in layout.columns}
    if Kind.REAL in kinds and b"(" in body:
        return False
    if (Kind.INT in kinds or layout.stamps.unit == "ns") and (b"x" in body or b"X" in body):
        return False
    # A longer line would have a stretch of so many bytes without an end.
    stretch = max(csv.field_size_limit() // 2, 1)
    starts = range(0, len(body) - stretch, stretch)
    return all(body.find(b"\n", start, start + stretch) >= 0 for start in starts)


def _has_infinity(array: Any) -> bool:
    """Whether a number is infinite, be it that it is too large."""
    return pyarrow.types.is_floating(array.type) and bool(
        np.isinf(array.to_numpy(zero_copy_only=False)).any()
    )
