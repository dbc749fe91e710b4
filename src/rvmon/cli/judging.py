"""One recording after the other, or side by side: read, judged, kept even where it breaks off."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from rvmon.cli.beside import Beside, Options
from rvmon.cli.output import bar, shown_while_reading
from rvmon.cli.post_analysis import post_analysis
from rvmon.cli.reading import opened
from rvmon.diagnostics.shown import shown_path
from rvmon.errors import TraceError, WorkerLostError
from rvmon.execute.parallel import execute
from rvmon.monitor.inputs.missing import expect_names
from rvmon.readers.places import without_copies
from rvmon.readers.recording import FileRecording, can_be_read_again
from rvmon.readers.source import Source
from rvmon.session import Spec
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from rvmon.coverage.hits import Hits
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Judged:
    """One recording with what is known of it.

    Attributes:
        trace: its path.
        report: the verdicts, or `None` if the recording broke off at an error.
        before: for a broken recording, the attempts decided before the place of the error.
        error: what was wrong with the recording.
        missing: the names that requirements read and that it lacks.
        hits: what it hit of the coverage model, where that was asked for.
        seconds: that it took.
    """

    trace: str
    report: Report | None
    before: tuple[Attempt, ...] = ()
    error: str = ""
    missing: tuple[str, ...] = ()
    hits: Hits = field(default_factory=dict)
    seconds: float = 0.0


def judge_all(
    spec: Spec, traces: Sequence[str], options: Options, jobs: int | str
) -> Iterator[Judged]:
    """Judge recordings, in their order.

    Args:
        spec: reads as the options say.
        traces: paths.
        options: how to judge.
        jobs: processes, 1 judges here; or the address of a scheduler of Dask. If one of several is
            lost, so are the verdicts on what comes behind the last that was judged in order, and
            each of these says so.
    """
    done = 0
    is_alone = len(traces) == 1
    begin = partial(partial, judge, spec, options=options, is_alone=is_alone)
    try:
        with bar("recordings", len(traces)) as show:
            jobs = jobs if isinstance(jobs, str) else min(jobs, len(traces))
            for one in execute(traces, begin, jobs=jobs, what="recording"):
                done += 1
                if not is_alone:  # that one shows how far it is read
                    show(done)
                yield one
    except WorkerLostError as error:
        for trace in traces[done:]:
            yield Judged(
                shown_path(trace), None, error=f"{shown_path(trace)}: not evaluated: {error}"
            )


@without_copies()
def judge(spec: Spec, trace: str, options: Options, *, is_alone: bool = False) -> Judged:
    """Judge one recording; if it is broken, what was decided before the break stays decided.

    Args:
        spec: reads as the options say.
        trace: the path.
        options: how to judge.
        is_alone: whether this process judges nothing else.
    """
    before: list[Attempt] = []
    began = time.monotonic()
    try:
        if trace.endswith((".csv", ".parquet")) and not can_be_read_again(trace):
            raise TraceError("is a pipe: pipes hold JSON lines; keep other recordings in a file")
        recording = opened(spec, trace)
        if options.strict_columns:
            _refuse_mismatch(recording, spec)
        missing = expect_names(
            spec.checked,
            recording,
            spec.schema.named,
            only=options.only,
            allowed=options.allow_missing,
            coverage=True,
        )
        end = recording.end if options.until is None else ticks_of_seconds(options.until)
        beside = Beside(spec, options, trace, recording.names, end)
        source = Source(
            recording,
            end,
            is_cut=True,
            read=iter if beside.is_idle else beside.reading,
            shown=partial(shown_while_reading, recording) if is_alone else iter,
        )
        report = spec.judge(
            source, only=options.only, decided=before.extend, robustness=options.robustness
        )
        report = beside.finished(report)
        if report.end is None:
            raise TraceError(f"no sample up to --until {options.until:g} s: nothing to evaluate")
    except TraceError as error:
        message = str(error)
        place = "" if trace in message else f"{trace}: "
        return Judged(shown_path(trace), None, tuple(before), place + message)
    report = post_analysis(
        spec, recording, report, goals=options.only is None, explains=options.explains
    )
    trace = shown_path(trace)
    health = (*recording.rows.alternations.remarked(report.health), *recording.health())
    report = replace(report, trace=trace, health=health)
    seconds = time.monotonic() - began
    return Judged(trace, report, missing=missing, hits=beside.hits, seconds=seconds)


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
