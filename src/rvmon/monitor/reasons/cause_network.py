"""Which part of what was owed decided an attempt, by what a network knows."""

from __future__ import annotations

from typing import assert_never

from rvmon.dataflow.network import Network
from rvmon.dataflow.piecewise import FAR
from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Since,
    Until,
)
from rvmon.monitor.reasons.cause import Cause


class NetworkCauseFinder:
    """Looks for the cause of a decision, while what it brought is fresh.

    What decided became known at the very stamp of the decision, and so did all between it and the
    formula.
    """

    def __init__(self, network: Network, verdict: bool, at: int) -> None:
        self.network = network
        self.verdict = verdict
        self.at = at
        self.gap = network.positions.gap

    def of(self, core: Core, position: int) -> Cause | None:
        """The cause of a formula's value at a position; `None` if it is constant."""
        match core:
            case Constant():
                return None
            case Literal():
                return Cause(core, position * self.gap, False, core)
            case And(args=args) | Or(args=args):
                # What is owed over time says more than what was only asked for besides.
                parts = sorted(args, key=lambda arg: isinstance(arg, Literal))
                causes = (self.of(arg, position) for arg in parts if self._fresh(arg, position))
                return next((cause for cause in causes if cause is not None), None)
            case Next(operand=operand):
                return self._within(operand, position + 1, FAR)
            case Previous(operand=operand):
                return self._within(operand, -FAR, position - 1)
            case Until() | Release():
                return self._ahead(core, position)
            case Since(left=left, right=right, low=low, high=high):
                last = position - -(-low // self.gap)
                first = -FAR if high is None else position - high // self.gap
                return self._within(right, first, last) or self._within(left, -FAR, position)
            case _:
                assert_never(core)

    def _ahead(self, core: Until | Release, position: int) -> Cause | None:
        start = position * self.gap
        first = position - (-core.low // self.gap)
        last = FAR if core.high is None else position + core.high // self.gap
        if isinstance(core, Until) is self.verdict:
            return self._of_part(core, core.right, first, last, start)
        if core.high is not None and self.at == 2 * (start + core.high + 1):
            return Cause(core, start, True, None)
        if self._when(core.left, position, FAR) is not None:
            return self._of_part(core, core.left, position, FAR, start)
        return self._of_part(core, core.right, first, last, start)

    def _of_part(
        self, core: Until | Release, part: Core, first: int, last: int, start: int
    ) -> Cause:
        """What one operand has to do with the value of an operator that began at `start`."""
        if isinstance(part, Literal):
            return Cause(core, start, False, part)
        return self._within(part, first, last) or Cause(core, start, False, None)

    def _within(self, core: Core, first: int, last: int) -> Cause | None:
        """The cause at the first position of a window that brought the decision."""
        position = self._when(core, first, last)
        return None if position is None else self.of(core, position)

    def _fresh(self, core: Core, position: int) -> bool:
        return self._when(core, position, position) is not None

    def _when(self, core: Core, first: int, last: int) -> int | None:
        """The first position at which a formula got the decision's value at its stamp."""
        if isinstance(core, Constant):
            return None
        positions = self.network.positions
        for left, right, at, slope in self.network.known_of(core)[not self.verdict]:
            low, high = max(left, first), min(right, last)
            if low > high:
                continue
            found, rest = low, 0
            if slope:
                found, rest = divmod(self.at - at, slope)
            elif at != self.at:
                continue
            elif low > -FAR:
                found = positions.following(low)
            is_met = low <= found <= min(high, positions.last) and not rest
            if is_met and found == positions.following(found):
                return found if found > -FAR else None
        return None
