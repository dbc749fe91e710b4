"""What is told of an attempt, by the kind of its judge."""

from __future__ import annotations

from rvmon.automaton.machine import Token
from rvmon.monitor.attempt_judge import AttemptJudge, Open
from rvmon.monitor.explain import Explanation, explain_decision, explain_open
from rvmon.monitor.explain_network import network_decision, network_open
from rvmon.monitor.forecast import forecast_by_network, forecast_of
from rvmon.monitor.judge import Judge
from rvmon.monitor.network_judge import NetworkJudge
from rvmon.verdict.verdict import Verdict


def why_decided(
    judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
) -> Explanation:
    """Why an attempt was decided at `t`; see `rvmon.monitor.attempt_judge.Clerk.decided`."""
    match judge:
        case NetworkJudge():
            return network_decision(judge, attempt, verdict, t)
        case Judge():
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
        case Judge():
            return explain_open(judge, attempt, now, end)
        case _:
            raise TypeError(f"no explanation for {type(judge).__name__}")


def outlook(judge: AttemptJudge, attempt: Open, now: int) -> Verdict | None:
    """What every continuation brings an open attempt to, where that can be said.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: as in `why_open`.
    """
    match judge:
        case NetworkJudge():
            return forecast_by_network(judge, attempt, now)
        case Judge():
            return forecast_of(judge, attempt, (now - 1) // 2)
        case _:
            raise TypeError(f"no forecast for {type(judge).__name__}")
