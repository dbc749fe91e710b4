"""What an open attempt can still become."""

from __future__ import annotations

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.dataflow.network import Network
from rvmon.dataflow.remaining import Remaining
from rvmon.formula.residual import TooManyClausesError
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.verdict.verdict import Verdict

MOST_ATTEMPTS = 32
"""With more of a requirement open at once in a network, none is forecast."""


def forecast_of(judge: AttemptJudge, attempt: Open, now: int) -> Verdict | None:
    """What every continuation brings an open attempt to, where that is known.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
    """
    match judge:
        case NetworkJudge():
            return _by_network(judge, attempt, now)
        case MachineJudge():
            return _by_machine(judge, attempt, (now - 1) // 2)
        case _:
            raise TypeError(f"no forecast for {type(judge).__name__}")


def _by_machine(judge: MachineJudge, attempt: Open, known: int) -> Verdict | None:
    """`P` or `F` if every continuation brings an attempt to it; never folded into its verdict.

    Args:
        judge: of the attempt.
        attempt: undecided.
        known: the last instant of which the letter is known, ticks.

    What was unknown stays so: `P` if the run that takes it for the worse passes anyway, `F` if the
    one that takes it for the better fails.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    if _value(judge, attempt.token, known) is True:
        return Verdict.PASS
    better = attempt.token if attempt.better is None else attempt.better
    return Verdict.FAIL if _value(judge, better, known) is False else None


def _value(judge: MachineJudge, token: Token, known: int) -> bool | None:
    location, anchors = token
    if location <= PASSED:
        return location != FAILED
    # Positions that change nothing are not visited.
    gap = judge.flow.gap
    ahead = max(known - judge.position, 0) // (gap or 1) * (gap or 1)
    ages = [judge.position + ahead - anchor for anchor in anchors]
    return judge.compiled.forecaster.of(judge.machine.residual(location), ages, gap)


def _by_network(judge: NetworkJudge, attempt: Open, now: int) -> Verdict | None:
    """The same of an attempt that a network judges; `None`, too, where too much is undecided.

    Each attempt costs a search of its own, so there is none with more than `MOST_ATTEMPTS` open.

    Args:
        judge: of the attempt.
        attempt: undecided.
        now: the stamp that time has come to.

    Source: as for `_by_machine`.
    """
    if len(judge.attempts) > MOST_ATTEMPTS:
        return None
    token = attempt.token
    better = token if attempt.better is None else attempt.better
    if token[0] > PASSED and not _may_become(judge, judge.worse, token, now, False):
        return Verdict.PASS
    network = judge.better or judge.worse
    if better[0] > PASSED and not _may_become(judge, network, better, now, True):
        return Verdict.FAIL
    return None


def _may_become(
    judge: NetworkJudge, network: Network | None, token: Token, now: int, value: bool
) -> bool:
    """Whether continuations may give an attempt a value in a network."""
    if network is None:
        return True
    compiled, gap = judge.compiled, judge.flow.gap
    remaining = Remaining(judge.moment(network, now).network, compiled.forecaster.duals)
    position = token[1][0] // network.positions.gap
    try:
        residual, ages = remaining.of(compiled.obligation.owed, position, value)
    except TooManyClausesError:
        return True
    return compiled.forecaster.admits(residual, ages, gap)
