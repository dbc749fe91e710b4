"""The panels of a run's page, one per shown attempt, and the panel on which the page opens."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import replace

from rvmon.analysis.late_arrival import late_in, waits_of
from rvmon.analysis.subformulas import PartTruth, TriggerParts, part_truths_of
from rvmon.analysis.truths import Question, RecordedTruths, look_through, parts_of
from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.recordings.held_recording import held
from rvmon.report.changes import Changes, Looks, RunChanges, ValuesAt, changes_of
from rvmon.report.html import Child
from rvmon.report.time_axis import View, view_of, whole_run
from rvmon.report.timeline import ReferenceAttempt
from rvmon.report.tracks import Scene, Track, TrackKind, names_of_requirement, tracks_of
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray


class JudgedRun(Struct, frozen=True):
    """A run with its display name, verdicts and samples; `samples` is empty if not kept."""

    name: str
    report: Report
    samples: Sequence[Sample]


class RunPage(Struct, frozen=True):
    """The content of a run's page."""

    run: JudgedRun  # the run
    spec: CheckedSpec  # its specification
    command: str  # the command that replays it
    # other runs of the same specification, searched for nearest passing attempts
    others: Sequence[JudgedRun] = ()
    facts: Sequence[tuple[str, Child]] = ()  # more about the run, as pairs of name and value
    scene: Scene | None = None  # the motion of the robot, if it is known
    back: str = ""  # address of the page that links here; "" if there is none
    back_to: str = "all tests"  # the text of the link back


class Panel(Struct, frozen=True):
    """The part of a page about one attempt, or about a requirement without any."""

    id: str  # the id of its element on the page, and so its address after `#`
    requirement: str  # the id of the requirement
    attempt: Attempt | None  # the attempt; `None` if the requirement has none
    verdict: Verdict  # of the attempt, or of the requirement
    view: View  # the stretch of time that is shown
    tracks: tuple[Track, ...]  # of the signals and events that the requirement reads
    reference: ReferenceAttempt | None  # the nearest passing attempt, for a failed one
    # the truths of its subformulas in the view; empty if the run is too long
    part_truths: tuple[PartTruth, ...] = ()
    # the instant of a response after the deadline, ticks; `None` if there was none
    late: int | None = None
    miss: str = ""  # without an attempt, the near miss of the trigger, in words

    @property
    def instant(self) -> int:
        """The initial instant of the cursor: the decision, else the trigger."""
        if self.attempt is None:
            return self.view.start
        return self.attempt.triggered if self.attempt.decided is None else self.attempt.decided


LOOKS = 60  # the number of evenly spaced instants of the view at which two runs are compared
MOST = 100  # the most passing attempts that are compared


Candidate = tuple[JudgedRun, tuple[Track, ...]]
"""A run that is searched for passing attempts of a requirement, and its tracks."""


