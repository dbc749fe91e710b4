"""Evaluation of recordings, in sequence or in parallel, with coverage and post-analysis."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field, structs

from rvmon.cli.options import chosen_ids, constants_of
from rvmon.cli.output import bar, shown_while_reading, warn
from rvmon.cli.post_analysis import Remembered, post_analysis
from rvmon.cli.reading import allowed_names, opened, reading_spec
from rvmon.errors import TraceError, WorkerLostError
from rvmon.execute.parallel import execute
from rvmon.monitor.missing_names import expect_names
from rvmon.monitor.records import give_plan
from rvmon.recordings.places import JOINT, name_of, without_copies
from rvmon.recordings.recording import FileRecording
from rvmon.recordings.source import Source, pieces_up_to
from rvmon.session import Spec, load
from rvmon.texts import shown_path
from rvmon.trace.sample import Sample
from rvmon.trace.time import TIME_LIMIT, ticks_of_seconds

if TYPE_CHECKING:
    import argparse

    from rvmon.coverage import Hits
    from rvmon.coverage.monitor import CoverageRun
    from rvmon.monitor.packed_plan import PlannedCore
    from rvmon.recordings.batch import Batch
    from rvmon.reproducer import Case
    from rvmon.verdicts.attempt import Attempt
    from rvmon.verdicts.report import Report


class Options(Struct, frozen=True):
    """The options of judging."""

    only: tuple[str, ...] | None = None  # ids of the requirements, or `None` for all
    # the instant in seconds up to which recordings are judged; default their last sample
    until: float | None = None
    robustness: bool = False  # whether to compute the robustness of each attempt
    # the names that recordings in columns may lack; `True`: all
    allow_missing: bool | tuple[str, ...] = False
    # whether to measure the whole coverage model; default: only coverpoints and crosses
    coverage: bool = False
    explains: bool = True  # whether to find near misses, late responses and values at failures


def spec_and_options(
    arguments: argparse.Namespace, name: str | None = None
) -> tuple[Spec, Options]:
    """The specification and the options of judging, from the command line."""
    loaded = load(arguments.spec, name=name, const=constants_of(arguments.const))
    spec = reading_spec(loaded, arguments)
    return spec, Options(
        chosen_ids(arguments, spec),
        arguments.until,
        arguments.robustness,
        allowed_names(arguments.allow_missing),
        arguments.coverage is not None,
        not _shows_counts_alone(arguments),
    )


def _shows_counts_alone(arguments: argparse.Namespace) -> bool:
    """Whether the output contains only numbers of verdicts, no explanations."""
    given = vars(arguments)  # with `get`, as the arguments kept in evidence lack these options
    is_kept = any(given.get(name) for name in ("out", "report", "junit", "mcap", "evidence"))
    return bool(given.get("quiet") and given.get("format") == "text" and not is_kept)


class RecordingCoverage:
    """Measures the coverage of one recording while it is judged."""

    def __init__(
        self, spec: Spec, options: Options, recording: FileRecording, end: int | None
    ) -> None:
        self.hits: Hits = {}  # the hits of the whole coverage model, with `options.coverage`
        self._spec = spec
        self._options = options
        self._end = TIME_LIMIT if end is None else end
        self._run: CoverageRun | None = None
        self._fault: TraceError | None = None
        if options.coverage or spec.checked.coverpoints:
            source = Source(recording, end, is_cut=True)
            self._run = spec.coverage_model.run(source, requirements=options.coverage)

    def passing(self, found: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """Pass the pieces through unchanged; `finished` raises any error of their coverage."""
        for piece in found:
            if self._run is not None and self._fault is None:
                try:
                    for own in pieces_up_to([piece], self._end):
                        self._run.take(own)
                except TraceError as error:
                    self._fault = error
            yield piece

    def finished(self) -> dict[str, Any]:
        """The fields for the report, after the whole recording has passed.

        Raises:
            TraceError: the coverage could not be measured.
        """
        if self._run is None:
            return {}
        from rvmon.coverage import covered_groups, illegal

        if self._fault is not None:
            raise self._fault
        found = self._run.finish()
        if self._options.coverage:
            self.hits = found
        model = self._spec.coverage_model.bin_model
        wrong = tuple(illegal(found, model))
        return {"illegal": wrong, "coverage": covered_groups(found, model)}


class Judged(Struct, frozen=True):
    """One evaluated recording."""

    trace: str  # its path
    report: Report | None  # the verdicts, or `None` if the recording broke off with an error
    before: tuple[Attempt, ...] = ()  # the attempts decided before the error
    error: str = ""  # the error of the recording
    missing: tuple[str, ...] = ()  # the names that requirements read and that it lacks
    hits: Hits = field(default_factory=dict)  # in the coverage model, with `--coverage`
    seconds: float = 0.0  # the time that evaluation took
    text: str = ""  # the report as JSON, if the worker process wrote it


def judge_all(
    spec: Spec,
    traces: Sequence[str],
    options: Options,
    jobs: int | str,
    *,
    writes_json: bool = False,
) -> Iterator[Judged]:
    """Judge recordings; results come in the order of `traces`.

    Args:
        spec: the specification.
        traces: paths of the recordings.
        options: how to judge.
        jobs: the number of processes, or the address of a Dask scheduler. If a process is lost, all
            recordings after the last one yielded have an error instead of a report.
        writes_json: whether worker processes also write the reports as JSON. If this process wrote
            all of them, that would take a tenth of the whole time, in which the others were idle.
    """
    done = 0
    is_alone = len(traces) == 1
    is_apart = jobs != 1 and not is_alone
    prepare = partial(partial, judge, spec, options=options, is_alone=is_alone)
    planned: PlannedCore | None = None
    if is_apart:
        prepare = partial(partial, _judge_apart, spec, options=options, writes_json=writes_json)
        planned = spec.planned(options.only)  # reports come without the plan, and get it here
    try:
        with bar("recordings", len(traces)) as show:
            jobs = jobs if isinstance(jobs, str) else min(jobs, len(traces))
            for one in execute(traces, prepare, jobs=jobs, what="recording"):
                done += 1
                if not is_alone:  # a single recording shows the share that is read
                    show(done)
                if planned is not None and one.report is not None:
                    give_plan(one.report, planned)
                yield one
    except WorkerLostError as error:
        for trace in traces[done:]:
            yield Judged(
                shown_path(trace), None, error=f"{shown_path(trace)}: not evaluated: {error}"
            )


def _judge_apart(spec: Spec, trace: str, options: Options, *, writes_json: bool) -> Judged:
    """`judge` in a worker process; returns the report without the plan, which the parent has."""
    found = judge(spec, trace, options)
    if found.report is None:
        return found
    text = found.report.to_json(spec.requirements) if writes_json else ""
    return structs.replace(found, report=give_plan(found.report, None), text=text)


@without_copies()
def judge(spec: Spec, trace: str, options: Options, *, is_alone: bool = False) -> Judged:
    """Judge one recording; if it breaks off, the result has the attempts decided before."""
    before: list[Attempt] = []
    began = time.monotonic()
    try:
        recording = opened(spec, trace)
        missing = expect_names(
            spec.checked,
            recording,
            spec.schema.named,
            only=options.only,
            allowed=options.allow_missing,
            coverage=True,
        )
        end = recording.end if options.until is None else ticks_of_seconds(options.until)
        if options.until is not None:
            recording.end_findings(ticks_of_seconds(options.until))
        coverage = RecordingCoverage(spec, options, recording, end)
        show = partial(shown_while_reading, recording) if is_alone else iter
        remembered = Remembered(spec, recording, options.only)
        is_noted = options.explains and recording.can_be_read_again
        source = Source(
            recording,
            end,
            # The end that a recording states may be wrong, so only `--until` cuts it.
            is_cut=options.until is not None,
            shown=lambda found: coverage.passing(show(found)),
            taken=remembered.take if is_noted else None,
        )
        report = spec.judge(
            source, only=options.only, decided=before.extend, robustness=options.robustness
        )
        covered = coverage.finished()
        if report.end is None:
            raise TraceError(f"no sample up to --until {options.until:g} s: nothing to evaluate")
    except TraceError as error:
        message = str(error)
        is_named = any(one in message for one in filter(None, trace.split(JOINT)))
        place = "" if is_named else f"{trace}: "
        return Judged(shown_path(trace), None, tuple(before), place + message)
    found = post_analysis(
        spec, recording, remembered, report, goals=options.only is None, explains=options.explains
    )
    trace = shown_path(trace)
    health = (*recording.rows.alternations.remarked(report.health), *recording.health())
    report = replace(report, trace=trace, health=health, **covered, **found)
    seconds = time.monotonic() - began
    return Judged(trace, report, missing=missing, hits=coverage.hits, seconds=seconds)


def as_known(judged: Judged, case: Case) -> Judged:
    """The judged reproducer, with the recording's own name instead of its temporary path."""
    name = name_of(case.recording)
    report = None if judged.report is None else replace(judged.report, trace=name)
    return structs.replace(
        judged, trace=name, report=report, error=judged.error.replace(case.recording, name)
    )


def compare_expected(judged: Judged, case: Case) -> None:
    """Print whether the attempt of a reproducer has the recorded verdict."""
    attempts = [] if judged.report is None else judged.report.attempts
    found = next((attempt for attempt in attempts if attempt.name == case.attempt), None)
    if found is None or (found.verdict, found.decided) != (case.verdict, case.decided):
        now = "now there is no such attempt" if found is None else f"it is {found.verdict} now"
        made = f"as rvmon {case.rvmon} (law {case.law}) decided"
        warn(f"warning: {case.attempt} was {case.verdict}, {made}: {now}")
    else:
        warn(f"{case.attempt} is {case.verdict}, as when this was recorded")
