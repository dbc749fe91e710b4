"""Is there an infinite continuation that satisfies a residual?

A clause of a residual is a state of a nondeterministic automaton: a step takes it to any clause of
what it becomes, under letters that the clause's literals allow. A path is accepting if no unbounded
`U` is put off for ever. Ages are kept as regions between the cuts of a location.

Source: generalised Büchi acceptance after Gerth, Peled, Vardi and Wolper 1995; strongly connected
components for emptiness, after Couvreur 1999.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.automaton.location import location_of, normalise
from rvmon.formula.core import Literal, Sense, Until
from rvmon.formula.progress import step
from rvmon.formula.residual import NO_CLOCK, Clause, Residual, TooManyClausesError
from rvmon.formula.state import State

MOST_TRIED = 200
"""Steps of states, and combinations of regions in which they might be made."""

MOST_CLAUSES = 100
"""Of one step of a clause."""

_NEVER = 1 << 62


class TooLargeError(Exception):
    """The search outgrew its limits."""


@dataclass(frozen=True, slots=True)
class _State:
    """A clause as a residual of its own, and the region of each of its clocks."""

    residual: Residual
    regions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class _Move:
    """An edge between two states; `fair`: the oldest clock does not wait in a bounded region."""

    source: int
    target: int
    fair: bool


def is_satisfiable(residual: Residual, ages: Sequence[int], gap: int | None) -> bool:
    """Whether some infinite continuation satisfies a residual.

    Ages are followed clock by clock, so a bounded residual may be called satisfiable though the
    differences of its clocks forbid it; one that is called unsatisfiable is.

    Args:
        residual: of literals of two senses, as `rvmon.formula.dual` makes them.
        ages: of its clocks at the last position.
        gap: ticks between two positions; `None` if any number of them.

    Raises:
        TooLargeError: the search takes too many steps.
    """
    return _Search(gap).run(residual, ages)


class _Search:
    def __init__(self, gap: int | None) -> None:
        self.delays = (1, _NEVER) if gap is None else (gap, gap)
        self.index: dict[_State, int] = {}
        self.states: list[_State] = []
        self.tried = 0

    def run(self, residual: Residual, ages: Sequence[int]) -> bool:
        for clause in residual:
            if not clause:
                return True
            self.enter(clause, ages)
        moves: list[_Move] = []
        current = 0
        while current < len(self.states):
            for target, fair in self.successors(self.states[current]):
                if target is None:
                    return True
                moves.append(_Move(current, target, fair))
            current += 1
        return self.has_accepting_cycle(moves)

    def enter(self, clause: Clause, ages: Sequence[int]) -> int:
        """The state of a clause, whose clocks have these ages or others in the same regions."""
        # The last age is that of the clock that `normalise` calls NOW; -1 is its place as well.
        made, sources = normalise(frozenset([clause]), len(ages) - 1)
        own = [ages[source] for source in sources]
        state = _State(made, tuple(map(bisect_right, location_of(made).cuts, own)))
        found = self.index.get(state)
        if found is None:
            found = self.index[state] = len(self.states)
            self.states.append(state)
        return found

    def successors(self, state: _State) -> Iterator[tuple[int | None, bool]]:
        """The states after one position, `None` for what is satisfied; and whether it is fair."""
        cuts = location_of(state.residual).cuts
        for regions in self.regions_after(cuts, state.regions):
            ages = [_ages_in(own, at)[0] for own, at in zip(cuts, regions, strict=True)]
            try:
                reached = step(state.residual, ages, _left_open, MOST_CLAUSES)
            except TooManyClausesError:
                raise TooLargeError from None
            waits = bool(regions) and regions[0] < len(cuts[0])
            for clause in reached:
                pending = _without_literals(clause)
                if pending is None:
                    continue
                if not pending:
                    yield None, True
                    return
                target = self.enter(pending, (*ages, 0))
                oldest_stays = waits and any(clock == 0 for _, clock in pending)
                yield target, not oldest_stays

    def regions_after(
        self, cuts: tuple[tuple[int, ...], ...], regions: tuple[int, ...]
    ) -> Iterator[tuple[int, ...]]:
        """The regions in which the clocks may be at the next position."""
        spans = [range(region, len(own) + 1) for own, region in zip(cuts, regions, strict=True)]
        for later in product(*spans):
            self.tried += 1
            if self.tried > MOST_TRIED:
                raise TooLargeError
            least, most = self.delays
            for own, before, after in zip(cuts, regions, later, strict=True):
                low, high = _ages_in(own, before)
                later_low, later_high = _ages_in(own, after)
                least = max(least, later_low - high)
                most = min(most, later_high - low)
            if least <= most:
                yield later

    def has_accepting_cycle(self, moves: Sequence[_Move]) -> bool:
        """Whether a cycle puts nothing off for ever."""
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
    """What a clause owes later; `None` if its literals contradict each other."""
    seen: dict[State, Sense] = {}
    pending = []
    for node, clock in clause:
        if not isinstance(node, Literal):
            pending.append((node, clock))
        elif seen.setdefault(node.proposition, node.sense) is not node.sense:
            return None
    return frozenset(pending)


def _promises(state: _State) -> frozenset[Until]:
    """The unbounded `U` that a state puts off."""
    return frozenset(
        node
        for clause in state.residual
        for node, clock in clause
        if isinstance(node, Until) and clock == NO_CLOCK
    )


def _ages_in(cuts: tuple[int, ...], region: int) -> tuple[int, int]:
    """The least and the greatest age in a region."""
    low = cuts[region - 1] if region else 0
    return low, cuts[region] - 1 if region < len(cuts) else _NEVER
