"""Arrays of Arrow as columns, one batch of rows after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.cells import array_of
from rvmon.readers.csv_rows import Column, Layout
from rvmon.readers.plain import held_values
from rvmon.trace.schema import Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FITTING = {Kind.BOOL: "b", Kind.INT: "i", Kind.REAL: "fi"}


def block_of_arrays(
    times: NDArray[np.int64],
    arrays: Sequence[Any],
    layout: Layout,
    fillable: frozenset[str],
    held: Mapping[str, Any],
) -> Block:
    """Some rows.

    Args:
        times: of the rows.
        arrays: in the order of `Layout.columns`, of numbers and truth values.
        layout: what they are.
        fillable: the names of which "no update" may be read as what was there before: of signals
            the value, of events that they do not occur.
        held: what signals held before the first row.

    Raises:
        NotPlainError: a null stands where it may matter, or an array holds something else.
    """
    found = {}
    for column, cells in zip(layout.columns, arrays, strict=True):
        if cells.null_count and column.name not in fillable:
            raise NotPlainError(f"`{column.name}` has gaps that may matter")
        if column in layout.events:
            found[column.name] = _occurrences(cells)
        else:
            found[column.name] = _values(cells, column, held.get(column.name))
    return Block(times, found)


def _occurrences(cells: Any) -> NDArray[Any]:
    """Where an event occurs; a null says that it does not."""
    from pyarrow import types

    if not types.is_boolean(cells.type):
        raise NotPlainError("an event has payloads")
    return array_of(cells.fill_null(False) if cells.null_count else cells, "b")


def _values(cells: Any, column: Column, before: Any | None) -> NDArray[Any]:
    """A signal of which nulls hold the value above them."""
    kinds = _FITTING[column.kind]
    if not cells.null_count:
        return array_of(cells, kinds)
    return held_values(array_of(cells.drop_null(), kinds), np.asarray(cells.is_valid()), before)
