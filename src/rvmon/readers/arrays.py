"""Tables in memory as whole columns, where these fit their declarations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.csv_rows import Column, Layout
from rvmon.readers.plain import held_values
from rvmon.readers.ticks import ticks_of_column
from rvmon.trace.gaps import Gaps
from rvmon.trace.schema import Kind, Schema

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WIDEST = 8
"""Bytes of the widest numbers that are numbers of Python, too."""

_EXACT = 1 << 53
"""Floats up to here are the whole numbers that they stand for."""

_PIECE = 1 << 17
"""Instants that are compared together."""


def block_of_table(
    columns: Mapping[str, Any],
    layout: Layout,
    schema: Schema,
    fillable: Callable[[], frozenset[str]],
) -> Block:
    """A table as one block, without copies if possible.

    Args:
        columns: of the table, by name.
        layout: what they are.
        schema: the declared names.
        fillable: gives the names of which "no update" may be read as what was there before: of
            signals the value, of events that they do not occur.

    Raises:
        NotPlainError: a column is something else, holds labels or payloads, or has gaps that may
            matter; stamps are dates, or do not increase.
        TraceError: an instant is not finite or out of range.
    """
    stamps, given = _array_of(columns[layout.stamps.column])
    kinds = {"ns": "i", "iso": ""}.get(layout.stamps.unit, "if")
    if given is not None or stamps.dtype.kind not in kinds:
        raise NotPlainError("its stamps are no plain numbers")
    found = {}
    for column in layout.columns:
        if column.field is not None or column.kind is Kind.LABEL:
            raise NotPlainError(f"`{layout.header[column.index]}` holds no numbers or truth values")
        cells = columns[layout.header[column.index]]
        found[column.name] = _values(cells, column, schema, fillable)
    if any(len(column) != len(stamps) for column in found.values()):
        raise NotPlainError("its columns are not equally long")
    times = ticks_of_column(stamps, layout.stamps)
    if not _ascend(times):
        raise NotPlainError("its instants do not increase")
    return Block(times, found)


def _ascend(times: NDArray[np.int64]) -> bool:
    """Whether instants increase strictly; looked at in pieces that stay near the processor."""
    pieces = (times[start : start + _PIECE + 1] for start in range(0, len(times), _PIECE))
    return all(bool((piece[1:] > piece[:-1]).all()) for piece in pieces)


def _values(
    cells: Any, column: Column, schema: Schema, fillable: Callable[[], frozenset[str]]
) -> NDArray[Any]:
    """A column of which gaps hold what was there before."""
    some, given = _array_of(cells)
    if schema.gaps:
        some, given = _without(some, given, schema.gaps)
    values = _fitted(some, column.kind)
    if given is None:
        return values
    if column.name not in fillable():
        raise NotPlainError(f"whether `{column.name}` is updated matters, and it has gaps")
    if column.name in schema.signals:
        return held_values(values, given, None)
    occurs = np.zeros(len(given), bool)
    occurs[given] = values
    return occurs


def _array_of(column: Any) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
    """The values that a column holds, and where; `None` if everywhere.

    Raises:
        NotPlainError: they are neither truth values nor integers nor floats.
    """
    given = None
    nulls = getattr(column, "null_count", 0)
    if type(column) is np.ma.MaskedArray:
        if np.ma.is_masked(column):
            given = ~np.ma.getmaskarray(column)
        column = column.data if given is None else column.compressed()
    elif hasattr(column, "drop_null"):  # of Arrow
        if nulls:
            given = np.asarray(column.is_valid())
            column = column.drop_null()
        column = column.to_numpy(zero_copy_only=False) if _is_scalar(column) else None
    elif callable(nulls):  # of polars
        if nulls():
            given = column.is_not_null().to_numpy()
            column = column.drop_nulls()
        column = column.to_numpy()
    elif hasattr(column, "isna"):  # of pandas
        column = column.to_numpy() if type(column.dtype).__module__.startswith("numpy") else None
    # A subclass may mean something by its cells that is not seen here.
    if type(column) not in (np.ndarray, np.memmap) or column.ndim != 1:
        raise NotPlainError("a column is no array of numbers or truth values")
    if column.dtype.kind not in "bif" or column.dtype.itemsize > _WIDEST:
        raise NotPlainError("a column is no array of numbers or truth values")
    return column, given


def _is_scalar(column: Any) -> bool:
    """Whether an Arrow array holds numbers or truth values."""
    from pyarrow import types

    kind = column.type
    return bool(types.is_boolean(kind) or types.is_integer(kind) or types.is_floating(kind))


def _without(
    some: NDArray[Any], given: NDArray[np.bool_] | None, gaps: Gaps
) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
    """The same without what stands for no update."""
    kept = np.ones(len(some), bool)
    if gaps.nan and some.dtype.kind == "f":
        kept &= ~np.isnan(some)
    value = gaps.no_update
    if isinstance(value, int | float) and isinstance(value, bool) == (some.dtype.kind == "b"):
        kept &= some != value
    if kept.all():
        return some, given
    if given is None:
        return some[kept], kept
    still = given.copy()
    still[given] = kept
    return some[kept], still


def _fitted(values: NDArray[Any], kind: Kind) -> NDArray[Any]:
    """Values as `rvmon.readers.values.as_declared` takes each."""
    found = values.dtype.kind
    if (kind, found) in ((Kind.BOOL, "b"), (Kind.INT, "i"), (Kind.REAL, "f")) or not len(values):
        return values
    if kind is Kind.REAL and found == "i":
        return values.astype(np.float64)
    if kind is Kind.BOOL and ((values == 0) | (values == 1)).all():
        return values.astype(bool)
    if kind is Kind.INT and found == "f" and (np.abs(values) <= _EXACT).all():
        whole = values.astype(np.int64)
        if (whole == values).all():
            return whole
    raise NotPlainError("a column holds other values than were declared")
