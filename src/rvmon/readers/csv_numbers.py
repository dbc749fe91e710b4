"""Pieces of plain CSV text as columns by NumPy: numbers and truth values, exactly."""

from __future__ import annotations

import csv
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.batch import Batch, Cells, NotPlainError
from rvmon.readers.cells import batch_of, cells_of_array
from rvmon.readers.csv_rows import Column, Layout
from rvmon.readers.decimals import Cells as TextCells
from rvmon.readers.decimals import decimals, instants, truth_values, whole_numbers
from rvmon.trace.schema import Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ODD = (b'"', b" ", b"\t", b"\0", b"\r")

READERS = {Kind.BOOL: truth_values, Kind.INT: whole_numbers, Kind.REAL: decimals}
"""What reads the cells of a column, by what its values are."""


def number_batch(body: bytes, layout: Layout) -> Batch:
    r"""Some rows.

    Args:
        body: whole lines.
        layout: what their cells are.

    Raises:
        NotPlainError: a cell is quoted, or no decimal of 15 digits at most, and no 0 and 1.
    """
    body = body.replace(b"\r\n", b"\n") if b"\r" in body else body
    if any(odd in body for odd in _ODD) or not body.isascii():
        raise NotPlainError("it has quoted or odd characters")
    if layout.gaps.no_update is not None:
        raise NotPlainError("text may stand for no update")
    cells = text_cells(body if body.endswith(b"\n") else body + b"\n", len(layout.header))
    times = plain_values(instants(cells(layout.time), layout.stamps.unit))
    return batch_of(
        times, layout, {one: _cells(cells(one.index), one, layout) for one in layout.columns}
    )


def text_cells(body: bytes, width: int) -> Callable[[int], TextCells]:
    """What gives the cells of a column by its place.

    Args:
        body: whole lines, none with a quoted cell, each with its end.
        width: how many columns they have.

    Raises:
        NotPlainError: not all lines have so many, or a cell is longer than readers of rows take.
    """
    text = np.frombuffer(body, np.uint8)
    ends = np.flatnonzero((text == ord(",")) | (text == ord("\n")))
    rows, rest = divmod(len(ends), width)
    if rest:
        raise NotPlainError("its lines are not all alike")
    table = ends.reshape(rows, width)
    is_end = text[table] == ord("\n")
    if not is_end[:, -1].all() or is_end[:, :-1].any():
        raise NotPlainError("its lines are not all alike")
    starts = np.concatenate(([0], ends[:-1] + 1)).reshape(rows, width)
    if (table - starts).max() > csv.field_size_limit():  # whoever reads rows refuses it
        raise NotPlainError("it has very long cells")
    return lambda index: TextCells(text, starts[:, index], table[:, index])


def _cells(cells: TextCells, column: Column, layout: Layout) -> Cells:
    """A column; an empty cell says nothing."""
    if column.kind is Kind.LABEL:
        raise NotPlainError("labels are no numbers")
    read = READERS[column.kind]
    given = cells.ends > cells.starts
    if given.all():
        return cells_of_array(plain_values(read(cells)), None, column.kind, layout.gaps)
    rows = np.flatnonzero(given)
    some: NDArray[Any] = np.array([], np.float64)
    if len(rows):
        some = plain_values(read(TextCells(cells.text, cells.starts[rows], cells.ends[rows])))
    values = np.zeros(len(given), some.dtype)
    values[rows] = some
    return cells_of_array(values, given, column.kind, layout.gaps)


def plain_values(values: NDArray[Any] | None) -> NDArray[Any]:
    """What a reader of cells found, if it could read them all.

    Raises:
        NotPlainError: it could not.
    """
    if values is None:
        raise NotPlainError("a cell is no plain number or truth value")
    return values
