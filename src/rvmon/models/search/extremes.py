"""Largest and least values over all reachable states: `sup`, `inf` and `bounds`.

An end is found by asking for runs that go further, in growing strides from what a run has reached,
then by halves: what no run goes beyond is proved by the search that found none.
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
"""A clock that goes beyond so many units is said to do so; a larger bound is not looked for."""


@dataclass(frozen=True, slots=True)
class Extreme:
    """An end of the values of a term."""

    query: Query  # the question
    term: str  # of which it is an end, as written
    largest: bool  # whether it is the largest value, or the least
    # in units of time, if of a clock; `None`: it grows without bound, or no state was found that
    # counts
    value: int | None
    attained: bool  # whether some state has it; a clock may only come near it
    exact: bool  # whether no state goes further; else that was not decided
    run: Run | None  # to a state that has the value, or comes near it
    statistics: Statistics  # its cost
    remark: str = ""  # the reason why it is not exact, or has no value


def extremes(
    network: Network, query: Query, *, budget: Budget = UNLIMITED, watch: Watch | None = None
) -> Iterator[Extreme]:
    """Answer `sup`, `inf` or `bounds`: for each term its ends.

    Args:
        network: the network in question.
        query: as resolved.
        budget: the limits at which it gives up, for each end.
        watch: called now and then.

    Raises:
        ModelError: the query asks for no values, or the network cannot start, or a run of it
            leaves a variable's range.
    """
    if not isinstance(query.formula, Extremes):
        raise model_error("TA020", "this asks for no extreme value", query.span)
    check_start(network)
    terms = (term.clock for term in query.formula.terms if term.clock is not None)
    compared = (comparison.clock for comparison in compares_of(query.formula.where))
    check_clocks(network, (*terms, *compared))
    for term in query.formula.terms:
        for largest in query.formula.ends:
            yield _Climb(network, query, term, largest, Meter(budget, watch)).run()


class _Climb:
    """The search for one end; numbers are negated on the way to the least value."""

    def __init__(
        self, network: Network, query: Query, term: Term, largest: bool, meter: Meter
    ) -> None:
        assert isinstance(query.formula, Extremes), "looked at before"
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
        """The end, or what is known of it."""
        run = self._reach(self._where)
        if run is None:
            stopped = self._meter.stopped
            remark = f"not decided: {stopped}" if stopped else "no state counts"
            return self._told(None, run, attained=False, exact=not stopped, remark=remark)
        # From here on some run reaches `low`, and none is sought beyond `high`.
        low, high = floor(self._value(run)), self._farthest()
        proved, stride = self._term.clock is None or not self._largest, 1
        while low < high and not self._meter.stopped:
            # Strides double, so that a value of n takes about 2 log n searches, and not n.
            probe = min(low + stride, high) - 1
            if self._grows(run):
                remark = "grows without bound: time may pass for ever there"
                return self._told(None, run, attained=False, exact=True, remark=remark)
            further = self._reach(self._beyond(probe))
            if further is None:
                high, proved = probe, True
                stride = max(1, (high - low + 1) // 2)
            else:
                run, low = further, max(probe + 1, floor(self._value(further)))
                stride *= 2
        if self._meter.stopped or not proved:
            remark = f"not decided: {self._meter.stopped}" if self._meter.stopped else ""
            return self._told(low, run, attained=True, exact=False, remark=remark)
        there = run if self._value(run) == low else self._reach(self._beyond(low, or_at=True))
        return self._told(low, there or run, attained=there is not None, exact=True)

    def _told(
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
        """The value in the last state of a run."""
        last = self._rules.replay(run)[-1]
        if self._term.clock is not None:
            return self._sign * last.clocks[self._term.clock]
        return Fraction(self._sign * evaluator(self._term.value)(last.locations, last.values))

    def _grows(self, run: Run) -> bool:
        """Whether a clock goes on for ever where a run ends, and that counts all the time."""
        end = run.steps[-1].position if run.steps else run.start
        state = self._space.state(end.locations, end.values)
        fixed = self._term.clock is None or not self._largest or not is_discrete(self._where)
        return not fixed and state is not None and not state.is_time_bounded

    def _farthest(self) -> int:
        """A bound on all values; for a clock, the value beyond which none is asked for."""
        if self._term.clock is not None:
            return FARTHEST if self._largest else 0
        return self._sign * value_range(self._term.value, self._network)[self._largest]

    def _beyond(self, number: int, *, or_at: bool = False) -> ex.Expression:
        """States that count and lie beyond a number."""
        bound = ex.Constant(self._sign * number)
        op = (">" if self._largest else "<") + ("=" if or_at else "")
        compare: ex.Expression = ex.BinaryOperation(ex.BinaryOp(op), self._term.value, bound)
        if self._term.clock is not None:
            compare = ex.ClockCompare(self._term.clock, ex.ClockOp(op), bound)
        return ex.BinaryOperation(ex.BinaryOp.AND, self._where, compare)
