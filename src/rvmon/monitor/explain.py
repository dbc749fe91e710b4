"""The sentences and details of a record."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.automaton.stretch import run
from rvmon.formula.horizon import horizon
from rvmon.formula.progress import after, value
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.bench import Bench, Open
from rvmon.monitor.cause import CauseFinder
from rvmon.monitor.judge import Judge
from rvmon.monitor.wording import deadline, settled_alone
from rvmon.trace.time import format_ticks
from rvmon.verdict.attempt import Blame


@dataclass(frozen=True, slots=True)
class Explanation:
    """What a record says beside the verdict; see `rvmon.verdict.attempt.Attempt`."""

    reason: str = ""
    owed: str = ""
    deadline: int | None = None
    blame: Blame | None = None


def explain_decision(
    judge: Judge, attempt: Open, verdict: bool, t: int, before: Token
) -> Explanation:
    """Why an attempt was decided at `t`; see `rvmon.monitor.bench.Clerk.decided`."""
    words = judge.compiled.words
    letter = judge.letters[0 if verdict else 1]
    location, anchors = _just_before(judge, before, letter, t)
    residual = judge.machine.residual(location)
    by_time = value(after(residual, [t - anchor for anchor in anchors])) != UNKNOWN
    cells = judge.compiled.alphabet.cells_of(letter)
    finder = CauseFinder(cells, t, attempt.triggered, verdict=verdict, by_time=by_time)
    cause = finder.of(residual, anchors)
    if cause is None:
        return Explanation("nothing was owed" if verdict else "it can never hold")
    return Explanation(
        words.reason(cause, verdict, t, judge.flow),
        deadline=deadline(residual, anchors),
        blame=None if verdict else words.blame(cause, t, judge.flow),
    )


def _just_before(judge: Judge, token: Token, letter: int, t: int) -> Token:
    """The token as it stood at the last position before `t`."""
    gap, position = judge.flow.gap, judge.position
    if gap is None or position + gap > t - 1:
        return token
    return run(judge.machine, token, letter, position + gap, t - 1, gap)[0]


def explain_open(judge: Judge, attempt: Open, now: int, end: int | None = None) -> Explanation:
    """What an undecided attempt waits for, or why it can wait no more.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
        end: the last instant of the trace, if it has ended.
    """
    token = attempt.token if attempt.token[0] != FAILED else attempt.better
    if token is None or token[0] <= PASSED:
        return Explanation(f"left open by the input: {attempt.doubt}")
    location, anchors = token
    residual = after(judge.machine.residual(location), [now // 2 - anchor for anchor in anchors])
    owed = judge.compiled.words.owed(residual, anchors)
    doubt = f"; {attempt.doubt}" if attempt.doubt else ""
    reason = f"still owed: {owed}{longer(judge, attempt, end)}{doubt}"
    return Explanation(reason, owed, deadline=_deadline(judge, attempt))


def _deadline(judge: Judge, attempt: Open) -> int | None:
    """The last instant before time alone decides an attempt."""

    def alone(token: Token) -> tuple[int, bool] | None:
        undecided = token[0] > PASSED
        return settled_alone(judge.machine.residual(token[0]), token[1]) if undecided else None

    return earlier(alone(attempt.token), alone(attempt.better or attempt.token))


def earlier(worse: tuple[int, bool] | None, better: tuple[int, bool] | None) -> int | None:
    """When two runs come to a decision: the one for the worse has to pass, or the other to fail.

    Args:
        worse: what time alone makes of the run that takes the unknown for the worse, and when.
        better: the same of the run that takes it for the better.
    """
    found = [worse[0]] if worse is not None and worse[1] else []
    found += [better[0]] if better is not None and not better[1] else []
    return min(found, default=None)


def longer(judge: Bench, attempt: Open, end: int | None) -> str:
    """How much longer a trace that has ended would decide an attempt, whatever it brings."""
    if end is None:
        return ""
    reach = horizon(judge.compiled.obligation.owed)
    if reach is None:
        return "; no time bounds all of it"
    latest = attempt.triggered + reach
    if latest <= end:
        return "; a tick longer would decide it"
    return f"; more than {format_ticks(latest - end)} longer would decide it"
