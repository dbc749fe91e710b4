"""Where no edge can be taken, now or after any delay."""

from __future__ import annotations

from rvmon.timed.zones.abstraction import extrapolate, largest
from rvmon.timed.zones.dbm import Zone, cut, normalise
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.federation import before, subtract_all, universe
from rvmon.timed.zones.successors import Space


class Deadlocks:
    """The valuations of each discrete state from which an edge can be taken, found once.

    Args:
        space: the discrete states.
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        self._alive: dict[State, list[Zone]] = {}

    def alive(self, state: State) -> list[Zone]:
        """The valuations from which some edge can be taken, now or after a delay."""
        zones = self._alive.get(state)
        if zones is None:
            zones = self._alive[state] = [
                zone
                for move in self._space.moves(state)
                if (zone := _before_move(state, move, self._space.dim)) is not None
            ]
        return zones

    def dead(self, state: State, zone: Zone) -> list[Zone]:
        """The part of a zone from which no edge can ever be taken."""
        return subtract_all([zone], self.alive(state), self._space.dim)


def _before_move(state: State, move: Move, dim: int) -> Zone | None:
    """The valuations from which a move can be taken, after a delay if time may pass."""
    values = dict(move.resets)
    zone = universe(dim)
    if not cut(zone, dim, move.guard):
        return None
    if not cut(zone, dim, [(0, clock, bound) for clock, bound in state.invariant]):
        return None
    for clock, bound in move.target.invariant:
        if clock in values:
            if values[clock] > bound:
                return None
        elif not cut(zone, dim, [(0, clock, bound)]):
            return None
    return before(zone, dim) if state.delays else normalise(zone)


def is_time_bounded(state: State) -> bool:
    """Whether time cannot pass for ever in a state."""
    return not state.delays or bool(state.invariant)


def blurred(state: State, zone: Zone, dim: int) -> Zone:
    """A zone coarsened up to bisimulation, as the bounds of its state allow."""
    return extrapolate(zone, dim, largest(state.vector.bounds))
