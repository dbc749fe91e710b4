"""Columns in memory (NumPy arrays, lists, an Arrow table) as samples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral
from typing import Any

from rvmon.errors import TraceError
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Schema
from rvmon.trace.time import TIME_LIMIT, ticks_of_seconds


def columns_of(table: Any) -> dict[str, list[Any]]:
    """Turn a mapping of arrays, or anything with `to_pydict` (Arrow), into lists.

    Raises:
        TraceError: it is neither, or the columns differ in length.

    >>> columns_of({"t": [0, 1], "v": [2.0, 3.0]})
    {'t': [0, 1], 'v': [2.0, 3.0]}
    """
    if hasattr(table, "to_pydict"):
        table = table.to_pydict()
    if not isinstance(table, Mapping):
        raise TraceError(
            f"expected a path, columns by name or (t, values) pairs, found {type(table).__name__}"
        )
    columns = {
        str(name): list(column.tolist() if hasattr(column, "tolist") else column)
        for name, column in table.items()
    }
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"`{name}` {length}" for name, length in lengths.items())
        raise TraceError(f"columns differ in length: {listed}")
    return columns


def column_samples(
    columns: Mapping[str, Sequence[Any]], schema: Schema, time: str = "t"
) -> Iterator[Sample]:
    """One sample per row: every declared signal is updated, events occur where they are true.

    Args:
        columns: of equal length; undeclared ones are passed over.
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
    names = [name for name in columns if name in schema.signals or name in schema.events]
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
            "give seconds in a column whose name does not end in `_ns`"
        )
    t = int(stamp)
    if abs(t) >= TIME_LIMIT:
        raise TraceError(f"time {t} ns is out of range: at most 2**62 ns (146 years)")
    return t
