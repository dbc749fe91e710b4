"""What came of closing a campaign: data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.cdv.close.nearest import Goal
from rvmon.cdv.outcome import Played


@dataclass(frozen=True, slots=True)
class Added:
    """A test and what it was good for.

    Attributes:
        played: the test with its outcome.
        origin: how it was made, in words.
        goals: what was met with it for the first time.
        met: how many goals were met with it and those before.
    """

    played: Played
    origin: str
    goals: Sequence[Goal]
    met: int


@dataclass(frozen=True, slots=True)
class Closed:
    """A campaign whose holes were looked for.

    Attributes:
        tests: all that were played, in order.
        suite: of these the fewest known that meet as much, and all that did not go as they should.
        fewest: at least so many are needed; that of `suite` if it is known to be the smallest.
        goals: how many there are, without those that cannot be met.
        reasons: why others cannot be met, by goal.
        proved: how many of these the model proves.
        open: what no test met.
        wrong: goals that cannot be met, as it is said, and that a test met, with its name.
        seconds: that it took.
        ended: why it ended with open goals; empty if there is none.
    """

    tests: Sequence[Added]
    suite: Sequence[Played]
    fewest: int
    goals: int
    reasons: Mapping[Goal, str]
    proved: int
    open: Sequence[Goal]
    wrong: Mapping[Goal, str]
    seconds: float
    ended: str

    @property
    def met(self) -> int:
        """How many goals were met."""
        return self.goals - len(self.open)
