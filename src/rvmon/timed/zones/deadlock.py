"""Where no edge can be taken, now or after any delay."""

from __future__ import annotations

from rvmon.diagnostics import Label
from rvmon.timed.model.expressions import TRUE
from rvmon.timed.model.network import Network
from rvmon.timed.model.rules import model_error
from rvmon.timed.zones.dbm import Zone, cut, normalise, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.federation import before, subtract_all, universe
from rvmon.timed.zones.successors import Space
from rvmon.timed.zones.symbolic import Steps, settle_in


class Deadlocks:
    """The valuations of each discrete state from which an edge can be taken, found once."""

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


def check_start(network: Network) -> None:
    """Refuse a network that has no initial state.

    Raises:
        ModelError: an invariant forbids it.
    """
    places = [a.locations[a.initial] for a in network.automata]
    spans = [place.span for place in places if place.span is not None]
    span, others = (spans[0] if spans else None), [Label(other) for other in spans[1:]]
    steps = Steps(network, TRUE)
    state = steps.space.initial()
    zone = zero(steps.dim)
    if state is None or not settle_in(state, zone, steps.dim):
        message = "an invariant of the initial locations is false at time 0"
        fix = "weaken it, or start elsewhere"
        raise model_error("TA014", message, span, fix, others=others)
