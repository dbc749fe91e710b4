"""The steps of a network on symbolic states: a discrete state, a zone closed under delays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rvmon.diagnostics import Label
from rvmon.timed.model.network import Network
from rvmon.timed.model.rules import model_error
from rvmon.timed.zones.dbm import Zone, constrain, delay_within, normalise, reset, zero
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.successors import Space


class Steps:
    """Where runs start and how they go on.

    Args:
        network: where they run.
        observers: number of further clocks.
        uppers: upper bounds of those, as `zones.cover_test` takes them.
        lowers: their lower bounds, likewise.
    """

    def __init__(
        self,
        network: Network,
        observers: int = 0,
        uppers: Sequence[tuple[int, float]] = (),
        lowers: Sequence[tuple[int, float]] = (),
    ) -> None:
        self.space = Space(network, observers, uppers, lowers)
        self.dim = self.space.dim

    def start(self) -> Iterator[tuple[State, Zone]]:
        """The initial state with all delays; nothing if its invariant is broken from the start."""
        state = self.space.initial()
        if state is not None:
            zone = zero(self.dim)
            if settle_in(state, zone, self.dim):
                yield state, normalise(zone)

    def successors(self, state: State, zone: Zone) -> Iterator[tuple[Move, State, Zone]]:
        """All moves that some valuation of the zone can take, and what is behind them."""
        for move in self.space.moves(state):
            fresh = fire(move, zone, self.dim)
            if fresh is not None and settle_in(move.target, fresh, self.dim):
                yield move, move.target, normalise(fresh)


def check_start(network: Network) -> None:
    """Refuse a network that has no initial state.

    Raises:
        ModelError: an invariant forbids it.
    """
    state = Space(network).initial()
    if state is None or any(bound < 0 for _, bound in state.invariant):
        places = [a.locations[a.initial] for a in network.automata]
        spans = [place.span for place in places if place.span is not None]
        span, others = (spans[0] if spans else None), [Label(other) for other in spans[1:]]
        message = "an invariant of the initial locations is false at time 0"
        fix = "weaken it, or start elsewhere"
        raise model_error("TA014", message, span, fix, others=others)


def check_clocks(network: Network, asked: Iterable[int] = ()) -> None:
    """Refuse to decide what depends on clocks that stop, or run at other rates.

    Args:
        network: of the clocks.
        asked: those that a query speaks of.

    Raises:
        ModelError: such a clock is compared. Source: Henzinger, Kopke, Puri, Varaiya, What's
            Decidable about Hybrid Automata, 1998 (one stop-watch makes reaching undecidable).
    """
    if next(network.rates, None) is None:
        return
    guards = [
        *(place.invariant for a in network.automata for place in a.locations),
        *(edge.guard for a in network.automata for edge in a.edges),
    ]
    compared = {one.clock for guard in guards for one in guard.clocks} | set(asked)
    found = [(p, r) for p, r in network.rates if r.clock in compared or network.has_split_edges]
    if found:
        place, rate = found[0]
        message = (
            f"`{network.clocks[rate.clock].name}` stops or changes its rate and is compared "
            f"({len(found)} places): what such clocks can reach is not decidable"
        )
        fix = "ask for figures, which are simulated: Pr[<=T](<> p), E[<=T; n](max: e)"
        raise model_error("TA016", message, place.span, fix)


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
