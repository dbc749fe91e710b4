"""Why an attempt was decided or is open, by the kind of its judge."""

from __future__ import annotations

from rvmon.automaton.machine import Token
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.records.explain_machine import explain_decision, explain_open
from rvmon.monitor.records.explain_network import network_open
from rvmon.monitor.records.explanation import Explanation


def why_decided(
    judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
) -> Explanation:
    """Why an attempt was decided at `t`; see `Clerk.decided`."""
    match judge:
        case MachineJudge():
            return explain_decision(judge, attempt, verdict, t, before)
        case _:
            raise TypeError(f"no explanation for {type(judge).__name__}")


def why_open(judge: AttemptJudge, attempt: Open, now: int, end: int | None = None) -> Explanation:
    """What an undecided attempt waits for.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
        end: the last instant of the trace, if it has ended.
    """
    match judge:
        case NetworkJudge():
            return network_open(judge, attempt, now, end)
        case MachineJudge():
            return explain_open(judge, attempt, now, end)
        case _:
            raise TypeError(f"no explanation for {type(judge).__name__}")
