"""Questions to a recording once its verdicts are known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import TYPE_CHECKING, Any

from rvmon.cli.reading import opened
from rvmon.language.checked.classify import subformulas
from rvmon.language.checked.formula import Amount, Compare, windows_in
from rvmon.language.checked.names_read import names_in, names_read
from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_window
from rvmon.recordings.source import Source, pieces_up_to
from rvmon.report.wording import SHOWN_PER_REQUIREMENT, value_text
from rvmon.session import Spec
from rvmon.trace.sample import Sample, Scalar, Trace
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from rvmon.analysis.truths import Question, RecordedTruths
    from rvmon.analysis.window_values import Asked
    from rvmon.recordings.batch import Batch
    from rvmon.recordings.recording import FileRecording
    from rvmon.report.changes import RunChanges
    from rvmon.verdicts.attempt import Attempt
    from rvmon.verdicts.report import Report

MOST_HELD = 65_536
"""The most rows kept in memory; a longer recording is read a second time."""


class Remembered:
    """The pieces of a recording as they were read, if they are few."""

    def __init__(self) -> None:
        self._pieces: list[Batch | Sample] = []
        self._left = MOST_HELD

    def passing(self, found: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """The parts that are read, unchanged."""
        for piece in found:
            self._left -= 1 if isinstance(piece, Sample) else len(piece.times)
            if self._left >= 0:
                self._pieces.append(piece)
            yield piece

    def until(self, end: int) -> list[Batch | Sample] | None:
        """The parts up to an instant; `None`: there were more than are kept."""
        if self._left < 0:
            return None
        return list(pieces_up_to(self._pieces, end))


MOST_LATE = 1000
"""Failures of a requirement of which it is looked up whether what they awaited came late."""

MOST_LATE_IN_ALL = 10_000
"""The same of all requirements, of which each gets its share, and at least one."""

MOST_VALUES = 3
"""The most signals of a failed part whose values are shown; `rvmon why` shows all."""


def post_analysis(
    spec: Spec,
    recording: FileRecording,
    remembered: Remembered,
    report: Report,
    *,
    goals: bool,
    explains: bool = True,
) -> dict[str, Any]:
    """Additions to a report: the cover goals, and on request what only the whole recording shows.

    That is what the triggers lacked that never came true, and what came after its deadline.

    Streams cannot be read again.
    """
    trace, names, end = recording.path, recording.names, report.end
    if end is None or not recording.can_be_read_again:
        return {}
    found: dict[str, Any] = {}
    if goals and spec.checked.covers:
        found["goals"] = _goals(spec, trace, end)
    if not explains:
        return found
    failures = list(_first_failures(report))
    values, windows = _Values(spec, failures), _Windows(spec, failures, report.origin)
    late = _missed(spec, report)
    silent = [name for name in report.verdicts if report.is_silent(name)]
    if not late and not silent and not values.names and not windows.names:
        return found
    from rvmon.analysis.truths import look_through

    questions = [question for _, waits in late.values() for question in waits.values()]
    triggers = {name: spec.looking.trigger(name) for name in silent}
    questions += [trigger.question for trigger in triggers.values()]
    until = end if questions else max(values.until, windows.until)
    pieces: Iterable[Batch | Sample] | None = remembered.until(until)
    if pieces is None:
        asked = {
            name
            for question in questions
            for part in question.formulas
            for name in names_read(part)
        }
        asked |= {
            question.for_each.value.event for question in questions if question.for_each is not None
        }
        pieces = _read_again(spec, recording, asked | values.names | windows.names, until)
    noted = windows.noted(values.noted(pieces), Trace((), names, end, recording.outages))
    seen = look_through(
        spec.checked, questions, noted, end, names, spec.looking.plans, recording.outages
    )
    misses = {name: trigger.miss_in(seen) for name, trigger in triggers.items()}
    shown: dict[str, dict[int, dict[str, str]]] = {}
    for requirement, number, own in (*values.of_attempts(), *windows.of_attempts()):
        if own:
            shown.setdefault(requirement, {}).setdefault(number, {}).update(own)
    found["values"] = shown
    found["late"] = _arrived(late, seen) if late else {}
    found["misses"] = {name: miss for name, miss in misses.items() if miss}
    return found


class _Values:
    """The values of the signals of the first failures, noted as a recording is read."""

    def __init__(self, spec: Spec, failures: Sequence[Attempt]) -> None:
        self._spec = spec
        self._reads = [
            (attempt, names) for attempt in failures if (names := _names_blamed(spec, attempt))
        ]
        self._asked: dict[int, set[str]] = {}
        for attempt, names in self._reads:
            self._asked.setdefault(attempt.decided or 0, set()).update(names)
        self.names: Set[str] = {name for names in self._asked.values() for name in names}
        self.until = max(self._asked, default=0)
        self._known: dict[int, Mapping[str, str]] = {}

    def noted(self, pieces: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """The pieces, unchanged; nothing is kept of one that was passed."""
        if not self._asked:
            yield from pieces
            return
        from rvmon.report.changes import RunChanges

        changes = RunChanges(self._spec.checked, self.names)
        waiting = sorted(self._asked, reverse=True)

        def note(until: int) -> None:
            while waiting and waiting[-1] <= until:
                instant = waiting.pop()
                self._known[instant] = self._values_at(instant, changes)

        for piece in pieces:
            times = [piece.t] if isinstance(piece, Sample) else piece.times
            if waiting and len(times):
                note(int(times[0]) - 1)
                changes.add(piece)
                note(int(times[-1]) - 1)  # of the last instant more may come
                for one in changes.by_name.values():
                    one.forget()
            yield piece
        note(self.until)

    def _values_at(self, instant: int, changes: RunChanges) -> Mapping[str, str]:
        signals = self._spec.checked.signals
        return {
            name: value_text(changes.by_name[name].value_at(instant), signals[name].type.unit)
            for name in sorted(self._asked[instant])
        }

    def of_attempts(self) -> Iterator[tuple[str, int, Mapping[str, str]]]:
        """By requirement and number of the attempt, what they were at its decision."""
        from rvmon.report.tracks import concerned_names

        for attempt, names in self._reads:
            values = self._known[attempt.decided or 0]
            order = concerned_names(self._spec.requirements[attempt.requirement])
            own = {name: values[name] for name in order if name in names}
            yield attempt.requirement, attempt.number, own


class _Windows:
    """The values of the past windows of the first failures."""

    def __init__(self, spec: Spec, failures: Sequence[Attempt], origin: int) -> None:
        from rvmon.analysis.window_values import windows_blamed

        self._spec = spec
        self._origin = origin
        self._asked: dict[tuple[str, int], list[Asked]] = {}
        for attempt in failures:
            assert attempt.blame is not None, "only these are asked for"
            requirement = spec.requirements[attempt.requirement]
            found = windows_blamed(spec.checked, requirement, attempt.blame)
            if found and len(found) <= MOST_VALUES:
                key = attempt.requirement, attempt.number
                self._asked[key] = [(attempt.decided or 0, window) for window in found]
        asked = [asked for own in self._asked.values() for asked in own]
        self.names: Set[str] = {name for _, window in asked for name in names_in(window)}
        self.until = max((t for t, _ in asked), default=0)
        self._values: Mapping[Asked, Scalar] = {}

    def noted(self, pieces: Iterable[Batch | Sample], recording: Trace) -> Iterator[Batch | Sample]:
        """The pieces of a recording, unchanged; of that only names, end and outages are taken."""
        if not self._asked:
            yield from pieces
            return
        from rvmon.analysis.window_values import WindowValues

        asked = [asked for own in self._asked.values() for asked in own]
        run = WindowValues(self._spec.checked, asked, self._origin, recording)
        for piece in pieces:
            run.take(piece)
            yield piece
        self._values = run.values()

    def of_attempts(self) -> Iterator[tuple[str, int, Mapping[str, str]]]:
        """By requirement and number of the attempt, what they were at its decision."""
        from rvmon.analysis.window_values import unit_of

        for (requirement, number), asked in self._asked.items():
            own = {
                format_window(window): value_text(value, unit_of(self._spec.checked, window) or "")
                for t, window in asked
                if (value := self._values.get((t, window))) is not None
            }
            yield requirement, number, own


def _names_blamed(spec: Spec, attempt: Attempt) -> Set[str]:
    """The signals of which the value tells why it failed.

    Not what is itself true or false, nor what was measured over a window.
    """
    from rvmon.report.tracks import blamed_names

    assert attempt.blame is not None, "only these are asked for"
    requirement = spec.requirements[attempt.requirement]
    measured: set[str] = set()
    for subformula in subformulas(requirement.consequent):
        if isinstance(subformula, Amount):
            measured |= {*names_read(subformula)}
        elif isinstance(subformula, Compare):
            windows = windows_in(subformula.left, subformula.right)
            measured |= {name for window in windows for name in names_in(window)}
    signals = spec.checked.signals
    signals_blamed = {
        name
        for name in blamed_names(requirement, attempt.blame) - measured
        if name in signals and signals[name].type.kind is not Kind.BOOL
    }
    return signals_blamed if len(signals_blamed) <= MOST_VALUES else set()


def _first_failures(report: Report) -> Iterator[Attempt]:
    """The failures that are shown, if it is known what was to blame."""
    for name, verdict in report.verdicts.items():
        failed = report.of(name, Verdict.FAIL) if verdict is Verdict.FAIL else iter(())
        for attempt in islice(failed, SHOWN_PER_REQUIREMENT):
            if attempt.blame is not None:
                yield attempt


def _read_again(
    spec: Spec, judged: FileRecording, asked: set[str], end: int
) -> Iterable[Batch | Sample]:
    """A recording up to an instant, with what is asked for of it."""
    # Elsewhere it counts that something came, whatever that was.
    narrow = spec.checked.time is not TimeModel.SAMPLED and not judged.is_of_messages
    only = asked if narrow else None
    return Source(opened(spec, judged.path, only=only), end, is_cut=True).pieces()


def _missed(
    spec: Spec, report: Report
) -> Mapping[str, tuple[Sequence[Attempt], Mapping[int, Question]]]:
    """By requirement its first failures, and what these awaited by number of the attempt."""
    failed = [name for name, verdict in report.verdicts.items() if verdict == "F"]
    if not failed:
        return {}
    from rvmon.analysis.subformulas import waits_of

    most = max(1, min(MOST_LATE, MOST_LATE_IN_ALL // len(failed)))
    found = {}
    for name in failed:
        requirement = spec.requirements[name]
        # What was captured, and each instance, takes a pass over the recording by itself.
        is_alone = bool(requirement.for_each or requirement.captures)
        own = SHOWN_PER_REQUIREMENT if is_alone else most
        attempts = list(islice(report.of(name, Verdict.FAIL), own))
        waits = waits_of(requirement, attempts)
        if waits:
            found[name] = attempts, waits
    return found


def _arrived(
    late: Mapping[str, tuple[Sequence[Attempt], Mapping[int, Question]]], seen: RecordedTruths
) -> Mapping[str, Mapping[int, int]]:
    """By requirement and number of the attempt, when what it awaited came after all."""
    from rvmon.analysis.subformulas import late_in

    arrived = {name: late_in(attempts, waits, seen) for name, (attempts, waits) in late.items()}
    return {name: found for name, found in arrived.items() if found}


def _goals(spec: Spec, trace: str, end: int) -> Mapping[str, Verdict]:
    from rvmon.coverage.requirements import goal_verdicts, goals_as_requirements

    goals = Spec(goals_as_requirements(spec.checked))
    return goal_verdicts(goals.judge(Source(spec.recording(trace), end, is_cut=True)))
