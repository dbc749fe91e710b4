"""Where random choices come from: `random.Random`, or Hypothesis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

T = TypeVar("T")


class Rng(Protocol):
    """A source of integers; `random.Random` is one."""

    def randint(self, a: int, b: int, /) -> int:
        """An integer from `a` to `b`, both included; the least is the simplest."""


def chance(rng: Rng, percent: int) -> bool:
    """True in so many cases of a hundred; false is the simpler."""
    return rng.randint(1, 100) > 100 - percent


def pick(rng: Rng, options: Sequence[T]) -> T:
    """One of the options, each as likely; the first is the simplest."""
    return options[rng.randint(0, len(options) - 1)]


def weighted(rng: Rng, options: Sequence[tuple[int, T]]) -> T:
    """One of the options, as likely as its weight says; the first is the simplest."""
    rest = rng.randint(0, sum(weight for weight, _ in options) - 1)
    for weight, option in options:
        if rest < weight:
            return option
        rest -= weight
    raise AssertionError("the weights add up")
