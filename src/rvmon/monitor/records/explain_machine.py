"""The sentences and details of a record that the run of a machine decided."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Machine, Token
from rvmon.formula.progress import after
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.reasons.obligation_words import settled_alone
from rvmon.monitor.reasons.sentence import rendered
from rvmon.monitor.records.explanation import Explanation, earlier, longer, still_owed, unborn
from rvmon.monitor.records.reasons import Reasons
from rvmon.plan.standing import Standing
from rvmon.runtime.table import run


def explain_decision(
    judge: MachineJudge, attempt: Open, verdict: bool, t: int, before: Token
) -> Explanation:
    """Why an attempt was decided at `t`; see `Clerk.decided`."""
    letter = judge.letter if verdict else judge.other
    machine, flow = judge.machine, judge.flow
    token = just_before(machine, before, letter, judge.position, t, flow.gap)
    reasons = Reasons(judge.compiled, machine)
    return explained(reasons, token, letter, verdict, t, attempt.triggered, flow)


def explained(
    reasons: Reasons,
    before: Token,
    letter: int,
    verdict: bool,
    t: int,
    triggered: int,
    flow: Standing,
) -> Explanation:
    """Why an attempt was decided."""
    finding = reasons.of(before, letter, verdict, t)
    cause = finding.cause
    start = finding.start(before[1], t, triggered)
    return Explanation(
        rendered(finding.sentence, t, start, triggered, flow),
        deadline=None if cause is None else reasons.deadline(before),
        blame=None if verdict or cause is None else reasons.words.blame(cause, t, start, flow),
    )


def just_before(
    machine: Machine, token: Token, letter: int, position: int, t: int, gap: int | None
) -> Token:
    """The token as it stood at the last position before `t`.

    Args:
        machine: of the token.
        token: as it stood at `position`.
        letter: of all positions from there on.
        position: see `token`.
        t: an instant behind it.
        gap: between two positions; `None` if only samples are positions.
    """
    if gap is None or position + gap > t - 1:
        return token
    return run(machine, token, letter, position + gap, t - 1, gap)[0]


def explain_open(
    judge: MachineJudge, attempt: Open, now: int, end: int | None = None
) -> Explanation:
    """What an undecided attempt waits for, or why it can wait no more.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
        end: the last instant of the trace, if it has ended.
    """
    worse, better = _by_now(judge, attempt, (now + 1) // 2)
    token = worse if worse[0] != FAILED else better
    if token[0] <= PASSED:
        return Explanation(f"left open by the input: {attempt.doubt}")
    location, anchors = token
    residual = after(judge.machine.residual(location), [now // 2 - anchor for anchor in anchors])
    owed = judge.compiled.words.owed(residual, anchors)
    doubt = f"; {attempt.doubt}" if attempt.doubt else ""
    reason = (
        f"{still_owed(owed, end)}{longer(judge, attempt, end)}{doubt}{unborn(judge, attempt, end)}"
    )
    alone = (_alone(judge.machine, worse), _alone(judge.machine, better))
    return Explanation(reason, owed, deadline=earlier(attempt, *alone))


def _by_now(judge: MachineJudge, attempt: Open, t: int) -> Iterator[Token]:
    """The tokens of both runs before the position `t`: they are taken on only when that is due."""
    better = attempt.better or attempt.token
    for token, letter in ((attempt.token, judge.letter), (better, judge.other)):
        if token[0] > PASSED:
            yield just_before(judge.machine, token, letter, judge.position, t, judge.flow.gap)
        else:
            yield token


def _alone(machine: Machine, token: Token) -> tuple[int, bool] | None:
    """What time alone makes of a run, and the last instant before that."""
    return settled_alone(machine.residual(token[0]), token[1]) if token[0] > PASSED else None
