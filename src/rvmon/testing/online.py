"""What a monitor says while it runs: each call's decisions, what is open, what is due."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from rvmon.errors import RvmonError, TimeOrderError
from rvmon.testing.attempts import is_upon_end
from rvmon.testing.case import Case
from rvmon.testing.compare import Key, outcomes
from rvmon.testing.drive import Monitored, tell
from rvmon.testing.law import judge
from rvmon.trace.sample import Sample
from rvmon.verdict.attempt import Attempt, Decision
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


@runtime_checkable
class Watched(Protocol):
    """A monitor that can be asked at any time."""

    @property
    def open(self) -> Sequence[Attempt]:
        """The attempts that are undecided now."""

    @property
    def next_due(self) -> int | None:
        """The next instant at which time alone can decide something."""


def online_differences(case: Case, monitor: Monitored) -> list[str]:
    """What is wrong with what a monitor says at each action of a case; empty if all is right.

    Each call has to return what could be decided by then, no sooner and no later; what is open is
    what no prefix has decided; before it is due, time alone decides nothing; what was forecast
    does not come out otherwise; a wrong sample is refused and changes nothing. Costs one run of the
    oracle per action.

    Args:
        case: what to tell.
        monitor: fresh, for the spec and the sources of the case.
    """
    told: set[Key] = set()
    due: int | None = None
    forecast: dict[Key, Verdict] = {}
    for count, action in enumerate(case.actions, start=1):
        attempts = tell(monitor, action)
        report = judge(Case(case.spec, case.actions[:count], None, case.names))
        found = [*_returned(case, report, attempts, told)]
        if isinstance(monitor, Watched):
            found += _early(attempts, due, action) if count > 1 else ()
            open_ = monitor.open
            found += _open(case, report, open_)
            found += _unforeseen(report, forecast)
            forecast |= {(a.requirement, a.number): a.forecast for a in open_ if a.forecast}
            due = monitor.next_due
        found += _taken(monitor, action)
        if found:
            return [f"action {count} {line}" for line in found]
        told |= {(a.requirement, a.number) for a in attempts}
    return []


def differences_after_end(case: Case, monitor: Monitored, report: Report) -> list[str]:
    """What a monitor does wrong once its run is finished: it has to take nothing, and stay so.

    Args:
        case: what it was told.
        monitor: finished.
        report: what it said then.
    """
    last = case.actions[-1] if case.actions else 0
    later = 1_000 + (last.t if isinstance(last, Sample) else last)
    lines = []
    if isinstance(monitor, Watched) and monitor.next_due is not None:
        lines.append(f"due at {monitor.next_due}, though finished")
    calls: tuple[Callable[[], object], ...] = (
        lambda: monitor.step_ns(later, {}),
        lambda: monitor.advance_ns(later),
    )
    for name, call in zip(("sample", "advance"), calls, strict=True):
        try:
            call()
        except RvmonError:
            continue
        lines.append(f"{name} at {later} was taken, though finished")
    if monitor.finish_ns(later) != report:
        lines.append("finishing once more gave another report")
    return lines


def _returned(
    case: Case, report: Report, attempts: Sequence[Attempt], told: set[Key]
) -> Iterator[str]:
    at_end = _at_end(case)
    due = {
        (a.requirement, a.number)
        for a in report.attempts
        if a.decision is Decision.PREFIX and a.requirement not in at_end
    }
    now = {(a.requirement, a.number) for a in attempts}
    if now != due - told:
        yield f"decides {sorted(due - told)}, returned {sorted(now)}"
        return
    wanted = outcomes(report)
    for attempt in attempts:
        key = (attempt.requirement, attempt.number)
        if (attempt.decided, attempt.verdict) != (wanted[key].decided, wanted[key].verdict):
            yield f"returned {attempt}, expected {wanted[key]}"


def _open(case: Case, report: Report, found: Sequence[Attempt]) -> Iterator[str]:
    at_end = _at_end(case)
    wanted = {
        (a.requirement, a.number, a.triggered)
        for a in report.attempts
        if a.decision is not Decision.PREFIX and a.requirement not in at_end
    }
    got = {(a.requirement, a.number, a.triggered) for a in found}
    if got != wanted or len(found) != len(got):
        yield f"leaves open {sorted(wanted)}, shown are {sorted(got)}"


def _unforeseen(report: Report, forecast: Mapping[Key, Verdict]) -> Iterator[str]:
    """What was decided otherwise than a forecast said."""
    for (name, number), outcome in outcomes(report).items():
        said = forecast.get((name, number), outcome.verdict)
        if outcome.decision is Decision.PREFIX and said is not outcome.verdict:
            yield f"decides {name} #{number}: {outcome}; {said.value} was forecast"


def _early(attempts: Sequence[Attempt], due: int | None, action: Sample | int) -> Iterator[str]:
    """What was decided by time alone up to an action before it was due."""
    instant = action.t if isinstance(action, Sample) else action
    if due is None or instant < due:
        for attempt in attempts:
            if not isinstance(action, Sample) or (attempt.decided or 0) < instant:
                yield f"brought {attempt}, but due was {due}"


def _taken(monitor: Monitored, action: Sample | int) -> Iterator[str]:
    """The wrong samples that a monitor takes after an action."""
    late = action.t if isinstance(action, Sample) else action - 1
    wrong: tuple[tuple[int, dict[str, Any], type[RvmonError]], ...] = (
        (late, {}, TimeOrderError),
        (late + 1, {"nothing of that name": True}, RvmonError),
        (late + 1, {"p": "no truth value"}, RvmonError),
    )
    for t, values, expected in wrong:
        try:
            monitor.step_ns(t, values)
        except expected:
            continue
        yield f"was followed by a sample at {t} with {values}, and it was taken"


def _at_end(case: Case) -> set[str]:
    return {r.id for r in case.spec.requirements.values() if is_upon_end(r)}
