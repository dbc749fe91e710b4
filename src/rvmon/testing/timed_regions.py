"""A slow and obvious decision procedure for small networks of timed automata: the region graph.

Every question is decided by walking through all regions, one representative valuation each, with
the plain rules of `rvmon.timed.concrete`. It shares no zone, no search and no abstraction with the
model checker, and so can say whether that is right.

Source: Alur and Dill, A Theory of Timed Automata, 1994, section 4.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import floor

import networkx as nx

from rvmon.timed.concrete import (
    Configuration,
    InvalidRunError,
    act,
    channel_index,
    initial_configuration,
    is_ready,
    satisfies,
    wait,
)
from rvmon.timed.guards import normal_form, with_deadlock
from rvmon.timed.model import (
    Constant,
    Edge,
    Expression,
    LeadsToFormula,
    Network,
    PathFormula,
    Query,
)
from rvmon.timed.pieces import compares_of, speaks_of_deadlock
from rvmon.timed.run import Action
from rvmon.timed.syntax import PathOp


class TooManyRegionsError(Exception):
    """A network has more regions than were asked to be walked through."""


@dataclass(frozen=True, slots=True)
class Region:
    """A configuration that stands for all of its region, and the time since a chosen instant.

    Attributes:
        now: the representative; clocks above all constants are one more than the largest.
        timer: as the clocks; always 0 if nobody asks for it.
    """

    now: Configuration
    timer: Fraction


class RegionGraph:
    """The regions of a network.

    Args:
        network: small, with constants of one digit.
        formulas: whose clock constants count too.
        bound: the largest number that the timer is compared with; `None`: there is no timer.
        limit: the most regions to walk through.
    """

    def __init__(
        self,
        network: Network,
        formulas: Iterable[Expression] = (),
        bound: int | None = None,
        limit: int = 5_000,
    ) -> None:
        compares = [
            *(c for a in network.automata for place in a.locations for c in place.invariant.clocks),
            *(c for a in network.automata for edge in a.edges for c in edge.guard.clocks),
            *(c for formula in formulas for c in compares_of(formula)),
        ]
        constants = [c.bound.value for c in compares if isinstance(c.bound, Constant)]
        self._network = network
        self._largest = max([0, *constants, bound or 0])
        self._timed = bound is not None
        self._limit = limit

    def start(self) -> Region:
        """The region of the initial configuration."""
        return Region(initial_configuration(self._network), Fraction(0))

    def region_of(self, now: Configuration) -> Region:
        """The region of any configuration."""
        return self._canonical(now, Fraction(0))

    def restarted(self, region: Region) -> Region:
        """The same region with the timer at 0."""
        return self._canonical(region.now, Fraction(0))

    def actions(self, region: Region) -> Iterator[Region]:
        """The regions behind all actions that are possible now."""
        for action in _all_actions(self._network, region.now):
            try:
                after = act(self._network, region.now, action)
            except InvalidRunError:
                continue
            yield self._canonical(after, region.timer)

    def later(self, region: Region) -> Region | None:
        """The next region that time leads to, the same one if none is left; `None` if it stops."""
        clocks = [*region.now.clocks, *([region.timer] if self._timed else [])]
        finite = [clock for clock in clocks if clock <= self._largest]
        step = Fraction(1)
        if finite:
            fractions = sorted({clock - floor(clock) for clock in finite})
            # Representatives are evenly spread: half a gap leaves an integer, else the largest
            # fraction reaches the next one.
            step = (Fraction(1) - fractions[-1]) / 2 if fractions[0] == 0 else 1 - fractions[-1]
        try:
            now = wait(self._network, region.now, step)
        except InvalidRunError:
            return None
        return self._canonical(now, region.timer + step if self._timed else region.timer)

    def reachable(
        self, starts: Iterable[Region], follow: Callable[[Region], bool] = lambda _region: True
    ) -> set[Region]:
        """All regions that can be reached, through those that `follow` accepts only."""
        seen: set[Region] = set()
        pending = [region for region in starts if follow(region)]
        while pending:
            region = pending.pop()
            if region in seen:
                continue
            seen.add(region)
            if len(seen) > self._limit:
                raise TooManyRegionsError
            later = self.later(region)
            onward = [*self.actions(region), *([] if later is None else [later])]
            pending += [after for after in onward if after not in seen and follow(after)]
        return seen

    def is_dead(self, region: Region) -> bool:
        """Whether no action is possible now or after any delay."""
        while True:
            if next(self.actions(region), None) is not None:
                return False
            later = self.later(region)
            if later is None or later == region:
                return True
            region = later

    def can_stay(self, starts: Iterable[Region], inside: Callable[[Region], bool]) -> bool:
        """Whether some maximal run from some start never leaves a set of regions."""
        regions = self.reachable(starts, inside)
        graph = nx.DiGraph()
        taken: set[tuple[Region, Region]] = set()
        for region in regions:
            graph.add_node(region)
            actions = list(self.actions(region))
            later = self.later(region)
            if later == region or (later is None and not actions):
                return True
            for after in actions:
                if after in regions:
                    taken.add((region, after))
                    graph.add_edge(region, after)
            if later in regions:
                graph.add_edge(region, later)
        component_of = {
            region: number
            for number, component in enumerate(nx.strongly_connected_components(graph))
            for region in component
        }
        return any(component_of[a] == component_of[b] for a, b in taken)

    def _canonical(self, now: Configuration, timer: Fraction) -> Region:
        """The representative of a configuration's region."""
        clocks = [*now.clocks, *([timer] if self._timed else [])]
        finite = [clock for clock in clocks if clock <= self._largest]
        fractions = sorted({clock - floor(clock) for clock in finite} - {Fraction(0)})
        gaps = len(fractions) + 1
        rank = {fraction: Fraction(i, gaps) for i, fraction in enumerate(fractions, start=1)}
        rank[Fraction(0)] = Fraction(0)
        moved = [
            floor(clock) + rank[clock - floor(clock)]
            if clock <= self._largest
            else Fraction(self._largest + 1)
            for clock in clocks
        ]
        if self._timed:
            timer = moved.pop()
        return Region(Configuration(now.locations, now.values, tuple(moved)), timer)


