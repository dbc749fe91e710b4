"""Forecasts: whether every, or no, continuation of a trace satisfies a residual (LTL3).

A clause of a residual is a state of a nondeterministic automaton: a step leads to any clause of its
progression whose literals some letter satisfies. A path is accepting if no unbounded `U` is
postponed for ever.

Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4), 2011;
generalised Büchi acceptance after Gerth, Peled, Vardi and Wolper 1995; strongly connected
components for emptiness, after Couvreur 1999.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Hashable, Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import product

from msgspec import Struct

from rvmon.logic.automaton import location_of, normalise
from rvmon.logic.clock_regions import (
    NEVER,
    Ages,
    Cuts,
    after,
    alike,
    bounds,
    point_zone,
    projected,
    region_bounds,
    regions_between,
    widened,
    with_new_clock,
    within,
)
from rvmon.logic.formula import Literal, Sense, Until
from rvmon.logic.progress import Duals, step
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Clause, Residual, TooManyClausesError
from rvmon.logic.state_formula import Elapsed, State

MOST_CLAUSES = 60  # the most clauses of a residual, and of its negation

_MOST_KNOWN = 10_000  # the cache is emptied when it exceeds this many answers


class Forecaster:
    """Forecasts the value of residuals.

    A continuation is an infinite word in which every proposition is known, and independent of the
    others; for bounded windows the ages of clocks are over-approximated. So a forecast is sound,
    and within the limits of the search it is complete for formulas without bounds.
    """

    def __init__(self) -> None:
        # the factory of residuals over known propositions, and of their negations
        self.duals = Duals()
        self._values: dict[tuple[Residual, Hashable, int | None], bool | None] = {}
        self._cuts = lru_cache(_MOST_KNOWN)(_cuts_of)
        self._may_hold = lru_cache(_MOST_KNOWN)(_may_hold)

    def of(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        """The value of a residual under all continuations.

        `None` if continuations differ, or if the search was given up.
        """
        if residual in (HOLDS, FAILS):
            return residual == HOLDS
        if len(residual) > MOST_CLAUSES:
            return None
        unit = gap or 1
        cuts = self._cuts(residual, unit)
        # With a single clock, ages with the same `alike` key have the same future.
        is_one = len(ages) == len(cuts) == 1
        key = residual, alike(ages[0] // unit, cuts[0]) if is_one else tuple(ages), gap
        if key not in self._values:
            if len(self._values) > _MOST_KNOWN:
                self._values.clear()
            self._values[key] = self._computed(residual, ages, gap)
        return self._values[key]

    def _computed(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        # It is certainly false if no continuation satisfies it, and certainly true if none
        # satisfies its negation. Both are tests of emptiness.
        if not self.admits(self.duals.affirmed(residual), ages, gap):
            return False
        try:
            denied = self.duals.denied(residual, MOST_CLAUSES)
        except TooManyClausesError:
            return None
        return None if self.admits(denied, ages, gap) else True

    def admits(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool:
        """Whether a continuation may satisfy a residual; also true if the search was given up.

        The arguments are those of `of`.
        """
        if len(residual) > MOST_CLAUSES:
            return True
        start = start_of(residual, ages, gap)
        return start is None or self._may_hold(start, gap)


MOST_TRIED = 200
"""The most combinations of clock regions tried in one search; long clauses count as several."""

_MOST_APART = 100  # the same if differences of clocks are kept, which distinguishes more states

_FEW_ATOMS = 8
"""A step of a clause with n times this many atoms counts n² more, as progression is quadratic."""

MOST_OF_A_STEP = 100  # the most clauses of one step of a clause


class TooLargeError(Exception):
    """The search exceeds its limits."""


class _State(Struct, frozen=True):
    """A state of the search: one clause of a residual, with a zone of its clock ages.

    Ages are in ticks; in clocked time, in multiples of the gap between positions.
    """

    residual: Residual
    ages: Ages


class _Move(Struct, frozen=True):
    """An edge of the search; not `fair` if the oldest clock stays in a bounded region."""

    source: int
    target: int
    fair: bool


Start = tuple[_State, ...]
"""One state per clause of a residual; a continuation has to satisfy at least one of them."""


def start_of(residual: Residual, ages: Sequence[int], gap: int | None) -> Start | None:
    """The start states of a search; `None` if the residual is true.

    Residuals with equal start states have equal futures. The residual is over known propositions,
    as `rvmon.logic.progress.Duals` makes them. The ages of its clocks and `gap` (`None`: it varies)
    are in ticks.
    """
    if any(not clause for clause in residual):
        return None
    search = _Search(gap, differences=True)
    known = point_zone([age // search.unit for age in ages])
    return tuple(search.state(clause, known) for clause in residual)


def _may_hold(start: Start, gap: int | None) -> bool:
    """Whether some infinite continuation satisfies one of the states of `start_of` for the gap.

    False is exact. True may be wrong for bounded windows, because in wide regions ages are
    over-approximated by their differences, and if the search is too large.
    """
    # Exact differences recognise more empty languages but distinguish more states. The coarser
    # search is used only if the exact one grows too large.
    for differences in (True, False):
        with suppress(TooLargeError):
            return _Search(gap, differences=differences).run(start)
    return True  # a forecast that is not found never changes a verdict


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
        """The state of a clause; the last clock of `ages` is the one that `normalise` calls NOW."""
        made, sources = normalise(frozenset([clause]), len(ages) - 2)
        own = projected(ages, sources)
        cuts = _cuts_of(made, self.unit)
        return _State(made, widened(own, cuts, differences=self.differences))

    def enter(self, state: _State) -> int:
        """The number of a state."""
        found = self.index.get(state)
        if found is None:
            found = self.index[state] = len(self.states)
            self.states.append(state)
        return found

    def successors(self, state: _State) -> Iterator[tuple[int | None, bool]]:
        """The states after one position (`None`: satisfied), and whether the move is fair."""
        cuts = _cuts_of(state.residual, self.unit)
        cost = sum((len(clause) // _FEW_ATOMS) ** 2 for clause in state.residual)
        for ages in self.ages_after(cuts, state.ages):
            self.tried += cost
            shown = [bounds(ages, clock)[0] for clock in range(len(cuts))]
            try:
                in_ticks = [age * self.unit for age in shown]
                reached = step(state.residual, in_ticks, _left_open, MOST_OF_A_STEP)
            except TooManyClausesError:
                raise TooLargeError from None
            # In a cycle in which the oldest clock stays below a cut for ever, no time passes, so it
            # is not a word.
            waits = bool(cuts) and bisect_right(cuts[0], shown[0]) < len(cuts[0])
            for clause in reached:
                pending = _without_literals(clause)
                if pending is None:
                    continue
                if not pending:
                    yield None, True
                    return
                target = self.enter(self.state(pending, with_new_clock(ages)))
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
        """Whether some fair cycle postpones no unbounded `U` for ever.

        In a strongly connected component, a `U` that all moves carry on is postponed for ever.
        """
        promised = [_promises(state) for state in self.states]
        if any(m.fair and m.source == m.target and not promised[m.target] for m in moves):
            return True
        import networkx as nx

        graph = nx.DiGraph()
        graph.add_edges_from((move.source, move.target) for move in moves)
        for number, found in enumerate(nx.strongly_connected_components(graph)):
            nx.set_node_attributes(graph, dict.fromkeys(found, number), "component")
        component = graph.nodes(data="component")
        within: dict[int, list[_Move]] = defaultdict(list)
        for move in moves:
            if component[move.source] == component[move.target]:
                within[component[move.source]].append(move)
        return any(
            any(move.fair for move in own)
            and not frozenset.intersection(*(promised[move.target] for move in own))
            for own in within.values()
        )


def _cuts_of(residual: Residual, unit: int) -> Cuts:
    """The ages at which clocks enter their next region, in units, rounded up."""
    return [[-(-cut // unit) for cut in own] for own in location_of(residual).cuts]


def _left_open(literal: Literal) -> Residual:
    return frozenset([frozenset([(literal, NO_CLOCK)])])


def _without_literals(clause: Clause) -> Clause | None:
    """The clause without its literals; `None` if no letter satisfies them.

    `Elapsed(0)` is always true here: a continuation has no outages, so its positions exist.
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
    """The unbounded `U` formulas that a state postpones."""
    return frozenset(
        node
        for clause in state.residual
        for node, clock in clause
        if isinstance(node, Until) and clock == NO_CLOCK
    )
