"""Does a requirement hold in so many runs? A campaign decides it, with errors that are stated."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, log

from rvmon.language.checked.specification import RunShare
from rvmon.verdicts import Verdict

ALPHA = 0.05
"""The greatest probability that a true share is rejected."""

BETA = 0.05
"""The greatest probability that a false share is accepted."""

HALF_WIDTH = 0.05
"""Half the width of the region of indifference; less where the share is close to 0 or 1."""


@dataclass(frozen=True, slots=True)
class Decision:
    """The decision of the tests of a strategy on a share of runs."""

    share: RunShare  # the share in question
    holds: bool | None  # whether it was accepted or rejected; `None`: there were too few tests
    tests: int  # the number of triggered ones taken until then
    inconclusive: int  # the number of these that were
    passed: int  # the number of these that did
    missing: int  # the least number of further tests, if all of them pass; 0 if it is decided
    # shares between which nothing is promised; if the true one is outside of them, it is rejected
    # wrongly with a probability of at most `ALPHA`, and accepted wrongly with one of at most `BETA`
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
    """Take tests one by one until the share is accepted or rejected: Wald's sequential test.

    A test that was not triggered says nothing. One that is inconclusive counts as failed for what
    its pass would favour, and as passed for what its failure would: the errors are kept however it
    would have ended. The limits are those that keep them whenever one stops, 1/α and β.

    The share is above 0 and below 1; the tests are drawn independently, in the order of the plan.

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
    # Logarithms of likelihoods, if what is inconclusive had gone well, or ill.
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
    """The error probabilities of a decision, in a sentence.

    >>> errors_text(decide(RunShare(at_least=True, percent=95.0), []))
    'wrong with a probability of 5 % at most, unless the true share is between 92.5 and 97.5 %'
    """
    low, high = (f"{100 * bound:.4g}" for bound in decision.indifference)
    most = f"{100 * max(ALPHA, BETA):g}"
    return (
        f"wrong with a probability of {most} % at most, unless the true share is between "
        f"{low} and {high} %"
    )
