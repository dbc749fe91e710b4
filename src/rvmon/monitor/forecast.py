"""What an open attempt can still become."""

from __future__ import annotations

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.monitor.bench import Open
from rvmon.monitor.judge import Judge
from rvmon.verdict.verdict import Verdict


def forecast_of(judge: Judge, attempt: Open) -> Verdict | None:
    """`P` or `F` if every continuation brings an attempt to it; never folded into its verdict.

    What was unknown stays so: `P` if the run that takes it for the worse passes anyway, `F` if the
    one that takes it for the better fails.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    if _value(judge, attempt.token) is True:
        return Verdict.PASS
    better = attempt.token if attempt.better is None else attempt.better
    return Verdict.FAIL if _value(judge, better) is False else None


def _value(judge: Judge, token: Token) -> bool | None:
    location, anchors = token
    if location <= PASSED:
        return location != FAILED
    ages = [judge.position - anchor for anchor in anchors]
    forecaster = judge.compiled.forecaster
    return forecaster.of(judge.machine.residual(location), ages, judge.flow.gap)
