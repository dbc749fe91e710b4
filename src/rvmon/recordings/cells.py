"""Conversion of columns (NumPy arrays, Arrow arrays, Python values) to cells and batches."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from rvmon.recordings.batch import (
    NO,
    NO_UPDATE,
    UNKNOWN,
    YES,
    Batch,
    Cells,
    NotPlainError,
    Occurrences,
)
from rvmon.recordings.csv_rows import Column, Layout
from rvmon.recordings.values import as_declared, fits, plain
from rvmon.trace.schema import Gaps, Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

_EXACT = 1 << 53  # up to here, a float represents every integer exactly
_WIDEST = 8  # bytes; wider numbers (long double) are no Python numbers

_TYPES = {Kind.BOOL: np.bool_, Kind.INT: np.int64, Kind.REAL: np.float64, Kind.LABEL: np.int32}


def batch_of(
    times: NDArray[np.int64],
    layout: Layout,
    columns: Mapping[Column, Cells],
    first: int = 0,
    lines: NDArray[np.int64] | None = None,
) -> Batch:
    """Make a batch of columns, with the meaning of `rvmon.recordings.csv_rows.row_values`.

    `first` and `lines` are those of `Batch`.
    """
    signals = {signal.name: columns[signal] for signal in layout.signals}
    payloads: dict[str, dict[str, Cells]] = {}
    own: dict[str, Cells] = {}
    for column in layout.events:
        if column.field is None:
            own[column.name] = columns[column]
            payloads.setdefault(column.name, {})
        else:
            payloads.setdefault(column.name, {})[column.field] = columns[column]
    events = {}
    for name, fields in payloads.items():
        states = occurrences(own.get(name), fields.values(), len(times))
        given = {field: _only_where(cells, states != NO) for field, cells in fields.items()}
        events[name] = Occurrences(states, given)
    return Batch(times, signals, events, first, lines)


def _only_where(cells: Cells, rows: NDArray[np.bool_]) -> Cells:
    """The cells with "no update" in the rows where the mask is false."""
    if rows.all():
        return cells
    states = np.uint8(YES) if cells.states is None else cells.states
    return replace(cells, states=np.where(rows, states, np.uint8(NO_UPDATE)))


def occurrences(own: Cells | None, fields: Iterable[Cells], count: int) -> NDArray[np.uint8]:
    """The entries of an event per row, uint8[n].

    An event occurs where its own cell says so, and where a payload field has a cell, unless its own
    cell is false.
    """
    if own is None:
        states = np.full(count, NO_UPDATE, np.uint8)
    else:
        states = np.where(own.values, np.uint8(YES), np.uint8(NO))
        if own.states is not None:
            states = np.where(own.states == YES, states, own.states)
    for field in fields:
        given = np.True_ if field.states is None else field.states != NO_UPDATE
        states = np.where(given & (states != NO), np.uint8(YES), states)
    return states


def cells_of_array(
    values: NDArray[Any], given: NDArray[np.bool_] | None, kind: Kind, gaps: Gaps
) -> Cells:
    """Convert an array to cells.

    `given`: bool[n], the rows that have a value; `None`: all.

    Raises:
        NotPlainError: the array holds values of another kind than the declared one.
    """
    found = values.dtype.kind
    if found not in "bif" or values.dtype.itemsize > _WIDEST or kind is Kind.LABEL:
        raise NotPlainError("a column is no array of numbers or truth values")
    if gaps:
        stays = kept(values, gaps)
        if not stays.all():
            given = stays if given is None else given & stays
    states = None if given is None else np.where(given, np.uint8(YES), np.uint8(NO_UPDATE))
    if (kind, found) in ((Kind.BOOL, "b"), (Kind.INT, "i")):
        return Cells(values.astype(_TYPES[kind], copy=False), states)
    if kind is Kind.REAL and found in "if":
        return Cells(values.astype(np.float64, copy=False), states)
    if kind is Kind.REAL or found == "b":
        raise NotPlainError("a column holds other values than were declared")
    known = np.True_ if found != "f" else values == values
    looked_at = known if given is None else known & given
    whole = np.where(looked_at, values, 0)
    least, most = (0, 1) if kind is Kind.BOOL else (-_EXACT, _EXACT)
    is_within = ((least <= whole) & (whole <= most)).all()  # else NumPy warns of the cast below
    if not is_within or ((made := whole.astype(np.int64)) != whole).any():
        raise NotPlainError("a column holds other values than were declared")
    if not known.all():
        states = np.full(len(values), YES, np.uint8) if states is None else states
        states[~known & (states == YES)] = UNKNOWN
    return Cells(made.astype(_TYPES[kind], copy=False), states)


def kept(values: NDArray[Any], gaps: Gaps) -> NDArray[np.bool_]:
    """A mask of the values that do not mean "no update", bool[n]."""
    found = np.ones(len(values), bool)
    if gaps.nan and values.dtype.kind == "f":
        found &= values == values
    value = gaps.no_update
    if isinstance(value, int | float) and isinstance(value, bool) == (values.dtype.kind == "b"):
        found &= values != value
    return found


def cells_of_labels(
    places: NDArray[Any], given: NDArray[np.bool_] | None, labels: Sequence[Any], gaps: Gaps
) -> Cells:
    """Convert indices into `labels` to cells; `given` as for `cells_of_array`.

    Raises:
        NotPlainError: a label is no text.
    """
    if not all(isinstance(label, str) for label in labels):
        raise NotPlainError("a label is not text")
    if gaps.no_update in labels:
        kept = places != list(labels).index(gaps.no_update)
        given = kept if given is None else given & kept
    states = None if given is None else np.where(given, np.uint8(YES), np.uint8(NO_UPDATE))
    return Cells(places.astype(np.int32, copy=False), states, tuple(labels))


def cells_of_values(cells: Sequence[Any], kind: Kind, gaps: Gaps, nothing: object = None) -> Cells:
    """Convert Python values to cells; the object `nothing` means "no update".

    Raises:
        NotPlainError: a value is not of the declared kind.
    """
    made = None if gaps else _cells_alike(cells, kind, nothing)
    if made is not None:
        return made
    labels: dict[str, int] = {}
    values: list[Any] = []
    states: list[int] = []
    for cell in cells:
        value = plain(cell)
        if value is nothing or gaps.holds(value):
            state, value = NO_UPDATE, 0
        else:
            value = as_declared(value, kind)
            if not fits(value, kind):
                raise NotPlainError("a column holds other values than were declared")
            state = YES if value is not None else UNKNOWN
            if kind is Kind.LABEL and value is not None:
                value = labels.setdefault(value, len(labels))
        values.append(value or 0)
        states.append(state)
    every = states.count(YES) == len(states)
    return Cells(
        _array(values, kind),
        None if every else np.array(states, np.uint8),
        (tuple(labels) or ("",)) if kind is Kind.LABEL else None,
    )


_ALIKE: Mapping[Kind, frozenset[type]] = {
    Kind.BOOL: frozenset({bool}),
    Kind.INT: frozenset({int}),
    Kind.REAL: frozenset({float, int}),
    Kind.LABEL: frozenset({str}),
}


def _cells_alike(cells: Sequence[Any], kind: Kind, nothing: object) -> Cells | None:
    """The cells of values that all have the kind's own type or are `nothing`; else `None`.

    This common case needs no look at each value: NumPy converts the whole list.
    """
    types = set(map(type, cells))
    if types <= _ALIKE[kind]:
        if kind is not Kind.LABEL:
            return Cells(_array(cells, kind))
        labels = {label: place for place, label in enumerate(dict.fromkeys(cells))}
        places = np.fromiter(map(labels.__getitem__, cells), np.int32, len(cells))
        return Cells(places, None, tuple(labels) or ("",))
    if type(nothing) not in types or not types - {type(nothing)} <= _ALIKE[kind]:
        return None
    given = np.fromiter((cell is not nothing for cell in cells), bool, len(cells))
    some = _cells_alike([cell for cell in cells if cell is not nothing], kind, nothing)
    if some is None:
        return None
    values = np.zeros(len(cells), some.values.dtype)
    values[given] = some.values
    return Cells(values, np.where(given, np.uint8(YES), np.uint8(NO_UPDATE)), some.labels)


def _array(values: Sequence[Any], kind: Kind) -> NDArray[Any]:
    try:
        return np.array(values, _TYPES[kind])
    except OverflowError:
        raise NotPlainError("a number is too large") from None


def cells_of_arrow(column: Any, kind: Kind, gaps: Gaps) -> Cells:
    """Convert an Arrow array to cells; null is no update.

    Raises:
        NotPlainError: the array holds values of another kind than the declared one.
    """
    import pyarrow
    from pyarrow import types

    if hasattr(column, "combine_chunks") and hasattr(column, "num_chunks"):
        column = column.combine_chunks()
        if isinstance(column, pyarrow.ChunkedArray):
            column = pyarrow.concat_arrays(column.chunks) if column.num_chunks else column
    given = np.asarray(column.is_valid()) if column.null_count else None
    type_ = column.type
    if kind is Kind.LABEL:
        if not types.is_dictionary(type_):
            if not (types.is_string(type_) or types.is_large_string(type_)):
                raise NotPlainError("a column holds other values than were declared")
            column = column.dictionary_encode()
        places = column.indices.fill_null(0) if given is not None else column.indices
        labels = column.dictionary.to_pylist() or [""]
        return cells_of_labels(places.to_numpy(zero_copy_only=False), given, labels, gaps)
    if not (types.is_boolean(type_) or types.is_integer(type_) or types.is_floating(type_)):
        raise NotPlainError("a column holds other values than were declared")
    if given is not None:
        column = column.fill_null(False if types.is_boolean(type_) else 0)
    return cells_of_array(column.to_numpy(zero_copy_only=False), given, kind, gaps)


def cells_of_column(name: str, column: Any, kind: Kind, gaps: Gaps) -> Cells:
    """Convert a column of a table in memory; see `rvmon.recordings.tables.columns_by_name`.

    Raises:
        NotPlainError: the column holds values of another kind than the declared one.
        TraceError: the object is no array or list.
    """
    from rvmon.recordings.tables import cells_of

    given = None
    values = column
    if hasattr(column, "combine_chunks") or hasattr(column, "to_pylist"):
        return cells_of_arrow(column, kind, gaps)
    if type(column) is np.ma.MaskedArray:
        given = ~np.ma.getmaskarray(column) if np.ma.is_masked(column) else None
        values = column.data
    elif callable(getattr(column, "to_arrow", None)) and callable(
        getattr(column, "null_count", None)
    ):  # polars
        if kind is not Kind.LABEL and not column.null_count():
            values = column.to_numpy()
    elif hasattr(column, "isna") and type(column.dtype).__module__.startswith("numpy"):
        values = column.to_numpy()  # pandas
    is_array = type(values) in (np.ndarray, np.memmap) and values.ndim == 1
    if is_array and kind is not Kind.LABEL and values.dtype.kind in "bif":
        return cells_of_array(values, given, kind, gaps)
    return cells_of_values(cells_of(name, column), kind, gaps)
