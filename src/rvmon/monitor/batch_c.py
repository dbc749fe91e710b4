"""The engine `c`: recordings judged by compiled C. Records have no reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import NO, YES, BatchLibrary, BatchRun, Column
from rvmon.codegen.c_columns import columns_of_samples
from rvmon.errors import TimeOrderError
from rvmon.monitor.codegen_support import plan_alone
from rvmon.monitor.compiled import CompiledSpec
from rvmon.monitor.recorded import report_of_records
from rvmon.monitor.validate import Validator
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Recording, Sample
from rvmon.trace.time import format_ticks, whole_ticks
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIECE = 1 << 14
"""Samples that are laid out as columns at a time."""


def library_of(compiled: CompiledSpec, only: Sequence[str] | None) -> BatchLibrary:
    """The compiled monitor of some requirements; compiled once.

    Raises:
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    key = ("c", None if only is None else tuple(only))
    found = compiled.forms.get(key)
    if not isinstance(found, BatchLibrary):
        found = compiled.forms[key] = BatchLibrary(plan_alone(compiled, only))
    return found


def evaluate_c_blocks(
    compiled: CompiledSpec,
    names: Sequence[str],
    blocks: Iterable[tuple[NDArray[np.int64], Mapping[str, NDArray[Any]]]],
    *,
    only: Sequence[str] | None,
    until: int | None,
) -> Report:
    """Judge columns of truth values and numbers.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: instants (int64[n] ticks) and the columns by name, of equal length: every signal is
            updated in each row, an event occurs where its column is true; NaN is unknown.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last row.

    Raises:
        TimeOrderError: an instant is not after the one before.
    """
    with _Judging(compiled, only, frozenset(names)) as judging:
        for times, columns in blocks:
            judging.take(times, array_columns(compiled.checked, columns))
        return judging.report(until)


def array_columns(spec: CheckedSpec, columns: Mapping[str, NDArray[Any]]) -> dict[str, Column]:
    """Arrays of truth values and numbers as a compiled monitor takes them."""
    made = {}
    for name, column in columns.items():
        if name in spec.signals:
            made[name] = Column(None, column)
        else:
            made[name] = Column(np.where(column, np.uint8(YES), np.uint8(NO)))
    return made


def evaluate_recording(
    compiled: CompiledSpec,
    recording: Recording,
    *,
    sources: frozenset[str] | None,
    only: Sequence[str] | None,
    until: int | None,
) -> Report:
    """Judge a recording; so many samples at a time are in memory.

    Args:
        compiled: the specification.
        recording: its samples.
        sources: the names that can arrive; `None`: all.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.

    Raises:
        TimeOrderError: an instant is not after the one before.
        TraceError: a name or a value that the specification does not know, or an instant with two
            payloads of one event.
    """
    validator = Validator(compiled.checked, sources, frozenset())

    def checked(sample: Sample) -> Sample:
        return Sample(whole_ticks(sample.t), validator.check(sample.t, sample.values))

    samples = map(checked, recording)
    with _Judging(compiled, only, sources) as judging:
        library = judging.library
        while some := list(islice(samples, PIECE)):
            times = np.array([sample.t for sample in some], np.int64)
            judging.take(times, columns_of_samples(some, library.names, library.limits))
        return judging.report(until)


class _Judging:
    """A run of a compiled monitor over the rows of one recording."""

    def __init__(
        self, compiled: CompiledSpec, only: Sequence[str] | None, names: frozenset[str] | None
    ) -> None:
        declared = frozenset((*compiled.checked.signals, *compiled.checked.events))
        self.library = library_of(compiled, only)
        self._ids = [rule.requirement.id for rule in self.library.plan.rules]
        self._run = BatchRun(self.library, declared - (declared if names is None else names))
        self._rows = 0
        self._origin: int | None = None

    def __enter__(self) -> _Judging:
        return self

    def __exit__(self, *what: object) -> None:
        self._run.__exit__(*what)

    def take(self, times: NDArray[np.int64], columns: Mapping[str, Column]) -> None:
        taken = self._run.feed(times, columns)
        if taken < len(times):
            raise TimeOrderError(
                f"row {self._rows + taken} at {format_ticks(int(times[taken]))} is not after the "
                "one before: sort the recording by time"
            )
        if self._origin is None and len(times):
            self._origin = int(times[0])
        self._rows += taken

    def report(self, until: int | None) -> Report:
        return report_of_records(self._ids, self._run.close(until), origin=self._origin or 0)
