"""Two reports on the same case: do they say the same?"""

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.trace.sample import Scalar
from rvmon.trace.time import format_ticks
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision
from rvmon.verdicts.report import Report


@dataclass(frozen=True, slots=True)
class Outcome:
    """What engines have to agree on for one attempt."""

    triggered: int
    decided: int | None
    verdict: Verdict
    decision: Decision
    captured: Mapping[str, Scalar]

    def __str__(self) -> str:
        when = "" if self.decided is None else f" at {format_ticks(self.decided)}"
        trigger = format_ticks(self.triggered)
        with_ = f" with {self.captured}" if self.captured else ""
        return f"triggered at {trigger}{with_}, {self.verdict.value}{when} ({self.decision.value})"


Key = tuple[str, bool, int]
"""Requirement, whether in doubt, and number."""


def key_of(attempt: Attempt) -> Key:
    """What distinguishes an attempt from all others."""
    return attempt.requirement, attempt.in_doubt, attempt.number


def outcomes(report: Report) -> dict[Key, Outcome]:
    """The outcome of every attempt."""
    return {key_of(a): _outcome(a) for a in report.attempts}


def _outcome(attempt: Attempt) -> Outcome:
    return Outcome(
        attempt.triggered,
        attempt.decided,
        attempt.verdict,
        attempt.decision,
        dict(attempt.captured),
    )


def differences(expected: Report, actual: Report) -> list[str]:
    """One line per disagreement; none if the two agree.

    Compared are the verdicts of requirements, and of each attempt requirement, number, trigger
    and decision instants, verdict, what settled it, captured values, and the order of the report.
    """
    lines = [
        f"{name}: verdict {_show(expected, name)}, got {_show(actual, name)}"
        for name in sorted({*expected.verdicts, *actual.verdicts})
        if expected.verdicts.get(name) != actual.verdicts.get(name)
    ]
    wanted, got = outcomes(expected), outcomes(actual)
    for key in sorted({*wanted, *got}):
        if wanted.get(key) != got.get(key):
            name, in_doubt, number = key
            mark = "?" if in_doubt else "#"
            lines.append(f"{name}{mark}{number}: {wanted.get(key)}; got {got.get(key)}")
    if not lines and list(wanted) != list(got):
        lines.append(f"the attempts are reported in the order {list(wanted)}, got {list(got)}")
    if len(expected.attempts) != len(actual.attempts) and not lines:
        lines.append(f"{len(expected.attempts)} attempts, got {len(actual.attempts)}")
    return lines


def _show(report: Report, name: str) -> str:
    verdict = report.verdicts.get(name)
    return "none" if verdict is None else verdict.value


def frame_differences(expected: Report, actual: Report) -> list[str]:
    """One line per disagreement on where the trace begins and ends."""
    return [
        f"{what} of the trace: {getattr(expected, what)}, got {getattr(actual, what)}"
        for what in ("origin", "end")
        if getattr(expected, what) != getattr(actual, what)
    ]
