"""What a monitor says while it runs: each call's decisions, what is open, what is due."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from rvmon.errors import RvmonError, TimeOrderError
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report
from tests.tools.compare import Key, Outcome, key_of
from tests.tools.drive import Monitored, feed
from tests.tools.forms import HeldBack
from tests.tools.judgement import Judgement, Waiting, moments


def is_silent(monitor: Monitored) -> bool:
    """Whether it says nothing before the end; others can be asked at any time."""
    return getattr(type(monitor), "silent", False)


def online_differences(judgement: Judgement, monitor: Any) -> list[str]:
    """What is wrong with what a monitor says at each action of a case; empty if all is right.

    Each call has to return what could be decided by then, no sooner and no later; what is open is
    what no prefix has decided, with the deadline and the parts that it waits for; before it is due,
    time alone decides nothing; what was forecast does not come out otherwise; a wrong sample is
    refused and changes nothing.
    """
    case = judgement.case
    settle = "next" if isinstance(monitor, HeldBack) else "now"
    # A portion of a wrong sample may be right.
    whole = monitor.monitor if isinstance(monitor, HeldBack) else monitor
    told: set[Key] = set()
    due: int | None = None
    forecast: dict[Key, Verdict] = {}
    came = moments(case, settle=settle)
    for count, (action, moment) in enumerate(zip(case.actions, came, strict=True), start=1):
        attempts = feed(monitor, action)
        decided, waiting = ({}, {}) if moment is None else judgement.at(moment)
        found = [*_returned(decided, attempts, told)]
        found += _early(attempts, due, action, settle) if count > 1 else ()
        open_ = monitor.open
        found += _open(waiting, open_)
        found += _unforeseen(decided, forecast)
        forecast |= {key_of(a): a.forecast for a in open_ if a.forecast}
        due = monitor.next_due
        found += _taken(whole, action, settle)
        if found:
            return [f"action {count} {line}" for line in found]
        told |= {key_of(a) for a in attempts}
    return []


def differences_after_end(case: Case, monitor: Any, report: Report) -> list[str]:
    """What a monitor does wrong once its run is finished: it has to take nothing, and stay so."""
    last = case.actions[-1] if case.actions else 0
    later = 1_000 + (last.t if isinstance(last, Sample) else last)
    lines = []
    if monitor.next_due is not None:
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
    decided: Mapping[Key, Outcome], attempts: Sequence[Attempt], told: set[Key]
) -> Iterator[str]:
    due = decided.keys() - told
    now = {key_of(a) for a in attempts}
    if now != due or len(attempts) != len(now):
        yield f"decides {sorted(due)}, returned {sorted(map(key_of, attempts))}"
        return
    for attempt in attempts:
        wanted = decided[key_of(attempt)]
        if (attempt.decided, attempt.verdict) != (wanted.decided, wanted.verdict):
            yield f"returned {attempt}, expected {wanted}"


def _open(waiting: Mapping[Key, Waiting], found: Sequence[Attempt]) -> Iterator[str]:
    wanted = {(*key, one.triggered) for key, one in waiting.items()}
    got = {(*key_of(a), a.triggered) for a in found}
    if got != wanted or len(found) != len(got):
        yield f"leaves open {sorted(wanted)}, shown are {sorted(got)}"
        return
    for attempt in found:
        one = waiting[key_of(attempt)]
        for part in one.misnamed(attempt.required, attempt.origin):
            yield f"{attempt} is said to owe {part}, which waits for nothing"
        deadline = one.deadline()
        if attempt.deadline != deadline:
            yield f"{attempt} has the deadline {deadline}, shown is {attempt.deadline}"


def _unforeseen(decided: Mapping[Key, Outcome], forecast: Mapping[Key, Verdict]) -> Iterator[str]:
    """What was decided otherwise than a forecast said."""
    for key, outcome in decided.items():
        said = forecast.get(key, outcome.verdict)
        if said is not outcome.verdict:
            yield f"decides {key}: {outcome}; {said.value} was forecast"


def _early(
    attempts: Sequence[Attempt], due: int | None, action: Sample | int, settle: str
) -> Iterator[str]:
    """What was decided by time alone up to an action before it was due."""
    instant = action.t if isinstance(action, Sample) else action
    if settle == "next":
        return  # a call also settles a sample that came before
    if due is None or instant < due:
        for attempt in attempts:
            if not isinstance(action, Sample) or (attempt.decided or 0) < instant:
                yield f"brought {attempt}, but due was {due}"


def _taken(monitor: Monitored, action: Sample | int, settle: str) -> Iterator[str]:
    """The wrong samples that a monitor takes after an action."""
    passed = isinstance(action, Sample) and settle == "now"
    instant = action.t if isinstance(action, Sample) else action
    late = instant if passed else instant - 1
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
