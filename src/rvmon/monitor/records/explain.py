"""Why an attempt was decided or is open, by the kind of its judge."""

from __future__ import annotations

from rvmon.automaton.location import Token
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.explained.explanation import Explanation, unborn_of
from rvmon.monitor.explained.undecided import Judged, Undecided
from rvmon.monitor.records.explain_machine import explain_decision, runs_of, tokens_by_now
from rvmon.monitor.records.explain_network import networks_of


def why_decided(
    judge: AttemptJudge, attempt: Open, verdict: bool, t: int, before: Token
) -> Explanation:
    """Why an attempt was decided at `t`; see `Clerk.decided`."""
    match judge:
        case MachineJudge():
            return explain_decision(judge, attempt, verdict, t, before)
        case _:
            raise TypeError(f"no explanation for {type(judge).__name__}")


def undecided(judge: AttemptJudge, attempt: Open, now: int) -> tuple[Judged, Undecided]:
    """An undecided attempt and what judges it, as they stand.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
    """
    judged: Judged
    match judge:
        case NetworkJudge():
            judged = networks_of(judge, now)
            worse, better = attempt.token, attempt.better or attempt.token
        case MachineJudge():
            judged = runs_of(judge)
            worse, better = tokens_by_now(judge, attempt, now)
        case _:
            raise TypeError(f"no explanation for {type(judge).__name__}")
    reads, doubt = judge.flow.graph.reads, attempt.doubt
    names = {name for place, _ in judge.leaves for name in reads[place].names}
    return judged, Undecided(
        judge.compiled,
        attempt.triggered,
        worse,
        better,
        doubt,
        unborn_of(names, judge.flow.outages, doubt),
        attempt.sure,
        attempt.void,
        judge.flow.is_cut,
    )
