"""What is asked of a recording when its verdicts are known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from rvmon.cli.reading import opened
from rvmon.readers.recording import can_be_read_again
from rvmon.readers.source import Source
from rvmon.session import Spec
from rvmon.spec.checked.names_read import names_read
from rvmon.spec.checked.specification import TimeModel
from rvmon.trace.sample import Sample
from rvmon.verdict import Verdict

if TYPE_CHECKING:
    from rvmon.analysis.truths import Question
    from rvmon.readers.batch import Batch
    from rvmon.readers.recording import FileRecording
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report

MOST_HELD = 65_536
"""Of a recording with more rows nothing is remembered: it is read once more."""


class Remembered:
    """The pieces of a recording as they were read, if they are few."""

    def __init__(self) -> None:
        self._pieces: list[Batch | Sample] = []
        self._left = MOST_HELD

    def passing(self, found: Iterable[Batch | Sample]) -> Iterator[Batch | Sample]:
        """What is read, unchanged."""
        for piece in found:
            self._left -= 1 if isinstance(piece, Sample) else len(piece.times)
            if self._left >= 0:
                self._pieces.append(piece)
            yield piece

    def until(self, end: int) -> list[Batch | Sample] | None:
        """What was read of it up to an instant; `None`: there was more than is remembered."""
        if self._left < 0:
            return None
        return [
            piece if isinstance(piece, Sample) else piece.up_to(end)
            for piece in self._pieces
            if not isinstance(piece, Sample) or piece.t <= end
        ]


MOST_LATE = 1000
"""Failures of a requirement of which it is looked up whether what they awaited came late."""

MOST_LATE_IN_ALL = 10_000
"""The same of all requirements, of which each gets its share, and at least one."""


def post_analysis(
    spec: Spec,
    recording: FileRecording,
    remembered: Remembered,
    report: Report,
    *,
    goals: bool,
    explains: bool = True,
) -> Report:
    """The report with the cover goals, and with what only the whole recording shows, if asked.

    That is what the triggers lacked that never came true, and what came after its deadline.

    Streams cannot be read again.
    """
    trace, names, end = recording.path, recording.names, report.end
    if end is None or not can_be_read_again(trace):
        return report

    if goals and spec.checked.covers:
        report = replace(report, goals=_goals(spec, trace, end))

    if not explains:
        return report
    late, silent = _missed(spec, report), _silent(report)
    if not late and not silent:
        return report
    from rvmon.analysis.near_miss import miss_in, parts_asked
    from rvmon.analysis.subformulas import late_in
    from rvmon.analysis.truths import look_through

    questions = [question for _, waits in late.values() for question in waits.values()]
    questions += [parts_asked(spec.requirements[name]) for name in silent]
    held = remembered.until(end)
    pieces = _read_again(spec, recording, questions, end) if held is None else held
    seen = look_through(spec.checked, questions, pieces, end, names, spec.plans_of_truths)
    arrived = {name: late_in(attempts, waits, seen) for name, (attempts, waits) in late.items()}
    misses = {name: miss_in(spec.checked, spec.requirements[name], seen) for name in silent}
    return replace(
        report,
        late={name: found for name, found in arrived.items() if found},
        misses={name: miss for name, miss in misses.items() if miss},
    )


def _read_again(
    spec: Spec, judged: FileRecording, questions: Sequence[Question], end: int
) -> Iterable[Batch | Sample]:
    """A recording up to its end, with what is asked for of it."""
    only: set[str] | None = None
    # Elsewhere it counts that something came, whatever that was.
    if spec.checked.time is not TimeModel.SAMPLED and not judged.is_of_messages:
        only = {name for one in questions for part in one.formulas for name in names_read(part)}
        only |= {one.for_each.value.event for one in questions if one.for_each is not None}
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
        attempts = list(islice(report.of(name, Verdict.FAIL), most))
        waits = waits_of(spec.requirements[name], attempts)
        if waits:
            found[name] = attempts, waits
    return found


def _silent(report: Report) -> list[str]:
    """The requirements without attempts."""
    return [name for name in report.verdicts if report.is_silent(name)]


def _goals(spec: Spec, trace: str, end: int) -> Mapping[str, Verdict]:
    from rvmon.coverage.requirements import goal_verdicts, goals_as_requirements

    goals = Spec(goals_as_requirements(spec.checked))
    return goal_verdicts(goals.judge(Source(spec.recording(trace), end, is_cut=True)))
