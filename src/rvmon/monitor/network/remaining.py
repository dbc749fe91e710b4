"""The residual of an undecided formula, computed from the known values of a network.

The residual is that of progression (AUTOMATA 1) or a weaker one: the obligations of past operators,
and of positions beyond a limit, are left out. So if no continuation satisfies the residual, none
makes the formula true.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rvmon.logic import formula as mtl
from rvmon.logic.progress import Duals, opened
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Atom, Residual, both, either
from rvmon.monitor.network import Network
from rvmon.monitor.network.piecewise import FAR, unchanged_until

MOST_POSITIONS = 60  # the most undecided positions examined, over all subformulas together

MOST_CLAUSES = 60

_FEW = 8  # the most undecided positions of a stretch that are examined, besides the last


class Remaining:
    """Computes residuals of the formulas of a network, or of their negations.

    The residuals consist of formulas of `duals`, over known propositions.
    """

    def __init__(self, network: Network, duals: Duals) -> None:
        self.network = network
        self.duals = duals
        positions = network.positions
        self.gap = positions.gap
        known = positions.last if positions.sparse else (network.limit - 1) // positions.slope
        self.now = min(known, positions.last)
        self._examined = 0
        self._required: mtl.Core | None = None

    def of(self, core: mtl.Core, position: int, positive: bool) -> tuple[Residual, list[int]]:
        """A residual implied by a formula, or by its negation, at a position.

        Returns:
            The residual, and the ages of its clocks at the last position, ticks.

        Raises:
            TooManyClausesError: it may have more than `MOST_CLAUSES` clauses.
        """
        self._examined = 0
        self._required = core
        found = self._at(core, position, positive)
        anchors = sorted({c for clause in found for _, c in clause if c != NO_CLOCK})
        number = {anchor: clock for clock, anchor in enumerate(anchors)}
        number[NO_CLOCK] = NO_CLOCK
        residual = frozenset(
            frozenset((node, number[clock]) for node, clock in clause) for clause in found
        )
        return residual, [(self.now - anchor + _START) * self.gap for anchor in anchors]

    def _value(self, core: mtl.Core, position: int, positive: bool) -> bool | None:
        if isinstance(core, mtl.Constant):
            return core.value is positive
        found = self.network.value_at(core, position)
        return None if found is None else found is positive

    def _at(self, core: mtl.Core, position: int, positive: bool) -> Residual:
        """The residual; a clock is the position where it was started, offset by `_START`."""
        value = self._value(core, position, positive)
        if value is not None:
            return HOLDS if value else FAILS
        before_letters = position < self.network.start and core is not self._required
        if before_letters or self._examined > MOST_POSITIONS:
            return HOLDS
        match core:
            case mtl.Constant() | mtl.Literal() | mtl.Previous() | mtl.Since():
                return HOLDS
            case mtl.And(args=args) | mtl.Or(args=args):
                every = isinstance(core, mtl.And) is positive
                found = HOLDS if every else FAILS
                for arg in args:
                    own = self._at(arg, position, positive)
                    found = _both(found, own) if every else either(found, own)
                return found
            case mtl.Next(operand=operand):
                following = self.network.positions.following(position + 1)
                if following <= self.now:
                    return self._at(operand, following, positive)
                return self._atom(core, NO_CLOCK, positive)
            case mtl.Until() | mtl.Release() if isinstance(core, mtl.Until) is positive:
                return self._some(core, position, positive)
            case mtl.Until() | mtl.Release():
                return self._every(core, position, positive)
            case _:
                assert_never(core)

    def _some(self, core: mtl.Until | mtl.Release, position: int, positive: bool) -> Residual:
        """Existential reading: right holds at some position of the window, and left up to it."""
        found, way = FAILS, HOLDS
        for k, _, right_left_out in self._open_positions(core, position, positive):
            if self._is_in_window(core, position, k):
                own = self._at(core.right, k, positive)
                found = either(found, _both(way, own))
                if own == HOLDS or right_left_out:
                    return either(found, way)
            way = _both(way, self._at(core.left, k, positive))
            if way == FAILS:
                return found
        return either(found, _both(way, self._pending(core, position, positive)))

    def _every(self, core: mtl.Until | mtl.Release, position: int, positive: bool) -> Residual:
        """Universal reading: right holds at all positions of the window until left releases it."""
        found, release = HOLDS, FAILS
        for k, left_left_out, _ in self._open_positions(core, position, positive):
            if self._is_in_window(core, position, k):
                own = self._at(core.right, k, positive)
                found = _both(found, either(own, release))
                if own == FAILS:
                    return found
            release = either(release, self._at(core.left, k, positive))
            if release == HOLDS or left_left_out:
                return found
        return _both(found, either(release, self._pending(core, position, positive)))

    def _open_positions(
        self, core: mtl.Until | mtl.Release, position: int, positive: bool
    ) -> Iterator[tuple[int, bool, bool]]:
        """The positions up to now that matter; the others only pass the obligation on.

        Each comes with two flags: whether the left operand, and whether the right operand, is
        unknown at positions that are skipped after it.
        """
        some = isinstance(core, mtl.Until) is positive
        k = max(position, self.network.start)
        positions = self.network.positions
        last = self.now
        if core.high is not None:
            last = min(last, position + core.high // self.gap)
        opening = position + -(-core.low // self.gap)
        k = positions.following(k)
        while k <= last:
            left, right = (self._value(part, k, positive) for part in (core.left, core.right))
            inside = k >= opening
            end = last if inside else min(last, opening - 1)
            end = min(end, *(self._end(part, k) for part in (core.left, core.right)))
            if left is some and (not inside or (right is not some and right is not None)):
                k = positions.following(end + 1)
                continue
            for count in range(_FEW):
                following = positions.following(k + 1)
                if following > end or count < _FEW - 1:
                    yield k, False, False
                else:
                    yield k, left is None, right is None and inside
                    following = positions.within(k, end)[-1] if positions.sparse else end
                    yield following, False, False
                    following = positions.following(following + 1)
                self._examined += 1
                k = following
                if k > end:
                    break

    def _end(self, core: mtl.Core, position: int) -> int:
        """The last integer up to which as much is known of a formula as at `position`."""
        if isinstance(core, mtl.Constant):
            return FAR
        return unchanged_until(self.network.known_of(core), position)

    def _is_in_window(self, core: mtl.Until | mtl.Release, position: int, k: int) -> bool:
        age = (k - position) * self.gap
        return core.low <= age and (core.high is None or age <= core.high)

    def _pending(self, core: mtl.Until | mtl.Release, position: int, positive: bool) -> Residual:
        """The residual for positions to come: the operator, or a constant if its window is over."""
        if core.high is not None and (self.now + 1 - position) * self.gap > core.high:
            return FAILS if isinstance(core, mtl.Until) is positive else HOLDS
        return self._atom(core, position + _START, positive, (self.now - position) * self.gap)

    def _atom(self, core: mtl.Core, clock: int, positive: bool, age: int = 0) -> Residual:
        made = self.duals.of(core, positive)
        match made:
            case mtl.Next():
                atom: Atom = (made, clock)
            case mtl.Until(low=low) | mtl.Release(low=low):
                atom = opened(made, clock) if age >= low else (made, clock)
            case mtl.Constant(value=False):
                return FAILS
            case _:
                return HOLDS
        return frozenset([frozenset([atom])])


def _both(left: Residual, right: Residual) -> Residual:
    return both(left, right, MOST_CLAUSES)


_START = 1 << 100
"""Added to positions to make them clocks: positive, and smaller if older, as in residuals."""
