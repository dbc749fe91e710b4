"""The engine `c`: recordings judged by compiled C. Records have no reasons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import NO, YES, BatchLibrary, BatchRun, Column
from rvmon.codegen.c_columns import columns_of_samples
from rvmon.errors import TimeOrderError
from rvmon.monitor.codegen_support import plan_alone
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.engines.registry import Asked
from rvmon.monitor.engines.rows import columns_of
from rvmon.monitor.recorded import report_of_records
from rvmon.monitor.validate import Validator
from rvmon.readers.source import Source
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

    Raises:
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    key = ("c", None if only is None else tuple(only))
    found = compiled.forms.get(key)
    if not isinstance(found, BatchLibrary):
        found = compiled.forms[key] = BatchLibrary(plan_alone(compiled, only))
    return found


def evaluate_columns(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """Judge a recording by its columns.

    Args:
        compiled: the specification.
        source: the recording: every signal is updated in each row, an event occurs where its column
            is true; NaN is unknown.
        asked: what is wanted.

    Raises:
        NotPlainError: it has no such columns.
        TimeOrderError: an instant is not after the one before.
        RvmonError: see `library_of`.
    """
    library = library_of(compiled, asked.only)
    columns = columns_of(compiled, source, asked)
    with _Judging(compiled, library, frozenset(columns.names)) as judging:
        for block in columns.read():
            judging.take(block.times, array_columns(compiled.checked, block.columns))
        return judging.report(source.end)


def array_columns(spec: CheckedSpec, columns: Mapping[str, NDArray[Any]]) -> dict[str, Column]:
    """Arrays of truth values and numbers as a compiled monitor takes them."""
    made = {}
    for name, column in columns.items():
        if name in spec.signals:
            made[name] = Column(None, column)
        else:
            made[name] = Column(np.where(column, np.uint8(YES), np.uint8(NO)))
    return made


def evaluate_samples(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """Judge a recording by its samples; so many at a time are in memory.

    Args:
        compiled: the specification.
        source: the recording.
        asked: what is wanted.

    Raises:
        TimeOrderError: an instant is not after the one before.
        TraceError: a name or a value that the specification does not know, or an instant with two
            payloads of one event.
        RvmonError: see `library_of`.
    """
    library = library_of(compiled, asked.only)
    names = source.names
    if names is not None:
        names = names & {*compiled.checked.signals, *compiled.checked.events}
    validator = Validator(compiled.checked, names, frozenset())

    def checked(sample: Sample) -> Sample:
        return Sample(whole_ticks(sample.t), validator.check(sample.t, sample.values))

    samples = map(checked, source.samples(ordered=True))
    with _Judging(compiled, library, names) as judging:
        while some := list(islice(samples, PIECE)):
            times = np.array([sample.t for sample in some], np.int64)
            judging.take(times, columns_of_samples(some, library.names, library.limits))
        return judging.report(source.end)


class _Judging:
    """A run of a compiled monitor over the rows of one recording."""

    def __init__(
        self, compiled: CompiledSpec, library: BatchLibrary, names: frozenset[str] | None
    ) -> None:
        declared = frozenset((*compiled.checked.signals, *compiled.checked.events))
        self._ids = [rule.requirement.id for rule in library.plan.rules]
        self._run = BatchRun(library, declared - (declared if names is None else names))
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
