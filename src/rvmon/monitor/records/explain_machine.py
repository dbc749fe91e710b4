"""Why an attempt was decided that the judge of a machine has, and where its runs stand by now."""

from __future__ import annotations

from rvmon.automaton.location import PASSED, Token
from rvmon.automaton.machine import Machine
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.explained.explanation import Explanation
from rvmon.monitor.explained.findings import Reasons
from rvmon.monitor.explained.machine import MachineRuns, explained
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


def runs_of(judge: MachineJudge) -> MachineRuns:
    """What judges the attempts of a judge."""
    return MachineRuns(judge.machine, judge.position, judge.flow.gap)


def tokens_by_now(judge: MachineJudge, attempt: Open, now: int) -> tuple[Token, Token]:
    """The tokens of both runs before the next position: they are taken on only when that is due."""
    t = (now + 1) // 2

    def by_now(token: Token, letter: int) -> Token:
        if token[0] <= PASSED:
            return token
        return just_before(judge.machine, token, letter, judge.position, t, judge.flow.gap)

    better = attempt.better or attempt.token
    return by_now(attempt.token, judge.letter), by_now(better, judge.other)
