"""Largest and least values over all reachable states: `sup`, `inf` and `bounds`.

An extreme is found by repeated searches for runs that go beyond the best value so far: first with
growing strides, then by bisection. A search that finds no run proves a bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from rvmon.models import model_error
from rvmon.models.network import Extremes, Network, Query, Term, check_clocks
from rvmon.models.network import expressions as ex
from rvmon.models.network.evaluate import evaluator
from rvmon.models.network.guards import compares_of, is_discrete, normal_form
from rvmon.models.runs import Run
from rvmon.models.runs.exact_times import Rules
from rvmon.models.runs.moves import Space, check_start
from rvmon.models.search.budget import UNLIMITED, Budget, Meter, Statistics, Watch
from rvmon.models.search.clock_bounds import value_range
from rvmon.models.search.native_search import seek
from rvmon.models.search.search_plan import Seek, Sought

FARTHEST = 1_000_000
"""A clock that exceeds so many units is reported as such, and larger bounds are not searched."""


@dataclass(frozen=True, slots=True)
class Extreme:
    """The largest or least value of a term."""

    query: Query
    term: str  # as written
    largest: bool  # whether this is the largest value or the least
    # in units of time for a clock; `None`: it grows without bound, or no state was found that
    # satisfies the condition of the query
    value: int | None
    attained: bool  # whether some state has the value; a clock may only come near it
    exact: bool  # whether it is proved that no state goes further
    run: Run | None  # to a state that has the value or comes near it
    statistics: Statistics
    remark: str = ""  # why the value is not exact, or missing


def extremes(
    network: Network, query: Query, *, budget: Budget = UNLIMITED, watch: Watch | None = None
) -> Iterator[Extreme]:
    """Answer `sup`, `inf` or `bounds`: the extremes of each term.

    Args:
        network: the network to search.
        query: a resolved query for extremes.
        budget: limits of the search for each extreme.
        watch: called from time to time with the progress.

    Raises:
        ModelError: the query does not ask for extremes, the network cannot start, or one of its
            runs leaves the range of a variable.
    """
    if not isinstance(query.formula, Extremes):
        raise model_error("TA020", "this query does not ask for extreme values", query.span)
    check_start(network)
    terms = (term.clock for term in query.formula.terms if term.clock is not None)
    compared = (comparison.clock for comparison in compares_of(query.formula.where))
    check_clocks(network, (*terms, *compared))
    for term in query.formula.terms:
        for largest in query.formula.ends:
            yield _ExtremeSearch(network, query, term, largest, Meter(budget, watch)).run()


class _ExtremeSearch:
    """The search for one extreme. On the way to the least value all numbers are negated."""

    def __init__(
        self, network: Network, query: Query, term: Term, largest: bool, meter: Meter
    ) -> None:
        assert isinstance(query.formula, Extremes), "checked by the caller"
        self._network = network
        self._query = query
        self._where = query.formula.where
        self._term = term
        self._largest = largest
        self._sign = 1 if largest else -1
        self._meter = meter
        self._space = Space(network)
        self._rules = Rules(network)

    def run(self) -> Extreme:
        """Find the extreme, or as much of it as the budget allows."""
        run = self._reach(self._where)
        if run is None:
            stopped = self._meter.stopped
            remark = f"not decided: {stopped}" if stopped else "no state meets the condition"
            return self._extreme(None, run, attained=False, exact=not stopped, remark=remark)
        # Invariant: some run reaches `low`, and nothing beyond `high` is searched for. `proved`
        # tells whether `high` bounds all values.
        low, high = floor(self._value(run)), self._farthest()
        proved, stride = self._term.clock is None or not self._largest, 1
        while low < high and not self._meter.stopped:
            # Strides double, so that a value of n takes about 2 log n searches instead of n.
            probe = min(low + stride, high) - 1
            if self._grows(run):
                remark = "grows without bound: time may pass forever there"
                return self._extreme(None, run, attained=False, exact=True, remark=remark)
            further = self._reach(self._beyond(probe))
            if further is None:
                high, proved = probe, True
                stride = max(1, (high - low + 1) // 2)
            else:
                run, low = further, max(probe + 1, floor(self._value(further)))
                stride *= 2
        if self._meter.stopped or not proved:
            remark = f"not decided: {self._meter.stopped}" if self._meter.stopped else ""
            return self._extreme(low, run, attained=True, exact=False, remark=remark)
        there = run if self._value(run) == low else self._reach(self._beyond(low, or_at=True))
        return self._extreme(low, there or run, attained=there is not None, exact=True)

    def _extreme(
        self, value: int | None, run: Run | None, *, attained: bool, exact: bool, remark: str = ""
    ) -> Extreme:
        signed = None if value is None else self._sign * value
        statistics = self._meter.statistics()
        return Extreme(
            self._query, self._term.text, self._largest, signed, attained, exact, run, statistics,
            remark,
        )  # fmt: skip

    def _reach(self, formula: ex.Expression) -> Run | None:
        return seek(self._network, Sought(Seek.GOAL, normal_form(formula)), self._meter).run

    def _value(self, run: Run) -> Fraction:
        """The value, with the sign of the search, in the last state of a run."""
        last = self._rules.replay(run)[-1]
        if self._term.clock is not None:
            return self._sign * last.clocks[self._term.clock]
        return Fraction(self._sign * evaluator(self._term.value)(last.locations, last.values))

    def _grows(self, run: Run) -> bool:
        """Whether a clock grows without bound at the end of a run: time may pass forever there."""
        end = run.steps[-1].position if run.steps else run.start
        state = self._space.state(end.locations, end.values)
        fixed = self._term.clock is None or not self._largest or not is_discrete(self._where)
        return not fixed and state is not None and not state.is_time_bounded

    def _farthest(self) -> int:
        """A bound on all values, or for the largest value of a clock the limit of the search."""
        if self._term.clock is not None:
            return FARTHEST if self._largest else 0
        return self._sign * value_range(self._term.value, self._network)[self._largest]

    def _beyond(self, number: int, *, or_at: bool = False) -> ex.Expression:
        """The states within the query whose value lies beyond a number."""
        bound = ex.Constant(self._sign * number)
        op = (">" if self._largest else "<") + ("=" if or_at else "")
        compare: ex.Expression = ex.BinaryOperation(ex.BinaryOp(op), self._term.value, bound)
        if self._term.clock is not None:
            compare = ex.ClockCompare(self._term.clock, ex.ClockOp(op), bound)
        return ex.BinaryOperation(ex.BinaryOp.AND, self._where, compare)
