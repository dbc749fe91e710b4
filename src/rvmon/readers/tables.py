"""Columns in memory by the names that the spec declares, their stamps in a unit that is plain."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.readers.columns import arrow_cells, cells_of
from rvmon.readers.doubtful_unit import doubt_unit
from rvmon.readers.naming import aliases_of, sources_among, stamps_among
from rvmon.readers.steps import LOOKED_AT
from rvmon.readers.ticks import ticks_of_column
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import ticks_of_stamp
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.trace.health import Health

_SECONDS, _TICKS = " t", " t_ns"
"""What columns of stamps are called where columns get other names: no declared name has a space."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table whose columns have the declared names.

    Attributes:
        columns: a mapping of arrays or lists, or an Arrow table.
        time: the column of seconds; if its name ends in `_ns`, of ticks.
        stamps: what the column was, as it came.
        names: the signals and events that have a column.
        ignored: the columns that stand for nothing.
    """

    columns: Any
    time: str
    stamps: Stamps
    names: frozenset[str]
    ignored: tuple[str, ...]


def table_of(trace: Any, schema: Schema) -> Table:
    """A table by declared names.

    Args:
        trace: a mapping of arrays or lists, or an Arrow table.
        schema: says by what names the table calls them, and what its stamps are.

    Raises:
        TraceError: it has no such time column, or a stamp is none of that unit.

    >>> schema = Schema({}, {}, Stamps("at", "ms", is_said=True))
    >>> table = table_of({"at": [1, 2]}, schema)
    >>> table.columns[table.time].tolist()
    [1000000, 2000000]
    """
    is_arrow = hasattr(trace, "column_names")
    columns = trace.column_names if is_arrow else [str(name) for name in trace]
    stamps = stamps_among(columns, schema)
    aliases = aliases_of(schema)
    declared = [aliases.get(name, name) for name in columns if name != stamps.column]
    names, others = sources_among(declared, schema)
    ignored = tuple(name for name in others if name)
    plain = "ns" if stamps.column.endswith("_ns") else "s"
    if not aliases and stamps.unit == plain:
        return Table(trace, stamps.column, stamps, names, ignored)
    made, time = [], _SECONDS
    for place, name in enumerate(columns):
        column = trace.column(place) if is_arrow else trace[list(trace)[place]]
        if name != stamps.column:
            made.append((aliases.get(name, name), column))
        elif stamps.unit == "s":
            made.append((_SECONDS, column))
        else:
            made.append((_TICKS, _instants(column, stamps)))
            time = _TICKS
    made = [(name, column) for name, column in made if name]
    built = _arrow_table(trace, made) if is_arrow else dict(made)
    return Table(built, time, stamps, names, ignored)


def _arrow_table(table: Any, columns: Iterable[tuple[str, Any]]) -> Any:
    import pyarrow

    names, arrays = zip(*columns, strict=True)
    plain = [pyarrow.array(one) if isinstance(one, np.ndarray) else one for one in arrays]
    return type(table).from_arrays(plain, names=list(names))


def _instants(column: Any, stamps: Stamps) -> NDArray[np.int64]:
    """Stamps of any unit as ticks."""
    if type(column) is np.ndarray and column.ndim == 1 and column.dtype.itemsize <= 8:
        kinds = {"ns": "i", "iso": ""}.get(stamps.unit, "if")
        if column.dtype.kind in kinds:
            return ticks_of_column(column, stamps)
    made = []
    for row, cell in enumerate(_cells(column, stamps)):
        whole = isinstance(cell, float) and cell.is_integer()
        try:
            made.append(ticks_of_stamp(int(cell) if whole else cell, stamps))
        except TraceError as error:
            raise TraceError(f"row {row}: {error}") from None
    return np.array(made, np.int64)


def _cells(column: Any, stamps: Stamps) -> list[Any]:
    return arrow_cells(column) if hasattr(column, "to_pylist") else cells_of(stamps.column, column)


def unit_doubts(table: Table) -> list[Health]:
    """Whether the stamps of a table that was read look like milliseconds."""
    if table.stamps.is_said or table.stamps.unit != "s":
        return []
    is_arrow = hasattr(table.columns, "column_names")
    column = table.columns.column(table.time) if is_arrow else table.columns[table.time]
    times = [ticks_of_seconds(cell) for cell in _cells(column[:LOOKED_AT], table.stamps)]
    return doubt_unit(times, table.stamps)
