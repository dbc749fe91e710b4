"""The robustness of whole recordings: by arrays where their columns allow it, else by a monitor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Protocol

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.monitor.engines.rows import columns_of
from rvmon.monitor.evaluate import open_trace
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import (
    Key,
    Margins,
    Measured,
    Robustness,
    Stream,
    margins_from,
)
from rvmon.readers.as_blocks import Columns
from rvmon.readers.batch import NotPlainError
from rvmon.readers.reading import Reading
from rvmon.readers.source import Source
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report


class Judge(Protocol):
    """Judges a recording."""

    def __call__(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """See `rvmon.monitor.engines.registry.Engine`."""


def margins_of(
    compiled: CompiledSpec,
    trace: Any,
    reading: Reading,
    *,
    only: Sequence[str] | None = None,
    until: int | None = None,
    streams: bool = True,
) -> Margins:
    """The robustness of all attempts on a trace.

    Args:
        compiled: the specification.
        trace: as `Spec.evaluate` takes it; so are the errors.
        reading: how it is read.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.
        streams: whether to measure each position, too.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    named = "" if reading.sources is None else "its sources are named"
    source = Source(recording, until, row_by_row=named)
    asked = Asked(None if only is None else tuple(only))
    found = _by_columns(compiled, source, asked, engine_named("auto").judge, streams=streams)
    return _by_samples(compiled, source, asked, streams=streams) if found is None else found[1]


def measuring(judge: Judge) -> Judge:
    """What judges a recording as `judge` does, and gives each attempt its robustness."""

    def measured(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        found = _by_columns(compiled, source, asked, judge, streams=False)
        report, margins = found or _beside(compiled, source, asked, judge)
        return replace(report, attempts=tuple(map(margins.of, report.attempts)))

    return measured


def _beside(
    compiled: CompiledSpec, source: Source, asked: Asked, judge: Judge
) -> tuple[Report, Margins]:
    """A report, and the figures by a monitor that sees each sample once it was judged."""
    monitor = RobustnessMonitor(compiled, asked.only, "now", source.names)
    found: list[Measured] = []

    def read(recording: Any) -> Iterable[Sample]:
        for sample in source.read(recording):
            yield sample
            if source.until is None or sample.t <= source.until:
                found.extend(monitor.step_ns(sample.t, sample.values))

    reason = source.row_by_row or "robustness is found sample by sample"
    report = judge(compiled, replace(source, row_by_row=reason, read=read), asked)
    return report, margins_from([*found, *monitor.finish_ns(source.end)])


def _by_samples(compiled: CompiledSpec, source: Source, asked: Asked, *, streams: bool) -> Margins:
    """The figures by a monitor."""
    monitor = RobustnessMonitor(compiled, asked.only, "now", source.names, streams=streams)
    found = [one for sample in source.recording for one in monitor.step_ns(sample.t, sample.values)]
    return margins_from([*found, *monitor.finish_ns(source.end)])


def _by_columns(
    compiled: CompiledSpec, source: Source, asked: Asked, judge: Judge, *, streams: bool
) -> tuple[Report, Margins] | None:
    """A report and the figures by arrays; `None` if something has to be measured by samples."""
    if source.is_short:
        return None
    try:
        columns = columns_of(compiled, source, asked)
    except NotPlainError:
        return None
    from rvmon.monitor.columns.leaves import NotByColumnsError

    try:
        return _measured(compiled, source, columns, asked, judge, streams=streams)
    except (NotPlainError, NotByColumnsError):
        return None


def _measured(
    compiled: CompiledSpec,
    source: Source,
    columns: Columns,
    asked: Asked,
    judge: Judge,
    *,
    streams: bool,
) -> tuple[Report, Margins]:
    """As `_by_columns`, of what has columns.

    Raises:
        NotByColumnsError: something of it has to be measured sample by sample.
        NotPlainError: the columns turn out to be none.
    """
    import numpy as np

    from rvmon.monitor.columns.margins import ColumnMargins, WholeColumns

    trace = WholeColumns(compiled.checked, columns, source.end)
    measured = {
        one.requirement.id: ColumnMargins(trace, one) for one in compiled.chosen(asked.only)
    }
    report = judge(compiled, source, asked)
    started: dict[str, list[tuple[int, int]]] = {name: [] for name in measured}
    for name, number, triggered in _starts(report.attempts):
        started[name].append((number, triggered))
    attempts: dict[Key, Robustness] = {}
    found: dict[str, Stream] = {}
    for name, margins in measured.items():
        numbers, instants = np.array(started[name], np.int64).reshape(-1, 2).T
        figures = map(Robustness, *(bound.tolist() for bound in margins.at(instants)))
        keys = ((name, number) for number in numbers.tolist())
        attempts |= zip(keys, figures, strict=True)
        if streams:
            times = trace.times if trace.sparse else np.union1d(trace.times, instants)
            found[name] = Stream(times, *margins.at(times))
    return report, Margins(attempts, {}, found)


def _starts(attempts: Sequence[Attempt]) -> Iterator[tuple[str, int, int]]:
    """Of each attempt the requirement, its number, and the instant of its trigger.

    Raises:
        NotByColumnsError: one of them is in doubt.
    """
    from rvmon.monitor.columns.leaves import NotByColumnsError
    from rvmon.monitor.columns.records import JudgedAttempts

    rest = attempts
    if isinstance(attempts, JudgedAttempts):
        for part in attempts.parts:
            numbers, instants = part.decisions.number.tolist(), part.decisions.triggered.tolist()
            yield from ((part.id, *one) for one in zip(numbers, instants, strict=True))
        rest = attempts.kept
    for attempt in rest:
        if attempt.in_doubt:
            raise NotByColumnsError
        yield attempt.requirement, attempt.number, attempt.triggered
