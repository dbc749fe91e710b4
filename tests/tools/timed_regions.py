"""A slow and obvious decision procedure for small networks of timed automata: the region graph.

Every question is decided by walking through all regions, one representative valuation each, with
the plain rules of `rvmon.timed.runs.concrete`. It shares no zone, no search and no abstraction with
the model checker, and so can say whether that is right.

Source: Alur and Dill, A Theory of Timed Automata, 1994, section 4.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import floor
from typing import Any

import networkx as nx

from rvmon.timed.model.evaluate import evaluator
from rvmon.timed.model.expressions import (
    BinaryOperation,
    Choice,
    ClockCompare,
    Constant,
    Expression,
    UnaryOperation,
)
from rvmon.timed.model.guards import (
    compares_of,
    is_discrete,
)
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.runs.concrete import (
    Configuration,
    InvalidRunError,
    act,
    compares,
    every_action,
    initial_configuration,
    wait,
)


class TooManyRegionsError(Exception):
    """A network has more regions than were asked to be walked through."""


def satisfies(now: Configuration, formula: Expression) -> bool:
    """Whether a state formula without `deadlock` holds."""
    if is_discrete(formula):
        return bool(evaluator(formula)(now.locations, now.values))
    match formula:
        case ClockCompare():
            return compares(now, formula)
        case UnaryOperation(UnaryOp.NOT, operand):
            return not satisfies(now, operand)
        case BinaryOperation(BinaryOp.AND, left, right):
            return satisfies(now, left) and satisfies(now, right)
        case BinaryOperation(BinaryOp.OR, left, right):
            return satisfies(now, left) or satisfies(now, right)
        case BinaryOperation(BinaryOp.IMPLY, left, right):
            return not satisfies(now, left) or satisfies(now, right)
        case BinaryOperation(BinaryOp.EQ, left, right):
            return satisfies(now, left) == satisfies(now, right)
        case BinaryOperation(BinaryOp.NE, left, right):
            return satisfies(now, left) != satisfies(now, right)
        case Choice(condition, then, otherwise):
            return satisfies(now, then if satisfies(now, condition) else otherwise)
        case _:
            raise AssertionError(f"{formula} is no state formula")


@dataclass(frozen=True, slots=True)
class Region:
    """A configuration that stands for all of its region, and the time since a chosen instant.

    Attributes:
        now: the representative; clocks above all constants are one more than the largest.
        timer: as the clocks; always 0 if nobody asks for it.
    """

    now: Configuration
    timer: Fraction


Steps = dict[tuple[int, bool, str, "Region"], Any]
"""What follows on regions, as far as it was asked, by the largest constant and whether there is a
timer: questions on one network share it."""


class RegionGraph:
    """The regions of a network.

    Args:
        network: small, with constants of one digit.
        formulas: whose clock constants count too.
        bound: the largest number that the timer is compared with; `None`: there is no timer.
        limit: the most regions to walk through.
        steps: what other graphs of the network have found.
    """

    def __init__(
        self,
        network: Network,
        formulas: Iterable[Expression] = (),
        bound: int | None = None,
        limit: int = 5_000,
        steps: Steps | None = None,
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
        self._steps: Steps = {} if steps is None else steps

    def _known(self, kind: str, region: Region, find: Callable[[Region], Any]) -> Any:
        key = (self._largest, self._timed, kind, region)
        if key not in self._steps:
            self._steps[key] = find(region)
        return self._steps[key]

    def start(self) -> Region:
        """The region of the initial configuration."""
        return Region(initial_configuration(self._network), Fraction(0))

    def region_of(self, now: Configuration) -> Region:
        """The region of any configuration."""
        return self._canonical(now, Fraction(0))

    def restarted(self, region: Region) -> Region:
        """The same region with the timer at 0."""
        return self._canonical(region.now, Fraction(0))

    def actions(self, region: Region) -> list[Region]:
        """The regions behind all actions that are possible now."""
        return list(self._known("actions", region, lambda one: [*self._actions(one)]))

    def _actions(self, region: Region) -> Iterator[Region]:
        for action in every_action(self._network, region.now):
            try:
                after = act(self._network, region.now, action)
            except InvalidRunError:
                continue
            yield self._canonical(after, region.timer)

    def later(self, region: Region) -> Region | None:
        """The next region that time leads to, the same one if none is left; `None` if it stops."""
        found: Region | None = self._known("later", region, self._later)
        return found

    def _later(self, region: Region) -> Region | None:
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
            if self.actions(region):
                return False
            later = self.later(region)
            if later is None or later == region:
                return True
            region = later

    def staying(self, inside: set[Region]) -> set[Region]:
        """The regions from which some maximal run never leaves a set."""
        graph = nx.DiGraph()
        graph.add_nodes_from(inside)
        taken: list[tuple[Region, Region]] = []
        good: set[Region] = set()
        for region in inside:
            actions, later = list(self.actions(region)), self.later(region)
            if later == region or (later is None and not actions):
                good.add(region)
            taken += [(region, after) for after in actions if after in inside]
            if later in inside:
                graph.add_edge(region, later)
        graph.add_edges_from(taken)
        component_of = {
            region: number
            for number, component in enumerate(nx.strongly_connected_components(graph))
            for region in component
        }
        good |= {a for a, b in taken if component_of[a] == component_of[b]}
        return leading_to(graph, good)

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


def leading_to(graph: nx.DiGraph, targets: set[Region]) -> set[Region]:
    """The nodes from which some target can be reached."""
    found = set(targets)
    for target in targets:
        if target in graph:
            found |= nx.ancestors(graph, target)
    return found
