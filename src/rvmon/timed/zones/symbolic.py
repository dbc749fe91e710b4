"""The steps of a network on symbolic states: a discrete state, a zone closed under delays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rvmon.timed.model.expressions import Expression
from rvmon.timed.model.network import Network
from rvmon.timed.zones.dbm import Zone, constrain, cut, delay_within, normalise, reset, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.successors import Space
from rvmon.timed.zones.zone_unions import Constraint, formula_bounds, has_strict_bounds


class Steps:
    """Where runs start and how they go on.

    Args:
        network: where they run.
        formula: normalised; what it compares clocks with counts everywhere.
        observers: number of further clocks.
        uppers: upper bounds of those, as `zones.cover_test` takes them.
        lowers: their lower bounds, likewise.
    """

    def __init__(
        self,
        network: Network,
        formula: Expression,
        observers: int = 0,
        uppers: Sequence[tuple[int, float]] = (),
        lowers: Sequence[tuple[int, float]] = (),
    ) -> None:
        bounds = formula_bounds(formula, network)
        self.space = Space(network, bounds, observers, uppers, lowers)
        self.dim = self.space.dim
        # Without strict bounds no zone ever needs to be tidied.
        self._strict = has_strict_bounds(network, formula)

    def start(self) -> Iterator[tuple[State, Zone]]:
        """The initial state with all delays; nothing if its invariant is broken from the start."""
        state = self.space.initial()
        if state is not None:
            zone = zero(self.dim)
            if settle_in(state, zone, self.dim):
                yield state, normalise(zone)

    def successors(self, state: State, zone: Zone) -> Iterator[tuple[Move, State, Zone]]:
        """All moves that some valuation of the zone can take, and what is behind them."""
        dim, strict = self.dim, self._strict
        for move in self.space.moves(state):
            fresh = fire(move, zone, dim)
            if fresh is not None and settle_in(move.target, fresh, dim):
                yield move, move.target, normalise(fresh) if strict else fresh


def fire(move: Move, zone: Zone, dim: int) -> Zone | None:
    """The valuations just after a move, before the target's invariant; `None` if there are none.

    Raises:
        ModelError: the move can be taken, but sets a variable outside its range.
    """
    fresh = zone[:]
    for x, y, bound in move.guard:
        if not constrain(fresh, dim, x, y, bound):
            return None
    if move.failure is not None:
        raise move.failure
    for clock, value in move.resets:
        reset(fresh, dim, clock, value)
    return fresh


def settle_in(state: State, zone: Zone, dim: int) -> bool:
    """Cut a zone to a state's invariant and let time pass if it may, in place.

    Returns:
        False if no valuation satisfies the invariant.
    """
    if state.delays:
        # Bounds are from above only: who breaks them before the delay does so after it.
        return delay_within(zone, dim, state.invariant)
    return all(constrain(zone, dim, 0, clock, bound) for clock, bound in state.invariant)


def meets(zone: Zone, dim: int, constraint: Constraint) -> bool:
    """Whether some valuation of a zone lies in a piece."""
    return not constraint or cut(zone[:], dim, constraint)
