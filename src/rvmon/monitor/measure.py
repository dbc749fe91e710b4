"""The robustness of whole recordings: by arrays where their columns allow it, else by a monitor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.monitor.engines.rows import columns_of
from rvmon.monitor.evaluate import open_trace
from rvmon.monitor.robustness.monitor import RobustnessMonitor
from rvmon.monitor.robustness.values import Key, Margins, Robustness, Stream, margins_from
from rvmon.readers.blocks import NotPlainError
from rvmon.readers.reading import Reading
from rvmon.readers.source import Columns, Source
from rvmon.verdict.attempt import Attempt


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
    return _by_samples(compiled, source, only, streams=streams) if found is None else found


def _by_samples(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
) -> Margins:
    """The same by a monitor."""
    monitor = RobustnessMonitor(compiled, only=only, sources=source.names, streams=streams)
    found = [one for sample in source.recording for one in monitor.step_ns(sample.t, sample.values)]
    return margins_from([*found, *monitor.finish_ns(source.end)])


def _by_columns(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
) -> Margins | None:
    """The same by arrays; `None` if something of it has to be measured sample by sample."""
    if source.is_short:
        return None
    asked = Asked(None if only is None else tuple(only))
    try:
        columns = columns_of(compiled, source, asked)
    except NotPlainError:
        return None
    from rvmon.monitor.columns.leaves import NotByColumnsError

    try:
        return _measured(compiled, source, columns, asked, streams=streams)
    except (NotPlainError, NotByColumnsError):
        return None


def _measured(
    compiled: CompiledSpec, source: Source, columns: Columns, asked: Asked, *, streams: bool
) -> Margins:
    """The figures by arrays, of attempts as `Spec.evaluate` finds them.

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
    report = engine_named("auto").judge(compiled, source, asked)
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
    return Margins(attempts, {}, found)


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
