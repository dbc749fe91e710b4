"""The robustness of whole recordings: by their columns where they have some, else by samples."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Protocol

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.engines.registry import Asked
from rvmon.monitor.evaluate import open_trace
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import FIGURES, Margins, Measured, margins_from
from rvmon.readers.blocks import NotPlainError
from rvmon.readers.reading import Reading
from rvmon.readers.source import Source
from rvmon.trace.sample import Sample
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
    found = _by_columns(compiled, source, only, streams=streams)
    if found is None:
        monitor = RobustnessMonitor(compiled, only, "now", source.names, streams=streams)
        found = margins_from(_stepped(monitor, source.recording, source.end))
    return found


def measuring(judge: Judge) -> Judge:
    """What judges a recording as `judge` does, and gives each attempt its robustness."""

    def measured(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        margins = _by_columns(compiled, source, asked.only, streams=False)
        if margins is None:
            report, margins = _beside(compiled, source, asked, judge)
        else:
            report = judge(compiled, source, asked)
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


def _stepped(
    monitor: RobustnessMonitor, samples: Iterable[Sample], end: int | None
) -> Iterable[Measured]:
    for sample in samples:
        yield from monitor.step_ns(sample.t, sample.values)
    yield from monitor.finish_ns(end)


def _by_columns(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
) -> Margins | None:
    """The figures by columns; `None` if the recording has none that are taken as they are."""
    if source.is_short or compiled.checked.max_delay is not None:
        return None
    planned = planned_core(compiled, only, measured=True)
    try:
        columns = source.columns(lambda: planned.fillable)
        from rvmon.monitor.core.recording import take_columns
        from rvmon.monitor.robustness.recorded import RecordedMargins

        found = RecordedMargins(planned.packed.ids)
        run = planned.monitor(frozenset(planned.numbers) - frozenset(columns.names))
        run.measure(FIGURES, streams)
        take_columns(run, planned, columns, lambda: found.add(run.margins()))
    except NotPlainError:
        return None
    run.finish(source.end)
    found.add(run.margins())
    return found.margins()
