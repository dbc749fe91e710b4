"""The problem of reaching a state formula without `deadlock`."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.timed.discrete import Move, State
from rvmon.timed.model import Expression, Network
from rvmon.timed.pieces import (
    Piece,
    formula_bounds,
    has_strict_bounds,
    piece_maker,
)
from rvmon.timed.successors import Space
from rvmon.timed.zones import Zone, constrain, cut, delay_within, normalise, reset, zero


class Reachability:
    """Reach a state formula; sites are discrete states, links are moves.

    Args:
        network: where to look.
        formula: normalised.
        timer: whether an additional last clock measures the time since the start.
    """

    simulates = True

    def __init__(self, network: Network, formula: Expression, *, timer: bool = False) -> None:
        self.space = Space(network, formula_bounds(formula, network), int(timer))
        self.dim = self.space.dim
        self.strict = has_strict_bounds(network, formula)
        self._pieces = piece_maker(formula)
        self._goals: dict[State, list[Piece]] = {}

    def start(self) -> Iterator[tuple[State, Zone]]:
        """The initial state with all delays; nothing if its invariant is broken from the start."""
        state = self.space.initial()
        if state is not None:
            zone = zero(self.dim)
            if settle_in(state, zone, self.dim):
                yield state, normalise(zone)

    def successors(self, site: State, zone: Zone) -> Iterator[tuple[Move, State, Zone]]:
        """All moves that some valuation of the zone can take."""
        dim, strict = self.dim, self.strict
        for move in self.space.moves(site):
            fresh = fire(move, zone, dim)
            if fresh is not None and settle_in(move.target, fresh, dim):
                yield move, move.target, normalise(fresh) if strict else fresh

    def goal(self, site: State, zone: Zone) -> Piece | None:
        """The first piece of the formula that meets the zone."""
        pieces = self._goals.get(site)
        if pieces is None:
            pieces = self._goals[site] = self._pieces(site.vector.locations, site.values)
        return next((piece for piece in pieces if meets(zone, self.dim, piece)), None)


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


def meets(zone: Zone, dim: int, piece: Piece) -> bool:
    """Whether some valuation of a zone lies in a piece."""
    return not piece or cut(zone[:], dim, piece)
