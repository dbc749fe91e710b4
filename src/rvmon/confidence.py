"""Confidence intervals for a share of which a sample was counted."""

from __future__ import annotations

from functools import cache
from math import ceil, exp, floor, lgamma, log, log1p

CONFIDENCE = 0.95
"""The confidence of the intervals in tables."""

_HALVINGS = 60
"""Steps of bisection; each halves the interval, so 60 exhaust the precision of a double."""


@cache
def interval(count: int, runs: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """The exact interval of Clopper and Pearson for a binomial share.

    Whatever the true share is, at least `confidence` of all samples give an interval that contains
    it, provided that the runs are independent. The cost is about 120 times `runs` operations.

    Args:
        count: runs of the sample that have the property.
        runs: runs in the sample, at least 1.
        confidence: above 0, below 1.

    Source: Clopper and Pearson, The Use of Confidence or Fiducial Limits Illustrated in the Case of
    the Binomial, Biometrika 26(4), 1934.

    >>> [round(bound, 4) for bound in interval(0, 100)]
    [0.0, 0.0362]
    >>> [round(bound, 4) for bound in interval(9, 20, 0.9)]
    [0.2587, 0.6531]
    """
    tail = (1 - confidence) / 2
    low = 0.0 if count == 0 else _bound(count, runs, tail)
    high = 1.0 if count == runs else 1 - _bound(runs - count, runs, tail)
    return low, high


def interval_text(count: int, runs: int) -> str:
    """The interval in percent, rounded outwards; empty if there are no runs.

    >>> interval_text(0, 100), interval_text(33, 100), interval_text(4, 4), interval_text(0, 0)
    ('0–4', '23–44', '39–100', '')
    """
    if not runs:
        return ""
    low, high = interval(count, runs)
    return f"{floor(100 * low)}–{ceil(100 * high)}"


def _bound(count: int, runs: int, tail: float) -> float:
    """The share at which `count` or more of `runs` runs have the probability `tail`."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if _at_least(count, runs, middle) < tail:
            low = middle
        else:
            high = middle
    return low


def _at_least(count: int, runs: int, share: float) -> float:
    """The probability of `count` or more of `runs` runs; `count` is at least 1."""
    choices = lgamma(runs + 1) - lgamma(count + 1) - lgamma(runs - count + 1)
    first = exp(choices + count * log(share) + (runs - count) * log1p(-share))
    odds = share / (1 - share)
    total = term = 1.0
    for taken in range(count, runs):  # each term relative to the first; they rise, then fall
        term *= (runs - taken) / (taken + 1) * odds
        total += term
    # `first` may underflow to 0 and `total` overflow to ∞. Their product NaN is not below the
    # tail, and neither is the true probability, which is near 1 then.
    return first * total
