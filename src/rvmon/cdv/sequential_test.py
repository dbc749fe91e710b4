"""A sequential test of whether a requirement holds in a given share of runs, with known errors."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, log

from rvmon.language.checked.specification import RunShare
from rvmon.verdicts import Verdict

ALPHA = 0.05
"""The largest probability of rejecting a share that holds."""

BETA = 0.05
"""The largest probability of accepting a share that does not hold."""

HALF_WIDTH = 0.05
"""Half the width of the indifference region; smaller if the share is close to 0 or 1."""


@dataclass(frozen=True, slots=True)
class Decision:
    """The decision on a share of runs, by the tests of a strategy."""

    share: RunShare  # the share in question
    holds: bool | None  # accepted or rejected; `None`: there were too few tests to decide
    tests: int  # triggered tests up to the decision
    inconclusive: int  # how many of these were inconclusive
    passed: int  # how many of these passed
    # The least number of further tests for acceptance, if all go well; 0 if it is decided.
    missing: int
    # The indifference region. If the true share lies outside of it, a wrong rejection has a
    # probability of at most `ALPHA`, and a wrong acceptance of at most `BETA`.
    indifference: tuple[float, float]

    def __str__(self) -> str:
        taken = f"{self.passed} of {self.tests} triggered tests passed"
        if self.inconclusive:
            taken += f", {self.inconclusive} inconclusive"
        if self.holds is None:
            go_well = "pass" if self.share.at_least else "fail"
            return f"undecided ({taken}): {self.missing} more tests at least, if all {go_well}"
        return f"{'holds' if self.holds else 'does not hold'} ({taken} up to the decision)"


def decide(share: RunShare, verdicts: Iterable[Verdict]) -> Decision:
    """Decide on a share by Wald's sequential probability ratio test, taking verdicts one by one.

    Tests that were not triggered are ignored. For acceptance, an inconclusive verdict counts as the
    unfavourable outcome, and for rejection as the favourable one, so the error bounds hold however
    the test would have ended. The limits of the likelihood ratio are 1/α and β, which keep the
    bounds whenever the test stops.

    The share must be above 0 and below 1, and the tests be drawn independently.

    Source: Wald, Sequential Tests of Statistical Hypotheses, Annals of Mathematical Statistics
    16(2), 1945, sections 3 and 5.3.

    >>> limit = RunShare(at_least=True, percent=95.0)
    >>> print(decide(limit, [Verdict.PASS] * 100))
    holds (57 of 57 triggered tests passed up to the decision)
    >>> print(decide(limit, [Verdict.PASS] * 20 + [Verdict.NOT_TRIGGERED] * 80))
    undecided (20 of 20 triggered tests passed): 37 more tests at least, if all pass
    """
    wanted = share.percent / 100
    half = min(HALF_WIDTH, wanted / 2, (1 - wanted) / 2)
    low, high = wanted - half, wanted + half
    good, bad = (high, low) if share.at_least else (low, high)
    ratios = {Verdict.PASS: log(bad / good), Verdict.FAIL: log((1 - bad) / (1 - good))}
    best, worst = min(ratios.values()), max(ratios.values())
    # Log-likelihood ratios of "does not hold" to "holds", as if each inconclusive test had gone
    # well, or badly. The share is accepted by the latter and rejected by the former.
    favourable = unfavourable = 0.0
    tests = inconclusive = passed = 0
    holds = None
    for verdict in verdicts:
        if verdict is Verdict.NOT_TRIGGERED:
            continue
        tests += 1
        passed += verdict is Verdict.PASS
        inconclusive += verdict is Verdict.INCONCLUSIVE
        favourable += ratios.get(verdict, best)
        unfavourable += ratios.get(verdict, worst)
        if unfavourable <= log(BETA) or favourable >= -log(ALPHA):
            holds = unfavourable <= log(BETA)
            break
    missing = ceil((log(BETA) - unfavourable) / best) if holds is None else 0
    return Decision(share, holds, tests, inconclusive, passed, missing, (low, high))


def errors_text(decision: Decision) -> str:
    """The error probability of a decision, in words.

    >>> errors_text(decide(RunShare(at_least=True, percent=95.0), []))
    'wrong with a probability of 5 % at most, unless the true share is between 92.5 and 97.5 %'
    """
    low, high = (f"{100 * bound:.4g}" for bound in decision.indifference)
    most = f"{100 * max(ALPHA, BETA):g}"
    return (
        f"wrong with a probability of {most} % at most, unless the true share is between "
        f"{low} and {high} %"
    )
