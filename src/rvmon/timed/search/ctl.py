"""Sets of valuations that satisfy nested formulas, worked out backwards.

`E<>` inside other operators is decided state by state: the valuations from which a formula can be
reached are found by going back from it through delays and moves until nothing is new, as unions of
zones. `A[] p` is the complement of `E<> not p`. Going back, zones have no larger numbers than the
network, so there are finitely many.

Source: Henzinger, Nicollin, Sifakis, Yovine, Symbolic Model Checking for Real-Time Systems, 1994;
Bouyer et al., Model Checking Real-Time Systems, 2018, section 3 (backward analysis ends).
"""

from __future__ import annotations

from collections import deque
from math import inf

from rvmon.timed.model.expressions import BinaryOperation, Expression, PathFormula
from rvmon.timed.model.guards import normal_form
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.search.meter import Meter
from rvmon.timed.zones.dbm import Zone, cut, is_within, normalise
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.federation import before, constraint_of, subtract_all, universe
from rvmon.timed.zones.successors import Space
from rvmon.timed.zones.zone_unions import (
    Constraint,
    ConstraintMaker,
    constraint_maker,
    has_paths,
    speaks_of_deadlock,
)

Federation = list[Zone]
"""The union of some normalised zones."""


def is_decidable(formula: Expression) -> bool:
    """Whether `Satisfaction` decides a normalised formula."""
    match formula:
        case BinaryOperation(_, left, right):
            return is_decidable(left) and is_decidable(right)
        case PathFormula(PathOp.POSSIBLY | PathOp.INVARIANTLY, body, None):
            return is_decidable(body)
        case PathFormula():
            return False
        case _:
            return not speaks_of_deadlock(formula)


class Satisfaction:
    """For each discrete state the valuations that satisfy a formula.

    Args:
        space: the discrete states; all that moves lead to, whatever the clocks say, are looked at.
        meter: counts the zones that are found.
    """

    def __init__(self, space: Space, meter: Meter) -> None:
        self._space = space
        self._dim = space.dim
        self._meter = meter
        self._into = _moves_into(space, meter)
        self._makers: dict[Expression, ConstraintMaker] = {}
        self._reaching: dict[Expression, dict[State, Federation]] = {}

    def of(self, formula: Expression, state: State) -> Federation:
        """The valuations of a state that satisfy its invariant and a decidable formula."""
        if not has_paths(formula):
            if formula not in self._makers:
                self._makers[formula] = constraint_maker(formula)
            constraints = self._makers[formula](state.vector.locations, state.values)
            return [
                zone
                for constraint in constraints
                if (zone := self._zone(state, constraint)) is not None
            ]
        match formula:
            case BinaryOperation(BinaryOp.AND, left, right):
                return self._both(self.of(left, state), self.of(right, state))
            case BinaryOperation(BinaryOp.OR, left, right):
                return [*self.of(left, state), *self.of(right, state)]
            case PathFormula(PathOp.POSSIBLY, body, None):
                return self._can_reach(body)[state]
            case PathFormula(PathOp.INVARIANTLY, body, None):
                bad = self._can_reach(normal_form(body, positive=False))[state]
                everything = self._zone(state, ())
                return [] if everything is None else subtract_all([everything], bad, self._dim)
            case _:
                raise AssertionError(f"{formula} is not decided here")

    def _zone(self, state: State, constraint: Constraint) -> Zone | None:
        zone = universe(self._dim)
        invariant = [(0, clock, bound) for clock, bound in state.invariant]
        return normalise(zone) if cut(zone, self._dim, (*invariant, *constraint)) else None

    def _both(self, left: Federation, right: Federation) -> Federation:
        return [
            normalise(zone)
            for one in left
            for other in right
            if cut(zone := one[:], self._dim, constraint_of(other, self._dim))
        ]

    def _can_reach(self, body: Expression) -> dict[State, Federation]:
        """The valuations of each state from which a formula can be reached."""
        if body in self._reaching:
            return self._reaching[body]
        found: dict[State, Federation] = {state: [] for state in self._into}
        waiting: deque[tuple[State, Zone]] = deque()

        def note(state: State, zone: Zone) -> None:
            earlier = before(zone, self._dim) if state.delays else normalise(zone)
            zones = found[state]
            if not any(is_within(earlier, known) for known in zones):
                zones[:] = [known for known in zones if not is_within(known, earlier)]
                zones.append(earlier)
                waiting.append((state, earlier))
                self._meter.count(len(waiting))

        for state in self._into:
            for zone in self.of(body, state):
                note(state, zone)
        while waiting and not self._meter.stopped:
            target, zone = waiting.popleft()
            for state, move in self._into[target]:
                earlier = _before_move(state, move, zone, self._dim)
                if earlier is not None:
                    note(state, earlier)
        self._reaching[body] = found
        return found


def _moves_into(space: Space, meter: Meter) -> dict[State, list[tuple[State, Move]]]:
    """For each discrete state the moves that lead to it, with their sources."""
    start = space.initial()
    assert start is not None  # noqa: S101 - the network can start
    into: dict[State, list[tuple[State, Move]]] = {start: []}
    waiting = [start]
    while waiting and meter.count(len(waiting)):
        state = waiting.pop()
        for move in space.moves(state):
            if move.failure is not None:
                continue
            if move.target not in into:
                into[move.target] = []
                waiting.append(move.target)
            into[move.target].append((state, move))
    return into


def _before_move(state: State, move: Move, zone: Zone, dim: int) -> Zone | None:
    """The valuations of a state from which a move leads into a zone of its target."""
    earlier = zone[:]
    for clock, value in move.resets:
        if not cut(earlier, dim, [(0, clock, value), (clock, 0, -value)]):
            return None
        _release(earlier, dim, clock)
    invariant = [(0, clock, bound) for clock, bound in state.invariant]
    return normalise(earlier) if cut(earlier, dim, (*move.guard, *invariant)) else None


def _release(zone: Zone, dim: int, clock: int) -> None:
    """Let a clock have any value, in place."""
    base = clock * dim
    zone[base : base + dim] = zone[0:dim]
    zone[clock::dim] = [inf] * dim
    zone[base] = zone[base + clock] = 0.0
