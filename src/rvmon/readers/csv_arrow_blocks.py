"""Plain CSV text of numbers and truth values as blocks by Arrow's reader."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pyarrow
from pyarrow.csv import ConvertOptions, ParseOptions, ReadOptions, read_csv

from rvmon.readers.arrow_columns import block_of_arrays
from rvmon.readers.blocks import Block
from rvmon.readers.cells import array_of
from rvmon.readers.csv_arrow import _DIGITS, _STAMPS, _TYPES, _has_infinity
from rvmon.readers.csv_rows import Layout
from rvmon.readers.line_chunks import is_long_celled
from rvmon.readers.values import FALSE_WORDS, TRUE_WORDS
from rvmon.trace.schema import Kind


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
    return not is_long_celled(body)
