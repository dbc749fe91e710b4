"""Plain CSV text as columns by Arrow's reader, which uses all cores."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow
from pyarrow.csv import ConvertOptions, ParseOptions, ReadOptions, read_csv

from rvmon.errors import TraceError
from rvmon.readers.batch import Batch, NotPlainError
from rvmon.readers.cells import array_of, batch_of, cells_of_arrow
from rvmon.readers.csv_rows import Layout
from rvmon.readers.decimals import PLACES
from rvmon.readers.line_chunks import is_long_celled
from rvmon.readers.table_batch import ticks_in_range
from rvmon.readers.values import FALSE_WORDS, TRUE_WORDS
from rvmon.trace.schema import Kind

_DIGITS = 28
"""Of decimals that hold every instant."""

_TYPES = {Kind.BOOL: pyarrow.bool_(), Kind.INT: pyarrow.int64(), Kind.REAL: pyarrow.float64()}

_STAMPS = {"ns": pyarrow.int64()} | {
    unit: pyarrow.decimal128(_DIGITS, places) for unit, places in PLACES.items()
}


def _has_infinity(array: Any) -> bool:
    """Whether a number is infinite, be it that it is too large."""
    return pyarrow.types.is_floating(array.type) and bool(
        np.isinf(array.to_numpy(zero_copy_only=False)).any()
    )


def arrow_batch(body: bytes, layout: Layout) -> Batch:
    """Some rows.

    Args:
        body: whole lines.
        layout: what their cells are.

    Raises:
        NotPlainError: there is a cell that Arrow does not read, or not as whoever reads rows does.
    """
    if not _is_like_csv(body, layout):
        raise NotPlainError("a cell is odd")
    try:
        table = _table(body, layout, dict(_KINDS))
    except (pyarrow.ArrowException, OSError):
        with_reals = {**_KINDS, Kind.INT: pyarrow.float64()}
        try:  # a whole number may be written as 1.0
            table = _table(body, layout, with_reals)
        except (pyarrow.ArrowException, OSError):
            raise NotPlainError("a cell is something else") from None
    stamps, *arrays = (column.combine_chunks() for column in table.columns)
    if stamps.null_count or any(map(_has_infinity, arrays)):
        raise NotPlainError("a stamp is missing, or a number may be too large")
    if len(stamps) != body.count(b"\n") + (not body.endswith(b"\n")):
        raise NotPlainError("a cell may have several lines, or a line is blank")
    # As whole numbers the digits of such decimals are ticks.
    unit = layout.stamps.unit
    ticks = stamps if unit == "ns" else stamps.view(pyarrow.decimal128(_DIGITS, 0))
    try:
        times = ticks_in_range(array_of(ticks.cast(pyarrow.int64()), "i"))
    except (pyarrow.ArrowException, TraceError):
        raise NotPlainError("a stamp is out of range") from None
    cells = {
        column: cells_of_arrow(array, column.kind, layout.gaps)
        for column, array in zip(layout.columns, arrays, strict=True)
    }
    for one in cells.values():
        if one.labels is not None and any(label != label.strip() for label in one.labels):
            raise NotPlainError("a label begins or ends with a space")
    return batch_of(times, layout, cells)


_KINDS = {**_TYPES, Kind.LABEL: pyarrow.dictionary(pyarrow.int32(), pyarrow.string())}


def _table(body: bytes, layout: Layout, kinds: Mapping[Kind, Any]) -> Any:
    types = {str(layout.time): _STAMPS[layout.stamps.unit]}
    types |= {str(column.index): kinds[column.kind] for column in layout.columns}
    no_update = layout.gaps.no_update
    return read_csv(
        pyarrow.BufferReader(body),
        ReadOptions(column_names=[str(place) for place in range(len(layout.header))]),
        ParseOptions(quote_char='"' if b'"' in body else False, double_quote=False),
        ConvertOptions(
            column_types=types,
            include_columns=list(types),
            null_values=["", *([] if no_update is None else [str(no_update)])],
            strings_can_be_null=True,
            true_values=sorted(TRUE_WORDS),
            false_values=sorted(FALSE_WORDS),
        ),
    )


def _is_like_csv(body: bytes, layout: Layout) -> bool:
    """Whether whoever reads rows finds the same cells.

    Quotes are around whole cells, none is very long, and nothing is there that Arrow alone takes
    for a number: 0x1F, nan(1). Spaces around numbers are passed over by both.
    """
    kinds = {column.kind for column in layout.columns}
    if layout.stamps.unit not in _STAMPS or is_long_celled(body):
        return False
    if Kind.REAL in kinds and b"(" in body:
        return False
    if (Kind.INT in kinds or layout.stamps.unit == "ns") and (b"x" in body or b"X" in body):
        if any(column.kind is Kind.LABEL for column in layout.columns):
            return _HEXADECIMAL.search(body) is None
        return False
    if b'"' in body and not _is_quoted_whole(body):
        return False
    if b"\0" in body or (b"\r" in body and body.count(b"\r") != body.count(b"\r\n")):
        return False
    if not body.isascii():
        try:
            body.decode()
        except UnicodeDecodeError:
            return False
    return True


def _is_quoted_whole(body: bytes) -> bool:
    """Whether each quote begins a cell or ends one."""
    text = np.frombuffer(b"\n%b\n" % body, np.uint8)
    quotes = np.flatnonzero(text == ord('"'))
    before, behind = text[quotes - 1], text[quotes + 1]
    begins = (before == ord(",")) | (before == ord("\n"))
    ends = (behind == ord(",")) | (behind == ord("\n")) | (behind == ord("\r"))
    return bool(begins[::2].all() and ends[1::2].all())


_HEXADECIMAL = re.compile(rb"0[xX]")
