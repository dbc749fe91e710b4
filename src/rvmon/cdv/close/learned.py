"""Which options of a choice have paid so far, and are taken more often for it."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Collection, Hashable, Iterable, Sequence
from typing import TypeVar

_Option = TypeVar("_Option", bound=Hashable)

Draw = tuple[str, Hashable]
"""A choice by its name, and the option that was taken."""


class Learned:
    """Weights of options, by choice: they grow with what tests of theirs brought.

    An option is drawn in proportion to the share of its tests that paid, each with one
    success and one failure beforehand, so that none is ever given up.

    Source: Thompson, On the Likelihood that One Unknown Probability Exceeds Another, Biometrika 25,
    1933 (options are drawn by what is known of them, here the mean of the posterior); Rubinstein,
    The Cross-Entropy Method for Combinatorial and Continuous Optimization, 1999 (and by what the
    best tests drew).
    """

    def __init__(self) -> None:
        self._tries: Counter[Draw] = Counter()
        self._gains: Counter[Draw] = Counter()

    def choose(
        self,
        rng: random.Random,
        choice: str,
        options: Sequence[_Option],
        drawn: list[Draw],
        near: Sequence[Collection[Draw]] = (),
    ) -> _Option:
        """Draw one of some options.

        Args:
            rng: draws.
            choice: its name.
            options: at least one; one that is named twice is as likely again.
            drawn: gets what was drawn.
            near: the draws of tests that came near to what is sought: theirs are likelier.
        """
        weights = [self._weight((choice, option), near) for option in options]
        found = rng.choices(options, weights)[0]
        drawn.append((choice, found))
        return found

    def _weight(self, draw: Draw, near: Sequence[Collection[Draw]]) -> float:
        share = (1 + self._gains[draw]) / (2 + self._tries[draw])
        return share + sum(draw in one for one in near) / max(1, len(near))

    def learn(self, drawn: Iterable[Draw], *, paid: bool) -> None:
        """Learn whether a test that was made by these draws has paid."""
        for draw in dict.fromkeys(drawn):
            self._tries[draw] += 1
            self._gains[draw] += paid