def decide(network: Network, query: Query, limit: int = 5_000) -> bool:
    """Whether a query holds, by walking through all regions.

    Raises:
        TooManyRegionsError: there are more than `limit`.
    """
    match query.formula:
        case LeadsToFormula(left, right, bound):
            return _responds(network, left, right, bound, limit)
        case PathFormula(PathOp.POSSIBLY, body, bound):
            return _reaches(network, normal_form(body), bound, limit)
        case PathFormula(PathOp.INVARIANTLY, body, bound):
            return not _reaches(network, normal_form(body, positive=False), bound, limit)
        case PathFormula(PathOp.EVENTUALLY, body, bound):
            return not _avoids(network, normal_form(body, positive=False), bound, limit)
        case PathFormula(PathOp.POTENTIALLY_ALWAYS, body, bound):
            return _avoids(network, normal_form(body), bound, limit)
        case _:
            raise AssertionError(f"{query.text} has no path operator")


def _reaches(network: Network, formula: Expression, bound: int | None, limit: int) -> bool:
    graph = RegionGraph(network, [formula], bound, limit)
    regions = graph.reachable([graph.start()])
    if not speaks_of_deadlock(formula):
        return any(
            satisfies(region.now, formula) and (bound is None or region.timer <= bound)
            for region in regions
        )
    by_death = {dead: with_deadlock(formula, dead) for dead in (True, False)}
    return any(satisfies(r.now, by_death[graph.is_dead(r)]) for r in regions)


def _avoids(network: Network, formula: Expression, bound: int | None, limit: int) -> bool:
    """Whether some run stays inside a formula for ever, or until the bound is over."""
    graph = RegionGraph(network, [formula], bound, limit)
    starts = [graph.start()]
    if bound is not None and _is_late(graph, starts, formula, bound):
        return True
    return graph.can_stay(starts, lambda region: satisfies(region.now, formula))


def _responds(
    network: Network, left: Expression, right: Expression, bound: int | None, limit: int
) -> bool:
    graph = RegionGraph(network, [left, right], bound, limit)
    missing = normal_form(right, positive=False)
    everywhere = graph.reachable([graph.start()])
    starts = [graph.restarted(r) for r in everywhere if satisfies(r.now, left)]
    if bound is not None and _is_late(graph, starts, missing, bound):
        return False
    return not graph.can_stay(starts, lambda region: satisfies(region.now, missing))


def _is_late(graph: RegionGraph, starts: Iterable[Region], inside: Expression, bound: int) -> bool:
    """Whether the timer can pass the bound with the formula true until then."""
    waiting = graph.reachable(
        starts, lambda region: region.timer <= bound and satisfies(region.now, inside)
    )
    return any(later is not None and later.timer > bound for later in map(graph.later, waiting))


def _all_actions(network: Network, now: Configuration) -> Iterator[Action]:
    """Every choice of edges that could be an action, whether or not the rules allow it."""
    edges = [
        (index, edge)
        for index, automaton in enumerate(network.automata)
        for edge in automaton.edges
        if is_ready(now, index, edge)
    ]
    for sender, first in edges:
        if first.sync is None:
            yield Action(((sender, first),))
        elif first.sync.sends:
            channel = channel_index(now, first)
            choices: list[list[tuple[int, Edge] | None]] = []
            for index in range(len(network.automata)):
                able: list[tuple[int, Edge] | None] = [
                    (other, edge)
                    for other, edge in edges
                    if other == index != sender
                    and edge.sync is not None
                    and not edge.sync.sends
                    and channel_index(now, edge) == channel
                ]
                choices.append([*able, None])
            for chosen in product(*choices):
                yield Action(((sender, first), *(other for other in chosen if other is not None)))
