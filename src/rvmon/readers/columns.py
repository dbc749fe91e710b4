"""Columns in memory as samples, row by row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral
from typing import Any

from rvmon.errors import TraceError
from rvmon.readers.csv_rows import Layout, layout_of, row_values
from rvmon.readers.gaps import Gaps
from rvmon.readers.tables import cells_of
from rvmon.readers.values import plain
from rvmon.trace.sample import Value
from rvmon.trace.schema import Schema
from rvmon.trace.time import ticks_of_seconds, whole_ticks


def time_column(names: Mapping[str, Any], time: str) -> str:
    """The time column that is meant: `t_ns` stands for `t`, as in files, where there is no `t`.

    Raises:
        TraceError: there is no such column.

    >>> time_column({"t_ns": []}, "t")
    't_ns'
    """
    if time in names:
        return time
    if time == "t" and "t_ns" in names:
        return "t_ns"
    raise TraceError(f"no time column `{time}`: name it with time=…; there are {', '.join(names)}")


class Table:
    """Columns as rows, all of which are in memory.

    Attributes:
        layout: what the columns are.

    >>> from rvmon.readers.gaps import NO_GAPS
    >>> from rvmon.trace.schema import Kind
    >>> table = Table({"t": [0, 1], "v": [2, None]}, Schema({"v": Kind.REAL}, {}), "t")
    >>> list(table.rows(NO_GAPS))
    [(0, 0, {'v': 2.0}), (1, 1000000000, {})]
    """

    def __init__(self, columns: Mapping[str, Any], schema: Schema, time: str) -> None:
        """Look at columns.

        Args:
            columns: see `rvmon.readers.tables.columns_by_name`; undeclared ones are passed over,
                and so is a signal or event by the name of the time column, as in files.
            schema: the declared names.
            time: the column of seconds; if its name ends in `_ns`, of integer ticks.

        Raises:
            TraceError: there is no such time column, a column is none, or they differ in length.
        """
        self._time = time_column(columns, time)
        self.layout: Layout = layout_of(list(columns), self._time, schema)
        names = [self._time, *(column.called for column in self.layout.columns)]
        cells = {name: cells_of(name, columns[name]) for name in names}
        lengths = {name: len(column) for name, column in cells.items()}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"`{name}` {length}" for name, length in lengths.items())
            raise TraceError(f"columns differ in length: {listed}")
        self._stamps = cells[self._time]
        self._cells = [cells[column.called] for column in self.layout.columns]

    def rows(self, gaps: Gaps) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
        """Number from 0, ticks and values of each row.

        Raises:
            TraceError: an instant is no finite number; of ticks, no whole one.
        """
        in_ticks = self.layout.in_ticks
        for row, (stamp, *cells) in enumerate(zip(self._stamps, *self._cells, strict=True)):
            t = _ticks(stamp, self._time, row) if in_ticks else ticks_of_seconds(stamp)
            yield row, t, values_of_cells(self.layout, cells, gaps)


def values_of_cells(layout: Layout, cells: Sequence[Any], gaps: Gaps) -> dict[str, Value]:
    """What a row of values says; `None` is absent.

    Args:
        layout: what the columns are.
        cells: in the order of its columns.
        gaps: further values that stand for no update.
    """
    found = zip(layout.columns, map(plain, cells), strict=True)
    return row_values(((column, cell) for column, cell in found if cell is not None), gaps)


def _ticks(stamp: Any, time: str, row: int) -> int:
    """A stamp of ticks: a whole number, be it held as a float."""
    whole = isinstance(stamp, Integral) and not isinstance(stamp, bool)
    if not whole and not (isinstance(stamp, float) and stamp.is_integer()):
        raise TraceError(
            f"`{time}` holds whole numbers of ticks (ns), found {stamp!r} in row {row}: "
            "give integers, or seconds in a column whose name does not end in `_ns`"
        )
    return whole_ticks(int(stamp))
