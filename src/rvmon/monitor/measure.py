"""The robustness of whole recordings, found by the core as they are read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.evaluate import open_trace
from rvmon.monitor.judge import Asked, judge_source
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import FIGURES, Margins, Measured, margins_from
from rvmon.readers.reading import Reading
from rvmon.readers.source import Source
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.readers.batch import Batch

_ROWS = 4096
"""So many are measured, and their figures taken, at once: they suit a cache of the processor."""


class _Run(Protocol):
    """Measures a recording."""

    def take(self, piece: Batch | Sample) -> None:
        """Take what comes next."""

    def margins(self) -> Margins:
        """End the run."""


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
    source = Source(recording, until)
    run = _run_of(compiled, source, only, streams=streams)
    for piece in _pieces(compiled, source):
        run.take(piece)
    return run.margins()


def judge_and_measure(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """Judge a recording, and give each attempt its robustness.

    The recording is read once: each piece is measured, then judged. Arguments and errors are those
    of `judge_source`.
    """
    run = _run_of(compiled, source, asked.only, streams=False)

    def shown(pieces: Iterator[Any]) -> Iterator[Any]:
        for piece in source.shown(pieces):
            _take_to_end(run, source, piece)  # nobody may come back behind the last one
            yield piece

    report = judge_source(compiled, replace(source, shown=shown), asked)
    margins = run.margins()
    return replace(report, attempts=tuple(map(margins.of, report.attempts)))


def _take_to_end(run: _Run, source: Source, piece: Batch | Sample) -> None:
    """Take a piece as far as the trace goes."""
    until = source.until if source.is_cut else None
    if isinstance(piece, Sample):
        if until is None or piece.t <= until:
            run.take(piece)
    else:
        run.take(piece if until is None else piece.up_to(until))


def _pieces(compiled: CompiledSpec, source: Source) -> Iterator[Batch | Sample]:
    if compiled.checked.max_delay is None:
        return source.pieces()
    return source.samples(ordered=False)


def _run_of(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
) -> _Run:
    if compiled.checked.max_delay is None:
        return _OrderedRun(compiled, source, only, streams=streams)
    return _DelayedRun(compiled, source, only, streams=streams)


class _OrderedRun:
    """A run of the core over a recording in order."""

    def __init__(
        self, compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
    ) -> None:
        from rvmon.monitor.core.recording import RecordingRun
        from rvmon.monitor.robustness.recorded import RecordedMargins

        planned = planned_core(compiled, only, measured=True)
        self._run = RecordingRun(compiled.checked, planned, source, finds=False)
        self._run.core.measure(FIGURES, streams)
        self._found = RecordedMargins(planned.packed.ids)
        self._end = source.end

    def take(self, piece: Batch | Sample) -> None:
        if isinstance(piece, Sample):
            self._run.take(piece)
        else:
            for first in range(0, len(piece.times), _ROWS):
                self._run.take(piece.cut(first, min(first + _ROWS, len(piece.times))))
                self._found.add(self._run.core.margins())

    def margins(self) -> Margins:
        self._run.core.finish(self._end)
        self._found.add(self._run.core.margins())
        return self._found.margins()


class _DelayedRun:
    """A monitor that puts samples in order, of which some may come late."""

    def __init__(
        self, compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
    ) -> None:
        self._monitor = RobustnessMonitor(compiled, only, "now", source.names, streams=streams)
        self._found: list[Measured] = []
        self._end = source.end

    def take(self, piece: Batch | Sample) -> None:
        if not isinstance(piece, Sample):
            raise TypeError("samples that may come late are taken one by one")
        self._found += self._monitor.step_ns(piece.t, piece.values)

    def margins(self) -> Margins:
        return margins_from([*self._found, *self._monitor.finish_ns(self._end)])
