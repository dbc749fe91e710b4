"""One recording after the other, or side by side: read, judged, kept even where it breaks off."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field, structs

from rvmon.cli.options import asked_ids, constants_of
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
    # the instant in seconds to which recordings are judged; default their last sample
    until: float | None = None
    robustness: bool = False  # whether to find the robustness of each attempt as well
    # the names that recordings in columns may lack; `True`: all
    allow_missing: bool | tuple[str, ...] = False
    # whether the whole coverage model is watched; default: coverpoints and crosses alone
    coverage: bool = False
    explains: bool = True  # whether anybody is told why there is no attempt, and what came late


def spec_and_options(
    arguments: argparse.Namespace, name: str | None = None
) -> tuple[Spec, Options]:
    """The specification that judges, and the options of judging."""
    loaded = load(arguments.spec, name=name, const=constants_of(arguments.const))
    spec = reading_spec(loaded, arguments)
    return spec, Options(
        asked_ids(arguments, spec),
        arguments.until,
        arguments.robustness,
        allowed_names(arguments.allow_missing),
        arguments.coverage is not None,
        not _shows_counts_alone(arguments),
    )


def _shows_counts_alone(arguments: argparse.Namespace) -> bool:
    """Whether all that is shown of reports is how many verdicts there are."""
    asked = vars(arguments)  # evidence that is evaluated again has none of these
    is_kept = any(asked.get(name) for name in ("out", "report", "junit", "mcap", "evidence"))
    return bool(asked.get("quiet") and asked.get("format") == "text" and not is_kept)


class RecordingCoverage:
    """Finds coverage on one recording, beside judging it."""

    def __init__(
        self, spec: Spec, options: Options, recording: FileRecording, end: int | None
    ) -> None:
        self.hits: Hits = {}  # what was hit of the coverage model, if all of it was asked for
        self._spec = spec
        self._options = options
        self._end = TIME_LIMIT if end is None else end
        self._run: CoverageRun | None = None
        self._fault: TraceError | None = None
        if options.coverage or spec.checked.coverpoints:
            source = Source(recording, end, is_cut=True)
            self._run = spec.coverage_model.run(source, requirements=options.coverage)

    def passing(self, found: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """The pieces, unchanged; an error of their coverage is raised by `finished`."""
        for piece in found:
            if self._run is not None and self._fault is None:
                try:
                    for own in pieces_up_to([piece], self._end):
                        self._run.take(own)
                except TraceError as error:
                    self._fault = error
            yield piece

    def finished(self) -> dict[str, Any]:
        """What was found, for the report, when all of the recording went by."""
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
    """One recording with what is known of it."""

    trace: str  # its path
    report: Report | None  # the verdicts, or `None` if the recording broke off at an error
    # for a broken recording, the attempts decided before the place of the error
    before: tuple[Attempt, ...] = ()
    error: str = ""  # the fault of the recording
    missing: tuple[str, ...] = ()  # the names that requirements read and that it lacks
    hits: Hits = field(default_factory=dict)  # in the coverage model, where that was asked for
    seconds: float = 0.0  # its duration
    text: str = ""  # the report as JSON, if the process that judged was asked for it


def judge_all(
    spec: Spec,
    traces: Sequence[str],
    options: Options,
    jobs: int | str,
    *,
    writes_json: bool = False,
) -> Iterator[Judged]:
    """Judge recordings, in their order.

    If one of several processes is lost, or a scheduler of Dask that `jobs` names, so are the
    verdicts on what comes behind the last that was judged in order, and each of these says so. With
    `writes_json` processes write the reports as JSON, too: this one alone would take a tenth of the
    time for all of them, while the others rest.
    """
    done = 0
    is_alone = len(traces) == 1
    is_apart = jobs != 1 and not is_alone
    begin = partial(partial, judge, spec, options=options, is_alone=is_alone)
    planned: PlannedCore | None = None
    if is_apart:
        begin = partial(partial, _judge_apart, spec, options=options, writes_json=writes_json)
        planned = spec.planned(options.only)  # for all that go on from here
    try:
        with bar("recordings", len(traces)) as show:
            jobs = jobs if isinstance(jobs, str) else min(jobs, len(traces))
            for one in execute(traces, begin, jobs=jobs, what="recording"):
                done += 1
                if not is_alone:  # that one shows how far it is read
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
    """The same for another process, which has the plan."""
    found = judge(spec, trace, options)
    if found.report is None:
        return found
    text = found.report.to_json(spec.requirements) if writes_json else ""
    return structs.replace(found, report=give_plan(found.report, None), text=text)


@without_copies()
def judge(spec: Spec, trace: str, options: Options, *, is_alone: bool = False) -> Judged:
    """Judge one recording; if it is broken, what was decided before the break stays decided."""
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
        coverage = RecordingCoverage(spec, options, recording, end)
        show = partial(shown_while_reading, recording) if is_alone else iter
        remembered = Remembered(spec, recording, options.only)
        is_noted = options.explains and recording.can_be_read_again
        source = Source(
            recording,
            end,
            is_cut=options.until is not None,  # what a recording says of its end may be wrong
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
    """The judged reproducer, with the name by which people know its recording."""
    name = name_of(case.recording)  # it is unpacked only for a moment
    report = None if judged.report is None else replace(judged.report, trace=name)
    return structs.replace(
        judged, trace=name, report=report, error=judged.error.replace(case.recording, name)
    )


def compare_expected(judged: Judged, case: Case) -> None:
    """Say whether the attempt has the verdict that it had."""
    attempts = [] if judged.report is None else judged.report.attempts
    found = next((attempt for attempt in attempts if attempt.name == case.attempt), None)
    if found is None or (found.verdict, found.decided) != (case.verdict, case.decided):
        now = "there is none now" if found is None else f"it is {found.verdict} now"
        made = f"as rvmon {case.rvmon} (law {case.law}) decided"
        warn(f"warning: {case.attempt} was {case.verdict}, {made}: {now}")
    else:
        warn(f"{case.attempt} is {case.verdict}, as when this was recorded")
