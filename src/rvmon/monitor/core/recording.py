"""Recordings that the core judges: of columns their blocks, else each sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import rvmon.core._core as native
from rvmon.errors import TimeOrderError
from rvmon.monitor.core.planned import PlannedCore
from rvmon.monitor.core.recorded import report_of_run
from rvmon.monitor.inputs.validate import Validator
from rvmon.readers.source import Columns, Source
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.schema import Kind
from rvmon.trace.time import format_ticks, whole_ticks
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SOME = 4096

_NO, _YES = np.uint8(0), np.uint8(2)
"""What a row says of an event; see `core.h`."""

_TYPES: Mapping[Kind, tuple[int, Any]] = {
    Kind.REAL: (0, np.float64),
    Kind.INT: (1, np.int64),
    Kind.BOOL: (2, np.bool_),
}
"""How a column is laid out: its number in `core.h`, and the type of its values."""


def judge_columns(planned: PlannedCore, columns: Columns, end: int | None) -> Report:
    """Judge a recording by its columns.

    Args:
        planned: the plan of the requirements.
        columns: of the recording: every signal is updated in each row, an event occurs where its
            column is true; NaN is unknown.
        end: of the trace in ticks; `None`: its last row.

    Raises:
        NotPlainError: the columns turn out to be none.
        TimeOrderError: an instant is not after the one before.
    """
    run = planned.monitor(frozenset(planned.numbers) - frozenset(columns.names))
    take_columns(run, planned, columns)
    origin, _, _ = run.times()
    return report_of_run(planned, run, origin or 0, run.finish(end))


def take_columns(
    run: native.Monitor,
    planned: PlannedCore,
    columns: Columns,
    after_some: Callable[[], object] | None = None,
) -> None:
    """Have a run take a recording by its columns; see `judge_columns`.

    Args:
        run: of the plan.
        planned: the plan of the requirements.
        columns: of the recording.
        after_some: called each time when so many rows were taken as suit a cache of the processor.
    """
    before = 0
    for block in columns.read():
        times = np.ascontiguousarray(block.times, np.int64)
        laid = [_column(planned, name, values) for name, values in block.columns.items()]
        size = len(times) if after_some is None else _SOME
        for first in range(0, len(times), size or 1):
            rows = slice(first, first + size)
            taken = run.rows(times[rows], tuple(_part(one, rows) for one in laid))
            if taken < len(times[rows]):
                row = first + taken
                raise _out_of_order(before + row, int(times[row]))
            if after_some is not None:
                after_some()
        before += len(times)


_Column = tuple[int, int, "NDArray[Any] | None", "NDArray[np.uint8] | None"]


def _part(column: _Column, rows: slice) -> _Column:
    number, layout, *arrays = column
    values, says = (None if one is None else one[rows] for one in arrays)
    return number, layout, values, says


def _column(planned: PlannedCore, name: str, values: NDArray[Any]) -> _Column:
    """A column as `native.Monitor.rows` takes it."""
    number, kind = planned.numbers[name], planned.packed.signals.get(name)
    if kind is None:
        return number, 0, None, np.where(values, _YES, _NO)
    layout, type_ = _TYPES[kind]
    return number, layout, np.ascontiguousarray(values, type_), None


def judge_samples(checked: CheckedSpec, planned: PlannedCore, source: Source) -> Report:
    """Judge a recording by its samples.

    Args:
        checked: the specification.
        planned: the plan of its requirements.
        source: the recording.

    Raises:
        TimeOrderError: an instant is not after the one before.
        TraceError: a name or a value that the specification does not know, or an instant with two
            payloads of one event.
    """
    declared = frozenset(planned.numbers)
    names = source.names
    expected = None if names is None else names & declared
    validator = Validator(checked, expected, planned.single_payloads)
    run = planned.monitor(frozenset() if names is None else declared - names)
    for row, sample in enumerate(source.samples(ordered=True)):
        t = whole_ticks(sample.t)
        if run.judge(t, sample.values, False):
            continue
        values = planned.plain(t, validator.check(t, sample.values))
        if not run.judge(t, values, True):
            raise _out_of_order(row, t)
    origin, _, _ = run.times()
    return report_of_run(planned, run, origin or 0, run.finish(source.end))


def _out_of_order(row: int, t: int) -> TimeOrderError:
    """The error of a row at `t` ticks that is not after the one before."""
    return TimeOrderError(
        f"row {row} at {format_ticks(t)} is not after the one before: sort the recording by time"
    )
