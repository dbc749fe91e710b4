"""Decides whether some infinite continuation of a trace satisfies a residual.

A clause of a residual is a state of a nondeterministic automaton: a step takes it to any clause of
what it becomes, under letters that the clause's literals allow. A path is accepting if no unbounded
`U` is put off for ever.

Source: generalised Büchi acceptance after Gerth, Peled, Vardi and Wolper 1995; strongly connected
components for emptiness, after Couvreur 1999.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.logic.automaton import location_of, normalise
from rvmon.logic.clock_regions import (
    NEVER,
    Ages,
    Cuts,
    after,
    bounds,
    chosen,
    exactly,
    joined,
    region_bounds,
    regions_between,
    widened,
    within,
)
from rvmon.logic.formula import Literal, Sense, Until
from rvmon.logic.progress import step
from rvmon.logic.residual import NO_CLOCK, Clause, Residual, TooManyClausesError
from rvmon.logic.state_formula import Elapsed, State

MOST_TRIED = 200
"""Steps of states, and combinations of regions in which they might be made."""

_MOST_APART = 100
"""The same, where clocks are known by their differences: that tells more states apart."""

_FEW_ATOMS = 8
"""A step of a clause of `n` times as many costs `n` squared small ones more, and counts as such."""

MOST_CLAUSES = 100
"""Of one step of a clause."""


class TooLargeError(Exception):
    """The search outgrew its limits."""


@dataclass(frozen=True, slots=True)
class _State:
    """A state of the search: one clause of a residual, with a zone of its clock ages.

    Ages are counted in the ticks between two positions where these are always as many.
    """

    residual: Residual
    ages: Ages


@dataclass(frozen=True, slots=True)
class _Move:
    """An edge of the search; `fair` if the oldest clock is not kept in a bounded region."""

    source: int
    target: int
    fair: bool


Start = tuple[_State, ...]
"""The clauses of a residual, of which one is to be satisfied."""


def start_of(residual: Residual, ages: Sequence[int], gap: int | None) -> Start | None:
    """The start state of a search, the same for residuals with the same future; `None` if true.

    Args:
        residual: of literals of two senses, as `rvmon.logic.progress` makes them.
        ages: of its clocks at the last position, ticks.
        gap: ticks between two positions; `None` if any number of ticks may lie between them.
    """
    if any(not clause for clause in residual):
        return None
    search = _Search(gap, differences=True)
    known = exactly([age // search.unit for age in ages])
    return tuple(search.state(clause, known) for clause in residual)


def is_satisfiable(start: Start, gap: int | None) -> bool:
    """Whether some infinite continuation satisfies one of these.

    In wide regions clocks are known by their differences only: so what is bounded may be called
    satisfiable though it is not; what is called unsatisfiable is.

    Args:
        start: as `start_of` gives it.
        gap: as for that.

    Raises:
        TooLargeError: the search takes too many steps.
    """
    try:
        return _Search(gap, differences=True).run(start)
    except TooLargeError:
        return _Search(gap, differences=False).run(start)


class _Search:
    def __init__(self, gap: int | None, *, differences: bool) -> None:
        self.unit = gap or 1
        self.longest = NEVER if gap is None else 1
        self.differences = differences
        self.most = _MOST_APART if differences else MOST_TRIED
        self.index: dict[_State, int] = {}
        self.states: list[_State] = []
        self.tried = 0

    def run(self, start: Start) -> bool:
        for state in start:
            self.enter(state)
        moves: list[_Move] = []
        current = 0
        while current < len(self.states):
            for target, fair in self.successors(self.states[current]):
                if target is None:
                    return True
                moves.append(_Move(current, target, fair))
            current += 1
        return self.has_accepting_cycle(moves)

    def state(self, clause: Clause, ages: Ages) -> _State:
        """The state of a clause, the last clock being the one that `normalise` calls NOW."""
        made, sources = normalise(frozenset([clause]), len(ages) - 2)
        own = chosen(ages, sources)
        return _State(made, widened(own, self.cuts(made), differences=self.differences))

    def enter(self, state: _State) -> int:
        """The number of a state."""
        found = self.index.get(state)
        if found is None:
            found = self.index[state] = len(self.states)
            self.states.append(state)
        return found

    def cuts(self, residual: Residual) -> list[list[int]]:
        """The ages at which clocks enter their next region, in units."""
        return [[-(-cut // self.unit) for cut in own] for own in location_of(residual).cuts]

    def successors(self, state: _State) -> Iterator[tuple[int | None, bool]]:
        """The states after one position, `None` for what is satisfied; and whether it is fair."""
        cuts = self.cuts(state.residual)
        cost = sum((len(clause) // _FEW_ATOMS) ** 2 for clause in state.residual)
        for ages in self.ages_after(cuts, state.ages):
            self.tried += cost
            shown = [bounds(ages, clock)[0] for clock in range(len(cuts))]
            try:
                in_ticks = [age * self.unit for age in shown]
                reached = step(state.residual, in_ticks, _left_open, MOST_CLAUSES)
            except TooManyClausesError:
                raise TooLargeError from None
            waits = bool(cuts) and bisect_right(cuts[0], shown[0]) < len(cuts[0])
            for clause in reached:
                pending = _without_literals(clause)
                if pending is None:
                    continue
                if not pending:
                    yield None, True
                    return
                target = self.enter(self.state(pending, joined(ages)))
                oldest_stays = waits and any(clock == 0 for _, clock in pending)
                yield target, not oldest_stays

    def ages_after(self, cuts: Cuts, ages: Ages) -> Iterator[Ages]:
        """The zones at the next position, one per combination of regions."""
        later = after(ages, self.longest)
        spans = []
        for clock, own in enumerate(cuts):
            spans.append(regions_between(own, *bounds(later, clock)))
        for regions in product(*spans):
            self.tried += 1
            if self.tried > self.most:
                raise TooLargeError
            places = [region_bounds(own, at) for own, at in zip(cuts, regions, strict=True)]
            found = within(later, places)
            if found is not None:
                yield found

    def has_accepting_cycle(self, moves: Sequence[_Move]) -> bool:
        """Whether some cycle postpones no `U` for ever."""
        promised = [_promises(state) for state in self.states]
        if any(m.fair and m.source == m.target and not promised[m.target] for m in moves):
            return True
        import networkx as nx

        graph = nx.DiGraph()
        graph.add_edges_from((move.source, move.target) for move in moves)
        component = {
            state: number
            for number, found in enumerate(nx.strongly_connected_components(graph))
            for state in found
        }
        kept: dict[int, frozenset[Until]] = {}
        fair: set[int] = set()
        for move in moves:
            number = component[move.source]
            if number != component[move.target]:
                continue
            own = promised[move.target]
            kept[number] = kept.get(number, own) & own
            if move.fair:
                fair.add(number)
        return any(not kept[number] for number in fair)


def _left_open(literal: Literal) -> Residual:
    return frozenset([frozenset([(literal, NO_CLOCK)])])


def _without_literals(clause: Clause) -> Clause | None:
    """What a clause owes later; `None` if no letter satisfies its literals.

    All that comes is there: nothing is lost of what is still possible.
    """
    seen: dict[State, Sense] = {}
    pending = []
    for node, clock in clause:
        if not isinstance(node, Literal):
            pending.append((node, clock))
            continue
        is_blank = node.proposition.leaf == Elapsed(0) and node.sense is not Sense.TRUE
        if is_blank or seen.setdefault(node.proposition, node.sense) is not node.sense:
            return None
    return frozenset(pending)


def _promises(state: _State) -> frozenset[Until]:
    """The unbounded `U` that a state postpones."""
    return frozenset(
        node
        for clause in state.residual
        for node, clock in clause
        if isinstance(node, Until) and clock == NO_CLOCK
    )