def nearest_passing(
    attempt: Attempt, tracks: Sequence[Track], view: View, candidates: Sequence[Candidate]
) -> ReferenceAttempt | None:
    """The passing attempt whose signals differ least from those of a failed one.

    Runs are aligned at the triggers. The distance of two tracks is the share of the view over which
    their values differ; for numbers, the mean difference relative to the largest value; for events,
    the distance of the first occurrences. The distances of all tracks are added.
    """
    import numpy as np

    best: tuple[float, Candidate, Attempt] | None = None
    looks = range(LOOKS)
    instants = np.array([view.start + (view.end - view.start) * k // (LOOKS - 1) for k in looks])
    left = MOST
    for candidate in candidates:
        run, others = candidate
        passing = [*islice(run.report.of(attempt.requirement, Verdict.PASS), left)]
        left -= len(passing)
        if not passing:
            continue
        # Aligned at the triggers, as requirements speak of the time since then.
        shifts = [attempt.triggered - passed.triggered for passed in passing]
        moved = instants - np.array(shifts)[:, np.newaxis]
        distances = np.zeros(len(passing))
        for mine, other in zip(tracks, others, strict=True):
            if mine.kind is TrackKind.EVENT:
                first = _first(mine, view, 0)
                distances += [abs(first - _first(other, view, shift)) for shift in shifts]
            else:
                values = mine.changes.values_at(instants), other.changes.values_at(moved)
                distances += _distances(*values, numbers=mine.kind is TrackKind.NUMBER)
        nearest = int(distances.argmin())
        if best is None or distances[nearest] < best[0]:
            best = (float(distances[nearest]), candidate, passing[nearest])
    return None if best is None else _aligned_reference(best[1], best[2], attempt)


def _aligned_reference(candidate: Candidate, passed: Attempt, failed: Attempt) -> ReferenceAttempt:
    shift, (run, tracks) = failed.triggered - passed.triggered, candidate
    moved = (replace(track, changes=track.changes.shifted(shift)) for track in tracks)
    end = run.report.end
    return ReferenceAttempt(
        name=run.name,
        number=passed.number,
        tracks=tuple(moved),
        end=failed.triggered if end is None else end + shift,
        decided=None if passed.decided is None else passed.decided + shift,
    )


def _distances(mine: ValuesAt, others: ValuesAt, *, numbers: bool) -> NDArray[Any]:
    """The distances of the values of a track from those of others at the same instants."""
    import numpy as np

    (values, known), (other_values, other_known) = mine, others
    both = known & other_known
    differ = values != other_values
    if numbers:
        values, other_values = (
            np.where(known, values, 0.0),
            np.where(other_known, other_values, 0.0),
        )
        largest = np.maximum(abs(values).max(), abs(other_values).max(axis=1, keepdims=True))
        with np.errstate(all="ignore"):  # infinities give NaN, which counts as 1 if they differ
            share = abs(values - other_values) / np.where(largest > 0, largest, 1.0)
        differ = np.where(differ, np.fmin(share, 1.0), 0.0)
    distances: NDArray[Any] = np.where(both, differ, known != other_known).mean(axis=1)
    return distances


def _first(track: Track, view: View, shift: int) -> float:
    """The place of the first occurrence of an event in the view; 1 if it does not occur."""
    index = track.changes.count_until(view.start - shift - 1)
    if index == len(track.changes):
        return 1.0
    return min(view.fraction(track.changes[index][0] + shift), 1.0)


MOST_DISSECTED = 50_000
"""The most samples of a run for which subformulas are drawn; `rvmon why` has no limit."""


def panels_of(content: RunPage) -> list[Panel]:
    """The panels: one for each attempt shown, and for each requirement without an attempt."""
    shown = shown_attempts(content.run.report)
    panels = _Panels(content, shown)
    return [panel for name, attempts in shown.items() for panel in panels.of(name, attempts)]


class _Panels:
    """Builds the panels of a page; one pass over the run evaluates the formulas of all panels."""

    def __init__(self, content: RunPage, shown: Mapping[str, Sequence[Attempt]]) -> None:
        self._content, self._shown = content, shown
        report = content.run.report
        samples = held(content.run.samples)
        # Kept, because each access to a sample of a long run reads a block.
        self._start = samples[0].t if samples else report.origin
        self._changes: dict[int, Mapping[str, Changes]] = {}
        self._waits = {
            name: waits_of(content.spec.requirements[name], attempts)
            for name, attempts in shown.items()
            if name not in report.late
        }
        self._is_dissected = not samples.is_longer_than(MOST_DISSECTED)
        self._truths: RecordedTruths | None = None
        if samples and report.end is not None:
            questions = list(self._questions(shown))
            declared, absent = {*content.spec.signals, *content.spec.events}, report.absent
            names = frozenset(declared - absent)  # the names with a source in the run
            # Both in one pass, because each pass reads a long run from its file again.
            noted = RunChanges(content.spec, self._looks(content.run))
            self._changes[id(content.run)] = noted.by_name
            self._truths = look_through(
                content.spec, questions, noted.passing(samples), report.end, names,
                outages=samples.outages,
            )  # fmt: skip
        # The shown attempts of each requirement, with their late responses and views.
        self._views = {name: self._with_views(name, attempts) for name, attempts in shown.items()}

    def _with_views(
        self, name: str, attempts: Sequence[Attempt]
    ) -> Sequence[tuple[Attempt, int | None, View]]:
        report, late = self._content.run.report, self._late(name, attempts)
        # Attempts in doubt are numbered separately, so their numbers are not keys of `late`.
        came = [None if one.in_doubt else late.get(one.number) for one in attempts]
        views = [view_of(one, report, late_at) for one, late_at in zip(attempts, came, strict=True)]
        return [*zip(attempts, came, views, strict=True)]

    def _questions(self, shown: Mapping[str, Sequence[Attempt]]) -> Iterator[Question]:
        for name, attempts in shown.items():
            requirement = self._content.spec.requirements[name]
            yield from self._waits.get(name, {}).values()
            if not attempts and name not in self._content.run.report.misses:
                yield TriggerParts(self._content.spec, requirement).question
            if self._is_dissected:
                yield from (parts_of(requirement, attempt) for attempt in attempts)

    def of(self, name: str, attempts: Sequence[Attempt]) -> Iterator[Panel]:
        """The panels of a requirement."""
        run = self._content.run
        report, samples = run.report, run.samples
        tracks = self._tracks(run, name)
        if not attempts:
            view = whole_run(report, self._start)
            verdict, miss = report.verdicts[name], self._miss(name)
            yield Panel(panel_id(name, None), name, None, verdict, view, tracks, None, miss=miss)
        candidates: list[Candidate] = []
        if samples and any(attempt.verdict is Verdict.FAIL for attempt in attempts):
            others = (other for other in self._content.others if other.samples)
            # The run itself first: its attempts were made under the same conditions.
            candidates = [(run, tracks), *((other, self._tracks(other, name)) for other in others)]
        for attempt, came, view in self._views[name]:
            reference = None
            if attempt.verdict is Verdict.FAIL:
                reference = nearest_passing(attempt, tracks, view, candidates)
            yield Panel(
                panel_id(name, attempt),
                name,
                attempt,
                attempt.verdict,
                view,
                tracks,
                reference,
                self._part_truths(attempt, view),
                came,
            )

    def _tracks(self, run: JudgedRun, name: str) -> tuple[Track, ...]:
        if not run.samples:
            return ()
        spec = self._content.spec
        # Keyed by identity, as runs are not hashable; `_content` keeps every run alive.
        if id(run) not in self._changes:
            self._changes[id(run)] = changes_of(spec, run.samples, self._looks(run))
        return tracks_of(spec, spec.requirements[name], self._changes[id(run)], run.report.absent)

    def _looks(self, run: JudgedRun) -> Looks:
        """The parts of a run that are drawn or compared with a failed attempt, at least."""
        requirements, stretches = self._content.spec.requirements, list[tuple[int, int]]()
        everywhere = set[str]()
        for name, attempts in self._shown.items():
            if not attempts:
                everywhere.update(names_of_requirement(requirements[name]))
            for attempt in attempts:
                view, shifts = view_of(attempt, self._content.run.report), [0]
                start, end = view.start, view.end
                if attempt.verdict is Verdict.FAIL:
                    # A late response in view makes the view at most twice as long.
                    start, end = start - (end - start), end + (end - start)
                    passing = islice(run.report.of(name, Verdict.PASS), MOST)
                    shifts += [attempt.triggered - passed.triggered for passed in passing]
                stretches += [(start - shift, end - shift) for shift in shifts]
        return Looks(stretches, everywhere)

    def _part_truths(self, attempt: Attempt, view: View) -> tuple[PartTruth, ...]:
        """The truth of each subformula over the part of a view within the run."""
        if self._truths is None or not self._is_dissected:
            return ()
        start, stop = max(view.start, self._start), min(view.end, self._truths.end)
        if start > stop:
            return ()
        requirement = self._content.spec.requirements[attempt.requirement]
        return part_truths_of(requirement, attempt, self._truths, start, stop)

    def _miss(self, name: str) -> str:
        """The near miss of a trigger, from the report or computed now."""
        miss = self._content.run.report.misses.get(name)
        if miss is not None or self._truths is None:
            return miss or ""
        spec = self._content.spec
        return TriggerParts(spec, spec.requirements[name]).miss_in(self._truths)

    def _late(self, name: str, attempts: Sequence[Attempt]) -> Mapping[int, int]:
        """Late responses by number of the attempt, from the report or computed now."""
        if name not in self._waits or self._truths is None:
            return self._content.run.report.late.get(name, {})
        return late_in(attempts, self._waits[name], self._truths)


def panel_id(requirement: str, attempt: Attempt | None) -> str:
    """The id of the panel of an attempt, or of a requirement without any."""
    if attempt is None:
        return requirement
    return f"{requirement}-{'in-doubt-' if attempt.in_doubt else ''}{attempt.number}"


SHOWN = {Verdict.FAIL: 4, Verdict.INCONCLUSIVE: 2, Verdict.PASS: 2}
"""The most attempts shown per requirement and verdict, worst first; the rest is only counted."""

MOST_SHOWN = 400
"""The most attempts on a page, unless there are more requirements; each takes some 20 kB."""


def shown_attempts(report: Report) -> dict[str, list[Attempt]]:
    """By requirement, the attempts that are shown, by number."""
    most_of_one = max(1, MOST_SHOWN // max(1, len(report.verdicts)))
    shown = {}
    for name in report.verdicts:
        first_of_each = (
            attempt
            for verdict, most in SHOWN.items()
            for attempt in islice(report.of(name, verdict), most)
        )
        first = islice(first_of_each, most_of_one)
        shown[name] = sorted(first, key=lambda attempt: attempt.number)
    return shown


def opening(report: Report) -> tuple[str, Attempt | None]:
    """The requirement and attempt on which a page opens: the first F, else I, else any."""
    if not report.verdicts:
        raise RvmonError("a page shows requirements, and the specification has none: add one")
    for verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS):
        for attempt in report.attempts:
            if attempt.verdict is verdict:
                return attempt.requirement, attempt
    return next(iter(report.verdicts)), None
