"""A slow and obvious decision procedure for small networks of timed automata: the region graph.

Every question is decided by walking through all regions, one representative valuation each, with
the plain rules of `rvmon.models.runs.exact_times`. It shares no zone, no search and no abstraction
with the model checker, and so can say whether that is right.

Source: Alur and Dill, A Theory of Timed Automata, 1994, section 4.3.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import floor
from operator import ge, gt, le, lt
from typing import Any

from rvmon.models.network import LeadsToFormula, Network
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.expressions import (
    BinaryOp,
    BinaryOperation,
    Choice,
    ClockCompare,
    ClockOp,
    Constant,
    Expression,
    PathFormula,
    PathOp,
    UnaryOp,
    UnaryOperation,
)
from rvmon.models.network.guards import (
    compares_of,
    has_deadlock,
    has_paths,
    is_discrete,
    normal_form,
    with_deadlock,
)
from rvmon.models.runs import Run
from rvmon.models.runs.exact_times import (
    Configuration,
    InvalidRunError,
    Rules,
    initial_configuration,
)
from rvmon.models.search.budget import Outcome


class TooManyRegionsError(Exception):
    """A network has more regions than were asked to be walked through."""


_COMPARISONS = {ClockOp.LT: lt, ClockOp.LE: le, ClockOp.GE: ge, ClockOp.GT: gt}


def truth_of(formula: Expression) -> Callable[[Configuration], bool]:
    """Make a function that says whether a state formula without `deadlock` holds."""
    if is_discrete(formula):
        value = evaluator(formula)
        return lambda now: bool(value(now.locations, now.values))
    match formula:
        case ClockCompare(clock, op, written):
            compare, bound = _COMPARISONS[op], evaluator(written)
            return lambda now: compare(now.clocks[clock], bound(now.locations, now.values))
        case UnaryOperation(UnaryOp.NOT, operand):
            denied = truth_of(operand)
            return lambda now: not denied(now)
        case BinaryOperation(word, left, right):
            join, first, second = JOINED[word], truth_of(left), truth_of(right)
            return lambda now: join(first(now), second(now))
        case Choice(condition, then, otherwise):
            test, yes, no = truth_of(condition), truth_of(then), truth_of(otherwise)
            return lambda now: yes(now) if test(now) else no(now)
        case _:
            raise AssertionError(f"{formula} is no state formula")


JOINED: dict[BinaryOp, Callable[[bool, bool], bool]] = {
    BinaryOp.AND: lambda one, other: one and other,
    BinaryOp.OR: lambda one, other: one or other,
    BinaryOp.IMPLY: lambda one, other: other or not one,
    BinaryOp.EQ: lambda one, other: one == other,
    BinaryOp.NE: lambda one, other: one != other,
}


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A configuration that stands for all of its region, and the time since a chosen instant.

    There is one object for each region that graphs share.

    Attributes:
        now: the representative; clocks above all constants are one more than the largest.
        timer: as the clocks; always 0 if nobody asks for it.
    """

    now: Configuration
    timer: Fraction


Steps = dict[Any, Any]
"""The regions by what they hold, and what follows on them, as far as it was asked, by the largest
constant and whether there is a timer: questions on one network share it."""


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
        self._rules = Rules(network)

    def _known(self, kind: str, region: Region, find: Callable[[Region], Any]) -> Any:
        key = (self._largest, self._timed, kind, region)
        if key not in self._steps:
            self._steps[key] = find(region)
        return self._steps[key]

    def start(self) -> Region:
        """The region of the initial configuration."""
        return self.region_of(initial_configuration(self._network))

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
        for action in self._rules.every_action(region.now):
            try:
                after = self._rules.act(region.now, action)
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
            now = self._rules.wait(region.now, step)
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

    def _canonical(self, now: Configuration, timer: Fraction) -> Region:
        """The representative of a configuration's region."""
        clocks = [*now.clocks, *([timer] if self._timed else [])]
        whole = [floor(clock) if clock <= self._largest else self._largest + 1 for clock in clocks]
        over = [clock - floor(clock) if clock <= self._largest else Fraction(0) for clock in clocks]
        fractions = sorted({Fraction(0), *over})
        ranks = [fractions.index(part) for part in over]
        key = (self._largest, self._timed, now.locations, now.values, *whole, *ranks)
        if key not in self._steps:
            moved = [
                number + Fraction(rank, len(fractions))
                for number, rank in zip(whole, ranks, strict=True)
            ]
            if self._timed:
                timer = moved.pop()
            found = Configuration(now.locations, now.values, tuple(moved))
            self._steps[key] = Region(found, timer)
        region: Region = self._steps[key]
        return region


Instants = list[tuple[Fraction, Configuration]]


def shows(network: Network, outcome: Outcome) -> bool:
    """Whether the run of an outcome is one of the network and decides the query as it says."""
    run = outcome.run
    assert run is not None
    Rules(network).replay(run)
    instants = instants_of(network, run)
    match outcome.query.formula:
        case LeadsToFormula(left, right, bound):
            left_holds = truth_of(left)
            missing = normal_form(right, positive=False)
            return any(
                left_holds(now) and _stays(instants[index:], missing, bound)
                for index, (_, now) in enumerate(instants)
            )
        case PathFormula(op, body, bound):
            positive = op in (PathOp.POSSIBLY, PathOp.POTENTIALLY_ALWAYS)
            formula = normal_form(body, positive=positive)
            if has_paths(formula):
                return True  # that the run is one was checked; what it leads to is no single run
            if op in (PathOp.POSSIBLY, PathOp.INVARIANTLY):
                time, last = instants[-1]
                in_time = bound is None or time <= bound
                return in_time and _holds_at_end(network, formula, last)
            return _stays(instants, formula, bound)
        case _:
            raise AssertionError(f"{outcome.query.text} has no path operator")


def instants_of(network: Network, run: Run) -> Instants:
    """Each instant at which something is done, before and after it, and the middle of each wait."""
    rules, time, now = Rules(network), Fraction(0), initial_configuration(network)
    instants = [(time, now)]
    for step in run.steps:
        half = step.delay / 2
        instants.append((time + half, rules.wait(now, half)))
        time, now = time + step.delay, rules.wait(now, step.delay)
        instants.append((time, now))
        if step.action is not None:
            now = rules.act(now, step.action)
            instants.append((time, now))
    return instants


def _holds_at_end(network: Network, formula: Expression, last: Configuration) -> bool:
    if not has_deadlock(formula):
        return truth_of(formula)(last)
    graph = RegionGraph(network, [formula])
    dead = graph.is_dead(graph.region_of(last))
    return truth_of(with_deadlock(formula, dead))(last)


def _stays(instants: Instants, formula: Expression, bound: int | None) -> bool:
    """Whether a formula holds throughout, or until more than the bound has gone by."""
    start, holds = instants[0][0], truth_of(formula)
    for time, now in instants:
        if bound is not None and time - start > bound:
            return True
        if not holds(now):
            return False
    return True
