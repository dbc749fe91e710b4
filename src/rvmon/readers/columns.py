"""Columns in memory (NumPy arrays, lists, an Arrow table) as samples."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral
from typing import Any

from rvmon.errors import TraceError
from rvmon.trace.sample import Sample, Trace
from rvmon.trace.schema import Schema
from rvmon.trace.time import ticks_of_seconds, whole_ticks


def trace_of_columns(table: Any, schema: Schema, time: str) -> Trace:
    """Columns as a recording; see `columns_of` and `column_samples` for what is taken and raised.

    >>> trace_of_columns({"t": [0, 1]}, Schema({}, {}), "t").names
    frozenset()
    """
    columns = columns_of(table)
    names = frozenset(columns) & {*schema.signals, *schema.events} - {time}
    return Trace(tuple(column_samples(columns, schema, time)), names)


def columns_of(table: Any) -> dict[str, list[Any]]:
    """Turn a mapping of arrays, or an Arrow table, into lists.

    Raises:
        TraceError: it is neither, a column is none, there are two of a name, or they differ in
            length.

    >>> columns_of({"t": [0, 1], "v": [2.0, 3.0]})
    {'t': [0, 1], 'v': [2.0, 3.0]}
    """
    if hasattr(table, "column_names"):
        columns = _arrow_columns(table)
    elif isinstance(table, Mapping):
        columns = {str(name): cells_of(name, column) for name, column in table.items()}
    else:
        raise TraceError(
            f"expected a path, columns by name or (t, values) pairs, found {type(table).__name__}"
        )
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"`{name}` {length}" for name, length in lengths.items())
        raise TraceError(f"columns differ in length: {listed}")
    return columns


def _arrow_columns(table: Any) -> dict[str, list[Any]]:
    names = table.column_names
    for name in names:
        if names.count(name) > 1:
            raise TraceError(f"column `{name}` stands twice in the table")
    return {name: arrow_cells(table.column(name)) for name in names}


def arrow_cells(column: Any) -> list[Any]:
    """The cells of an Arrow array; dates and durations as text: they are no numbers of seconds."""
    from pyarrow import types

    if types.is_temporal(column.type):
        return [str(cell) for cell in column.to_numpy(zero_copy_only=False)]
    cells: list[Any] = column.to_pylist()
    return cells


def cells_of(name: Any, column: Any) -> list[Any]:
    """The cells of an array or a list, as `arrow_cells` gives them."""
    if getattr(column, "ndim", 1) > 0 and not isinstance(column, str | bytes):
        if getattr(getattr(column, "dtype", None), "kind", None) in ("m", "M"):
            return [str(cell) for cell in column]
        try:
            return list(column.tolist() if hasattr(column, "tolist") else column)
        except TypeError:
            pass
    found = reprlib.repr(column)
    raise TraceError(f"column `{name}`: expected an array or a list of values, found {found}")


def column_samples(
    columns: Mapping[str, Sequence[Any]], schema: Schema, time: str = "t"
) -> Iterator[Sample]:
    """One sample per row: every declared signal is updated, events occur where they are true.

    Args:
        columns: of equal length; undeclared ones are passed over, and so is a signal or event by
            the name of the time column, as in files.
        schema: the declared names.
        time: the column of seconds; if its name ends in `_ns`, of integer ticks.

    Raises:
        TraceError: there is no such time column, or an instant is no finite number; of ticks, no
            whole one.
    """
    if time not in columns:
        raise TraceError(
            f"no time column `{time}`: name it with time=…; there are {', '.join(columns)}"
        )
    names = [
        name
        for name in columns
        if name != time and (name in schema.signals or name in schema.events)
    ]
    in_ticks = time.endswith("_ns")
    for row, stamp in enumerate(columns[time]):
        t = _ticks(stamp, time, row) if in_ticks else ticks_of_seconds(stamp)
        yield Sample(t, {name: columns[name][row] for name in names})


def _ticks(stamp: Any, time: str, row: int) -> int:
    """A stamp of ticks: a whole number, be it held as a float."""
    whole = isinstance(stamp, Integral) and not isinstance(stamp, bool)
    if not whole and not (isinstance(stamp, float) and stamp.is_integer()):
        raise TraceError(
            f"`{time}` holds whole numbers of ticks (ns), found {stamp!r} in row {row}: "
            "give integers, or seconds in a column whose name does not end in `_ns`"
        )
    return whole_ticks(int(stamp))
