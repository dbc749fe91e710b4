"""The robustness of whole recordings: by arrays where their columns allow it, else by a monitor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Protocol

from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled.refusal import of_measured_c
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
from rvmon.readers.blocks import NotPlainError
from rvmon.readers.reading import Reading
from rvmon.readers.source import Columns, Source
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report


class Judge(Protocol):
    """Judges a recording."""

    def __call__(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """See `rvmon.monitor.engines.registry.Engine`."""


def robustness_monitor(
    compiled: CompiledSpec,
    only: Sequence[str] | None,
    settle: str,
    sources: frozenset[str] | None,
    engine: str,
    *,
    streams: bool = False,
) -> RobustnessMonitor:
    """A monitor of an engine that measures; see `RobustnessMonitor`.

    Args:
        compiled: the specification.
        only: ids of the requirements; `None`: all.
        settle: see there.
        sources: see there.
        engine: `auto`, or `c`: compiled C.
        streams: see there.

    Raises:
        UnknownNameError: no such engine measures, or there is no such way to settle.
        RvmonError: compiled C does not measure a requirement, or there is no compiler.
    """
    if not _is_c(engine):
        return RobustnessMonitor(compiled, only, settle, sources, streams=streams)
    from rvmon.monitor.measure_in_c import CompiledRobustnessMonitor

    return CompiledRobustnessMonitor(compiled, only, settle, sources, streams=streams)


def _is_c(engine: str) -> bool:
    if engine not in ("auto", "c"):
        raise UnknownNameError(f"no engine `{engine}` measures: there are auto, c")
    return engine == "c"


def margins_of(
    compiled: CompiledSpec,
    trace: Any,
    reading: Reading,
    *,
    only: Sequence[str] | None = None,
    until: int | None = None,
    streams: bool = True,
    engine: str = "auto",
) -> Margins:
    """The robustness of all attempts on a trace.

    Args:
        compiled: the specification.
        trace: as `Spec.evaluate` takes it; so are the errors.
        reading: how it is read.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.
        streams: whether to measure each position, too.
        engine: see `robustness_monitor`; so are the further errors.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    named = "" if reading.sources is None else "its sources are named"
    source = Source(recording, until, row_by_row=named)
    asked = Asked(None if only is None else tuple(only))
    margins = None
    if _is_c(engine):
        margins = _in_c(compiled, source, asked, streams=streams)
    if margins is None and not _is_c(engine):
        judge = engine_named("auto").judge
        found = _by_columns(compiled, source, asked, judge, streams=streams)
        margins = found and found[1]
    return margins or _by_samples(compiled, source, asked, engine, streams=streams)


def measuring(judge: Judge, engine: str) -> Judge:
    """What judges a recording as `judge` does, and gives each attempt its robustness.

    Args:
        judge: of the engine.
        engine: its name: compiled C measures what it judges, if it can.
    """

    def measured(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        chosen = compiled.chosen(asked.only)
        in_c = engine == "c" and chosen and not any(map(of_measured_c, chosen))
        margins = _in_c(compiled, source, asked, streams=False) if in_c else None
        if margins is not None:
            report = judge(compiled, source, asked)
        elif in_c:
            report, margins = _beside(compiled, source, asked, judge, "c")
        else:
            found = _by_columns(compiled, source, asked, judge, streams=False)
            report, margins = found or _beside(compiled, source, asked, judge, "auto")
        return replace(report, attempts=tuple(map(margins.of, report.attempts)))

    return measured


def _beside(
    compiled: CompiledSpec, source: Source, asked: Asked, judge: Judge, engine: str
) -> tuple[Report, Margins]:
    """A report, and the figures by a monitor that sees each sample once it was judged."""
    monitor = robustness_monitor(compiled, asked.only, "now", source.names, engine)
    found: list[Measured] = []

    def read(recording: Any) -> Iterable[Sample]:
        for sample in source.read(recording):
            yield sample
            if source.until is None or sample.t <= source.until:
                found.extend(monitor.step_ns(sample.t, sample.values))

    reason = source.row_by_row or "robustness is found sample by sample"
    report = judge(compiled, replace(source, row_by_row=reason, read=read), asked)
    return report, margins_from([*found, *monitor.finish_ns(source.end)])


def _by_samples(
    compiled: CompiledSpec, source: Source, asked: Asked, engine: str, *, streams: bool
) -> Margins:
    """The figures by a monitor."""
    names = source.names
    monitor = robustness_monitor(compiled, asked.only, "now", names, engine, streams=streams)
    found = [one for sample in source.recording for one in monitor.step_ns(sample.t, sample.values)]
    return margins_from([*found, *monitor.finish_ns(source.end)])


def _in_c(compiled: CompiledSpec, source: Source, asked: Asked, *, streams: bool) -> Margins | None:
    """The figures by compiled C; `None` if the recording has no columns."""
    from rvmon.monitor.measure_in_c import margins_of_columns

    chosen = compiled.chosen(asked.only)
    try:
        columns = columns_of(compiled, source, asked)
        return margins_of_columns(compiled, chosen, columns, source.end, streams=streams)
    except NotPlainError:
        return None


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
