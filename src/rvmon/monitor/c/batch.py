"""The engine `c`: recordings judged by compiled C. Records have no reasons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import NO, YES, BatchLibrary, BatchRun, Column
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_columns import rows_of_samples
from rvmon.errors import TimeOrderError
from rvmon.monitor.c.recorded import report_of_records
from rvmon.monitor.compiled.code_plan import plan_alone
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.validate import Validator
from rvmon.readers.source import Columns, Source
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.trace.time import format_ticks, whole_ticks
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIECE = 1 << 14
"""Samples that are laid out as columns at a time."""


def library_of(compiled: CompiledSpec, only: Sequence[str] | None) -> BatchLibrary:
    """The compiled monitor of some requirements; compiled once.

    Args:
        compiled: the specification.
        only: ids of the requirements; `None`: all.

    Raises:
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    key = ("c", None if only is None else tuple(only))
    found = compiled.forms.get(key)
    if not isinstance(found, BatchLibrary):
        found = compiled.forms[key] = BatchLibrary(plan_alone(compiled, only))
    return found


def evaluate_columns(
    checked: CheckedSpec, library: BatchLibrary, columns: Columns, end: int | None
) -> Report:
    """Judge a recording by its columns.

    Args:
        checked: the specification.
        library: judges its requirements.
        columns: of the recording: every signal is updated in each row, an event occurs where its
            column is true; NaN is unknown.
        end: of the trace in ticks; `None`: its last row.

    Raises:
        NotPlainError: the columns turn out to be none.
        TimeOrderError: an instant is not after the one before.
    """
    with _Judging(checked, library, frozenset(columns.names)) as judging:
        for block in columns.read():
            judging.take(block.times, array_columns(checked, block.columns))
        return judging.report(end)


def array_columns(spec: CheckedSpec, columns: Mapping[str, NDArray[Any]]) -> dict[str, Column]:
    """Arrays of truth values and numbers as a compiled monitor takes them."""
    made = {}
    for name, column in columns.items():
        if name in spec.signals:
            made[name] = Column(None, column)
        else:
            made[name] = Column(np.where(column, np.uint8(YES), np.uint8(NO)))
    return made


def evaluate_samples(
    checked: CheckedSpec, library: BatchLibrary, source: Source, single: frozenset[str]
) -> Report:
    """Judge a recording by its samples; so many at a time are in memory.

    Args:
        checked: the specification.
        library: judges its requirements.
        source: the recording.
        single: events of which only one payload can be judged at one instant.

    Raises:
        TimeOrderError: an instant is not after the one before.
        TraceError: a name or a value that the specification does not know, or an instant with two
            payloads of one event.
    """
    names = source.names
    if names is not None:
        names = names & {*checked.signals, *checked.events}
    validator = Validator(checked, names, single)

    def valid(sample: Sample) -> Sample:
        return Sample(whole_ticks(sample.t), validator.check(sample.t, sample.values))

    samples = map(valid, source.samples(ordered=True))
    with _Judging(checked, library, names) as judging:
        while some := list(islice(samples, PIECE)):
            rows = rows_of_samples(some, library.names, library.limits)
            judging.take(rows.times, rows.columns, rows.kinds)
        return judging.report(source.end)


def out_of_order(row: int, t: int) -> TimeOrderError:
    """The error of a row at `t` ticks that is not after the one before."""
    return TimeOrderError(
        f"row {row} at {format_ticks(t)} is not after the one before: sort the recording by time"
    )


class _Judging:
    """A run of a compiled monitor over the rows of one recording."""

    def __init__(
        self, checked: CheckedSpec, library: BatchLibrary, names: frozenset[str] | None
    ) -> None:
        declared = frozenset((*checked.signals, *checked.events))
        self._ids = [rule.requirement.id for rule in library.plan.asked]
        self._captured = CapturedValues(library.plan)
        self._run = BatchRun(library, declared - (declared if names is None else names))
        self._rows = 0
        self._origin: int | None = None

    def __enter__(self) -> _Judging:
        return self

    def __exit__(self, *what: object) -> None:
        self._run.__exit__(*what)

    def take(
        self,
        times: NDArray[np.int64],
        columns: Mapping[str, Column],
        kinds: NDArray[np.uint8] | None = None,
    ) -> None:
        taken = self._run.feed(times, columns, kinds)
        if taken < len(times):
            raise out_of_order(self._rows + taken, int(times[taken]))
        if self._origin is None and len(times):
            self._origin = int(times[0])
        self._rows += taken

    def report(self, until: int | None) -> Report:
        made = self._run.close(until)
        return report_of_records(self._ids, made, self._captured, origin=self._origin or 0)
