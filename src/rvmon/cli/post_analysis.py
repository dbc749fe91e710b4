"""Analysis of a recording after its verdicts are known: near misses, late responses, values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import TYPE_CHECKING, Any

from rvmon.cli.reading import opened
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_window
from rvmon.recordings.last_updates import last_of
from rvmon.recordings.source import Source, pieces_up_to
from rvmon.report.wording import SHOWN_PER_REQUIREMENT, value_text
from rvmon.session import Spec
from rvmon.trace.sample import Sample, Scalar, Trace
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from rvmon import native
    from rvmon.analysis.truths import Question, RecordedTruths
    from rvmon.analysis.window_values import WindowRequest
    from rvmon.cli.failure_notes import FailureNotes
    from rvmon.recordings.batch import Batch
    from rvmon.recordings.recording import FileRecording
    from rvmon.verdicts.attempt import Attempt
    from rvmon.verdicts.report import Report

MOST_HELD = 65_536
"""The most rows kept in memory; for longer recordings, failures are noted while judging."""

_AT_ONCE = 16_384  # rows of a longer recording that are noted together


class Remembered:
    """The judged pieces of a short recording; for a long one, notes on its failures."""

    def __init__(self, spec: Spec, recording: FileRecording, only: Sequence[str] | None) -> None:
        self._judged = spec, recording, only
        self._pieces: list[Batch | Sample] = []
        self._rows = 0
        self._notes: FailureNotes | None = None

    def take(self, piece: Batch | Sample, core: native.Monitor) -> None:
        """Take a piece that `core` has judged; its run continues."""
        rows = 1 if isinstance(piece, Sample) else len(piece.times)
        if not rows:
            return
        self._pieces.append(piece)
        self._rows += rows
        if self._rows > (MOST_HELD if self._notes is None else _AT_ONCE):
            if self._notes is None:
                from rvmon.cli.failure_notes import FailureNotes

                self._notes = FailureNotes(*self._judged, core)
            self._notes.take(self._pieces, last_of(piece))
            self._pieces, self._rows = [], 0

    def finish(self, end: int) -> FailureNotes | None:
        """The notes on a recording that ends at `end` (ticks); `None` for a short recording."""
        if self._notes is not None:
            self._notes.finish(self._pieces, end)
        return self._notes

    def until(self, end: int) -> list[Batch | Sample] | None:
        """The pieces up to `end` (ticks); `None` if they were not kept."""
        return None if self._notes is not None else list(pieces_up_to(self._pieces, end))


def post_analysis(
    spec: Spec,
    recording: FileRecording,
    remembered: Remembered,
    report: Report,
    *,
    goals: bool,
    explains: bool = True,
) -> dict[str, Any]:
    """Fields to add to a report: the cover goals and, with `explains`, explanations.

    Explanations are the near misses of triggers that were never true, the responses that came after
    their deadline, and the values of signals at failures. A stream cannot be read again, so it gets
    none of these fields.
    """
    trace, names, end = recording.path, recording.names, report.end
    if end is None or not recording.can_be_read_again:
        return {}
    found: dict[str, Any] = {}
    if goals and spec.checked.covers:
        found["goals"] = _goals(spec, trace, end)
    if not explains:
        return found
    notes = remembered.finish(end)
    failures = list(_first_failures(report))
    values, windows = _Values(spec, failures, notes), _Windows(spec, failures, report.origin)
    late = _Late(spec, report, notes)
    triggers = {
        name: spec.looking.trigger(name) for name in report.verdicts if report.is_silent(name)
    }
    questions = [*late.questions, *(trigger.question for trigger in triggers.values())]
    seen: RecordedTruths | None = None
    if questions or triggers or values.names or windows.names:
        from rvmon.analysis.truths import look_through

        until = end if questions else max(values.until, windows.until)
        pieces: Iterable[Batch | Sample] | None = remembered.until(until)
        if pieces is None:
            names_read = {name for question in questions for name in question.names}
            pieces = _read_again(spec, recording, names_read | values.names | windows.names, until)
        if failures:
            whole = Trace((), names, end, recording.outages)
            pieces = windows.noted(values.noted(pieces), whole)
        seen = look_through(
            spec.checked, questions, pieces, end, names, spec.looking.plans, recording.outages
        )
        misses = {name: trigger.miss_in(seen) for name, trigger in triggers.items()}
        found["misses"] = {name: miss for name, miss in misses.items() if miss}
    if failures:
        shown: dict[str, dict[int, dict[str, str]]] = {}
        for requirement, number, own in (*values.of_attempts(), *windows.of_attempts()):
            if own:
                shown.setdefault(requirement, {}).setdefault(number, {}).update(own)
        found["values"] = shown
    found["late"] = late.arrived(seen)
    return found


class _Values:
    """The values of the blamed signals at the first failures."""

    def __init__(self, spec: Spec, failures: Sequence[Attempt], notes: FailureNotes | None) -> None:
        self.names: set[str] = set()  # the signals to look up in the recording
        self.until = 0  # the last instant of interest, ticks
        self._spec = spec
        self._reads: list[tuple[Attempt, Set[str]]] = []
        if not failures:
            return
        from rvmon.cli.failure_notes import names_blamed, values_at

        self._known = {} if notes is None else dict(notes.values.known)
        self._at = values_at(spec)
        for attempt in failures:
            names, instant = names_blamed(spec, attempt), attempt.decided or 0
            if names:
                self._reads.append((attempt, names))
            unknown = {name for name in names if (instant, name) not in self._known}
            if unknown:
                self._at.ask(instant, unknown)
                self.until = max(self.until, instant)
                self.names |= unknown

    def noted(self, pieces: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """Pass the pieces through unchanged, and note the values; no piece is kept."""
        if not self.names:
            yield from pieces
            return
        for piece in pieces:
            if isinstance(piece, Sample) or len(piece.times):
                self._at.take([piece])
            yield piece
        self._at.finish()
        self._known |= self._at.known

    def of_attempts(self) -> Iterator[tuple[str, int, Mapping[str, str]]]:
        """For each failure: requirement, number, and the values at its decision with units."""
        from rvmon.report.tracks import names_of_requirement

        signals = self._spec.checked.signals
        for attempt, names in self._reads:
            order = names_of_requirement(self._spec.requirements[attempt.requirement])
            own = {
                name: value_text(self._known[attempt.decided or 0, name], signals[name].type.unit)
                for name in order
                if name in names
            }
            yield attempt.requirement, attempt.number, own


class _Windows:
    """The values of the blamed past windows at the first failures."""

    def __init__(self, spec: Spec, failures: Sequence[Attempt], origin: int) -> None:
        self._spec = spec
        self._origin = origin
        self._requests: dict[tuple[str, int], list[WindowRequest]] = {}
        for attempt in failures:
            from rvmon.analysis.window_values import windows_blamed
            from rvmon.cli.failure_notes import MOST_VALUES

            assert attempt.blame is not None, "only these are requested"
            requirement = spec.requirements[attempt.requirement]
            found = windows_blamed(spec.checked, requirement, attempt.blame)
            if found and len(found) <= MOST_VALUES:
                key = attempt.requirement, attempt.number
                self._requests[key] = [(attempt.decided or 0, window) for window in found]
        requests = [request for own in self._requests.values() for request in own]
        self.names: Set[str] = {name for _, window in requests for name in names_in(window)}
        self.until = max((t for t, _ in requests), default=0)
        self._values: Mapping[WindowRequest, Scalar] = {}

    def noted(self, pieces: Iterable[Batch | Sample], recording: Trace) -> Iterator[Batch | Sample]:
        """Pass the pieces through unchanged, and compute the windows.

        Of `recording`, only names, end and outages are used.
        """
        if not self._requests:
            yield from pieces
            return
        from rvmon.analysis.window_values import WindowValues

        requests = [request for own in self._requests.values() for request in own]
        run = WindowValues(self._spec.checked, requests, self._origin, recording)
        for piece in pieces:
            run.take(piece)
            yield piece
        self._values = run.values()

    def of_attempts(self) -> Iterator[tuple[str, int, Mapping[str, str]]]:
        """For each failure: requirement, number, and the values at its decision with units."""
        from rvmon.analysis.window_values import unit_of

        for (requirement, number), requests in self._requests.items():
            own = {
                format_window(window): value_text(value, unit_of(self._spec.checked, window) or "")
                for t, window in requests
                if (value := self._values.get((t, window))) is not None
            }
            yield requirement, number, own


def _first_failures(report: Report) -> Iterator[Attempt]:
    """The failures that reports show, of those with a known blame."""
    for name, verdict in report.verdicts.items():
        failed = report.of(name, Verdict.FAIL) if verdict is Verdict.FAIL else iter(())
        for attempt in islice(failed, SHOWN_PER_REQUIREMENT):
            if attempt.blame is not None:
                yield attempt


def _read_again(
    spec: Spec, judged: FileRecording, names: set[str], end: int
) -> Iterable[Batch | Sample]:
    """Read a recording again up to `end` (ticks), at least the names in `names`."""
    # In sampled time, and for messages, it matters that a sample came, whatever names it updates.
    narrow = spec.checked.time is not TimeModel.SAMPLED and not judged.is_of_messages
    only = names if narrow else None
    return Source(opened(spec, judged.path, only=only), end, is_cut=True).pieces()


class _Late:
    """Late responses: the instants at which the first failures got what they had awaited."""

    def __init__(self, spec: Spec, report: Report, notes: FailureNotes | None) -> None:
        self._known: Mapping[tuple[str, int], int | None] = {} if notes is None else notes.late
        self._failed: dict[str, list[Attempt]] = {}
        self._waits: dict[str, Mapping[int, Question]] = {}
        failed = [name for name, verdict in report.verdicts.items() if verdict == "F"]
        if failed:
            from rvmon.analysis.late_arrival import waits_of
            from rvmon.cli.failure_notes import looked_up

            for name in failed:
                requirement = spec.requirements[name]
                most = looked_up(requirement, len(failed))
                attempts = list(islice(report.of(name, Verdict.FAIL), most))
                left = [one for one in attempts if (name, one.number) not in self._known]
                self._failed[name] = attempts
                self._waits[name] = waits_of(requirement, left)
        # the questions that need the recording again
        self.questions = [one for waits in self._waits.values() for one in waits.values()]

    def arrived(self, seen: RecordedTruths | None) -> Mapping[str, Mapping[int, int]]:
        """The instants (ticks) by requirement and number of the attempt.

        `seen` has the answers to `questions`.
        """
        found = {}
        for name, attempts in self._failed.items():
            came = {one.number: self._known.get((name, one.number)) for one in attempts}
            if seen is not None and self._waits[name]:
                from rvmon.analysis.late_arrival import late_in

                came |= late_in(attempts, self._waits[name], seen)
            own = {number: at for number, at in came.items() if at is not None}
            if own:
                found[name] = own
        return found


def _goals(spec: Spec, trace: str, end: int) -> Mapping[str, Verdict]:
    from rvmon.coverage.requirements import goal_verdicts, goals_as_requirements

    goals = Spec(goals_as_requirements(spec.checked))
    return goal_verdicts(goals.judge(Source(spec.recording(trace), end, is_cut=True)))
