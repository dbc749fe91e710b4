"""One recording after the other, or side by side: read, judged, kept even where it breaks off."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from rvmon.cli.post_analysis import post_analysis
from rvmon.cli.progress import bar, shown_while_reading
from rvmon.cli.reading import opened
from rvmon.errors import TraceError, WorkerLostError
from rvmon.execute.parallel import execute
from rvmon.monitor.inputs.missing import expect_names
from rvmon.readers.recording import FileRecording, can_be_read_again
from rvmon.readers.source import Source
from rvmon.session import Spec
from rvmon.trace.sample import Sample
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from rvmon.monitor.robustness.values import Measured
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Options:
    """How to judge.

    Attributes:
        only: ids of the requirements, or `None` for all.
        engine: `auto` or the name of one.
        until: the instant in seconds to which recordings are judged; default their last sample.
        strict_columns: whether missing and undeclared columns are errors.
        robustness: whether to find the robustness of each attempt as well.
        allow_missing: the names that recordings in columns may lack; `True`: all.
    """

    only: tuple[str, ...] | None = None
    engine: str = "auto"
    until: float | None = None
    strict_columns: bool = False
    robustness: bool = False
    allow_missing: bool | tuple[str, ...] = False


@dataclass(frozen=True, slots=True)
class Judged:
    """One recording with what is known of it.

    Attributes:
        trace: its path.
        report: the verdicts, or `None` if the recording broke off at an error.
        before: for a broken recording, the attempts decided before the place of the error.
        error: what was wrong with the recording.
        missing: the names that requirements read and that it lacks.
    """

    trace: str
    report: Report | None
    before: tuple[Attempt, ...] = ()
    error: str = ""
    missing: tuple[str, ...] = ()


def judge_all(spec: Spec, traces: Sequence[str], options: Options, jobs: int) -> Iterator[Judged]:
    """Judge recordings, in their order.

    Args:
        spec: reads as the options say.
        traces: paths.
        options: how to judge.
        jobs: processes; 1 judges here. If one of several is lost, so are the verdicts on what
            comes behind the last that was judged in order, and each of these says so.
    """
    done = 0
    is_alone = len(traces) == 1
    begin = partial(partial, judge, spec, options=options, is_alone=is_alone)
    try:
        with bar("recordings", len(traces)) as tell:
            for one in execute(traces, begin, jobs=min(jobs, len(traces)), what="recording"):
                done += 1
                if not is_alone:  # that one shows how far it is read
                    tell(done)
                yield one
    except WorkerLostError as error:
        for trace in traces[done:]:
            yield Judged(_shown(trace), None, error=f"{_shown(trace)}: not judged: {error}")


def judge(spec: Spec, trace: str, options: Options, *, is_alone: bool = False) -> Judged:
    """Judge one recording; if it is broken, what was decided before the break stays decided.

    Args:
        spec: reads as the options say.
        trace: the path.
        options: how to judge.
        is_alone: whether this process judges nothing else.
    """
    before: list[Attempt] = []
    try:
        if trace.endswith((".csv", ".parquet")) and not can_be_read_again(trace):
            raise TraceError("is a pipe: pipes hold JSON lines; keep other recordings in a file")
        recording = opened(spec, trace)
        if options.strict_columns:
            _refuse_mismatch(recording, spec)
        missing = expect_names(
            spec.checked,
            recording,
            spec.schema.columns,
            only=options.only,
            allowed=options.allow_missing,
        )
        end = None if options.until is None else ticks_of_seconds(options.until)
        meter = _Meter(spec, options.only, recording.names, end) if options.robustness else None
        source = Source(
            recording,
            end,
            is_cut=True,
            row_by_row="" if meter is None else "robustness is found sample by sample",
            read=meter.reading if meter else shown_while_reading if is_alone else iter,
            is_alone=is_alone,
        )
        try:
            report = spec.judge(
                source, engine=options.engine, only=options.only, decided=before.extend
            )
        except TraceError:
            before = before or _judged_before(spec, trace, options)
            raise
        if meter is not None:
            report = meter.measured(report)
        if report.end is None:
            raise TraceError(f"no sample up to --until {options.until:g} s: nothing to judge")
    except TraceError as error:
        message = str(error)
        place = "" if trace in message else f"{trace}: "
        return Judged(_shown(trace), None, tuple(before), place + message)
    report = post_analysis(spec, trace, report, recording.names, goals=options.only is None)
    trace = _shown(trace)
    health = (*recording.rows.alternations.remarked(report.health), *recording.health())
    return Judged(trace, replace(report, trace=trace, health=health), missing=missing)


def _judged_before(spec: Spec, trace: str, options: Options) -> list[Attempt]:
    """What is decided up to the place where a recording breaks off that can be read again."""
    found: list[Attempt] = []
    if not can_be_read_again(trace):
        return found
    with suppress(TraceError):
        recording = opened(spec, trace)
        monitor = spec.monitor(only=options.only, sources=recording.names)
        for sample in recording:
            found.extend(monitor.step_ns(sample.t, sample.values))
    return found


class _Meter:
    """Finds the robustness of attempts while their samples go by."""

    def __init__(
        self,
        spec: Spec,
        only: tuple[str, ...] | None,
        names: frozenset[str] | None,
        end: int | None,
    ) -> None:
        self._end = end
        self._monitor = spec.robustness_monitor(only=only, sources=names)
        self._found: list[Measured] = []

    def reading(self, recording: FileRecording) -> Iterator[Sample]:
        """The samples, each measured once it was judged."""
        for sample in shown_while_reading(recording):
            yield sample
            if self._end is None or sample.t <= self._end:
                self._found.extend(self._monitor.step_ns(sample.t, sample.values))

    def measured(self, report: Report) -> Report:
        """The report with a figure for each attempt."""
        self._found.extend(self._monitor.finish_ns(self._end))
        from rvmon.monitor.robustness.values import margins_from

        margins = margins_from(self._found)
        return replace(report, attempts=tuple(margins.of(attempt) for attempt in report.attempts))


def _shown(trace: str) -> str:
    """The name of a recording as text; file names need not be."""
    return os.fsencode(trace).decode("utf-8", "replace")


def _refuse_mismatch(recording: FileRecording, spec: Spec) -> None:
    ignored = list(recording.ignored)
    declared = {*spec.schema.signals, *spec.schema.events}
    missing = sorted(declared - (recording.names or declared))
    faults = [
        f"{what}: {', '.join(names)}"
        for what, names in (("columns not declared", ignored), ("columns missing", missing))
        if names
    ]
    if faults:
        raise TraceError("; ".join(faults))
