"""Answers queries by the kind of native search that is sound for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models import network as nta
from rvmon.models.language.elaborate import query_on
from rvmon.models.network import expressions as ex
from rvmon.models.network import guards
from rvmon.models.runs import Ending, Run
from rvmon.models.runs.moves import check_start
from rvmon.models.search.budget import UNLIMITED, Budget, Meter, Outcome, Policy, Watch
from rvmon.models.search.ltl import buchi_of, check_linear
from rvmon.models.search.native_search import seek
from rvmon.models.search.search_plan import Seek, Sought


@dataclass(frozen=True, slots=True)
class _Question:
    """What all searches for one query share."""

    network: nta.Network
    meter: Meter
    policy: Policy

    def run(self, sought: Sought) -> Run | None:
        """Search for a run; `None` if there is none or the search was stopped."""
        return seek(self.network, sought, self.meter).run


def verify(
    network: nta.Network,
    query: nta.Query | str,
    *,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
    policy: Policy = Policy.SHORTEST,
) -> Outcome:
    """Decide a query, with a run as evidence where a single run can show the answer.

    Args:
        network: the network to search.
        query: resolved, or as text.
        budget: the limits at which the search stops undecided.
        watch: called from time to time with the progress.
        policy: how to choose among several runs that show `E<>` or refute `A[]`.

    Raises:
        ModelError: the query cannot be decided, the network cannot start, or one of its runs
            leaves the range of a variable.
    """
    network, resolved = query_on(network, query) if isinstance(query, str) else (network, query)
    check_start(network)
    nta.check_clocks(network, (comparison.clock for comparison in compares_in(resolved.formula)))
    question = _Question(network, Meter(budget, watch), policy)
    found = _search(question, resolved)
    meter, run = question.meter, found.run
    holds = found.holds
    if holds is None:
        holds = None if run is None and meter.stopped else (run is not None) == found.shows
    remark = f"not decided: {meter.stopped}" if holds is None else _remark(run)
    if run is not None and found.chosen not in (None, policy):
        remark = f"no {policy} run was found: {meter.stopped}"
    return Outcome(resolved, holds, run, found.chosen, meter.statistics(), remark)


def compares_in(formula: nta.QueryFormula) -> Iterator[ex.ClockCompare]:
    """All comparisons of clocks in the formula of a query."""
    if isinstance(formula, nta.LeadsToFormula):
        return chain(guards.compares_of(formula.left), guards.compares_of(formula.right))
    return iter(()) if isinstance(formula, nta.ValueQuery) else guards.compares_of(formula)


def _remark(run: Run | None) -> str:
    match run:
        case Run(ending=Ending.ZENO_LOOP):
            return "only by a Zeno loop, which repeats forever in a bounded time"
        case Run(ending=Ending.TIME_LOCK):
            return "time stops here: no edge can be taken, and time may not pass"
        case _:
            return ""


@dataclass(frozen=True, slots=True)
class _Result:
    """The result of the searches for a query."""

    # whether a run shows that the query holds (`E<>`), or that it does not (`A[]`)
    shows: bool
    run: Run | None  # that run; `None` if there is none
    chosen: Policy | None = None  # the policy that chose the run, if there was a choice
    holds: bool | None = None  # whether the query holds, if no single run can show it


def _search(question: _Question, query: nta.Query) -> _Result:
    match query.formula:
        case nta.LeadsToFormula(left, right):
            if guards.is_linear(left) or guards.is_linear(right):
                check_linear(ex.PathFormula(ex.PathOp.EVENTUALLY, left), query.span)
        case nta.Extremes():
            fix = "`rvmon verify` answers it, as does `extremes`"
            raise model_error("TA020", "this query gives a value, not a decision", query.span, fix)
        case nta.Chance() | nta.Mean() | nta.Simulation():
            fix = "simulate it: `rvmon verify` does, as does `sample`"
            message = "a statistical query gives an estimate, not a decision"
            raise model_error("TA020", message, query.span, fix)
        case formula if guards.is_linear(formula):
            return _on_runs(question, query, formula)
    match query.formula:
        case nta.LeadsToFormula(left, right, bound):
            if guards.is_plain(left) and guards.is_plain(right):
                return _Result(False, _unanswered(question, left, right, bound))
            answered = ex.PathFormula(ex.PathOp.EVENTUALLY, right, bound)
            implied = ex.BinaryOperation(ex.BinaryOp.IMPLY, left, answered)
            return _at_start(question, ex.PathFormula(ex.PathOp.INVARIANTLY, implied))
        case ex.PathFormula(op, body, None, until) if (
            until != ex.TRUE
            and op in ex.OUTERMOST
            and guards.is_plain(body)
            and guards.is_plain(until)
        ):
            shows = op in (ex.PathOp.POSSIBLY, ex.PathOp.POTENTIALLY_ALWAYS)
            ends = op in (ex.PathOp.POSSIBLY, ex.PathOp.EVENTUALLY)
            on_run = ex.PathOp.FINALLY if ends else ex.PathOp.GLOBALLY
            linear = guards.normal_form(ex.PathFormula(on_run, body, None, until), positive=shows)
            return _Result(shows, _accepted(question, linear, query.span))
        case ex.PathFormula(op, body, bound, until) if until == ex.TRUE and op in ex.OUTERMOST:
            if op in (ex.PathOp.POSSIBLY, ex.PathOp.POTENTIALLY_ALWAYS):
                sought, shows = guards.normal_form(body), True
            else:
                sought, shows = guards.normal_form(body, positive=False), False
            match op:
                case ex.PathOp.POSSIBLY | ex.PathOp.INVARIANTLY if (
                    guards.has_paths(sought) and bound is None
                ):
                    return _reach_nested(question, sought, shows)
                case ex.PathOp.POSSIBLY | ex.PathOp.INVARIANTLY if guards.is_plain(sought):
                    return _Result(shows, *_reach(question, sought, bound))
                case ex.PathOp.POSSIBLY | ex.PathOp.INVARIANTLY if not guards.has_paths(sought):
                    alive, dead = (guards.with_deadlock(sought, value=v) for v in (False, True))
                    run = question.run(Sought(Seek.DEADLOCK, alive, dead, bound=bound))
                    return _Result(shows, run)
                case ex.PathOp.EVENTUALLY | ex.PathOp.POTENTIALLY_ALWAYS if guards.is_plain(sought):
                    return _Result(shows, _staying(question, None, sought, bound))
                case _:
                    return _at_start(question, query.formula)
        case formula if guards.has_paths(formula):
            return _at_start(question, formula)
        case _:
            fix = "start it with E<>, A[], A<> or E[], or write p --> q"
            raise model_error("TA020", "a query refers to runs", query.span, fix)


def _at_start(question: _Question, formula: ex.Expression) -> _Result:
    """Decide at the start a formula with path operators, which no single run can show."""
    # A backward search does not notice runs that leave the range of a variable, so a forward
    # search comes first.
    question.run(Sought(Seek.GOAL, ex.FALSE))
    if not question.meter.stopped:
        found = question.run(Sought(Seek.START, nested=guards.normal_form(formula))) is not None
        if found or not question.meter.stopped:
            return _Result(True, None, holds=found)
    return _Result(True, None)


# Reachability.


def _lasting_part(parts: Sequence[ex.Expression]) -> ex.PathFormula | None:
    """The only part with path operators, if it is `E[]` of a plain formula."""
    match [part for part in parts if guards.has_paths(part)]:
        case [ex.PathFormula(ex.PathOp.POTENTIALLY_ALWAYS, body, _, left) as lasting] if (
            left == ex.TRUE and guards.is_plain(body)
        ):
            return lasting
        case _:
            return None


def _reach(
    question: _Question, formula: ex.Expression, within: int | None
) -> tuple[Run | None, Policy | None]:
    """Find a run to a normalised formula; the shortest one if the search by policy is stopped.

    Returns:
        The run and how it was chosen, or two `None`.
    """
    sought = Sought(Seek.GOAL, formula, bound=within)
    run = question.run(sought)
    if run is None:
        return None, None
    if question.policy is not Policy.SHORTEST:
        best = question.run(replace(sought, choose=question.policy))
        if best is not None:
            return best, question.policy
    return run, Policy.SHORTEST


def _reach_nested(question: _Question, formula: ex.Expression, shows: bool) -> _Result:
    """Find a run to a formula with path operators, separately for each of its alternatives."""
    run = None
    for parts in guards.distributed(formula, lambda part: not guards.has_paths(part)):
        lasting = _lasting_part(parts)
        first = [part for part in parts if part is not lasting]
        if lasting is None or not all(map(guards.is_plain, first)):
            run = question.run(Sought(Seek.NESTED, nested=guards.conjunction(parts)))
        else:
            away = guards.normal_form(lasting.body, positive=False)
            run = _unanswered(question, guards.conjunction(first), away, lasting.bound)
        if run is not None or question.meter.stopped:
            break
    return _Result(shows, run)


# Staying.


def _unanswered(
    question: _Question, left: ex.Expression, right: ex.Expression, bound: int | None
) -> Run | None:
    """Find a run with `left` after which `right` never holds, or not within the bound."""
    inside = guards.normal_form(guards.normal_form(right), positive=False)
    return _staying(question, guards.normal_form(left), inside, bound)


def _staying(
    question: _Question, first: ex.Expression | None, inside: ex.Expression, bound: int | None
) -> Run | None:
    """Find a run that stays inside, from the start or from a state with `first`."""
    network, meter = question.network, question.meter
    if bound is not None:
        late = Seek.LATE if first is None else Seek.LATE_AFTER
        run = question.run(Sought(late, first, inside, bound=bound))
        if run is not None or meter.stopped:
            return run
    sought = Sought(Seek.STAY if first is None else Seek.STAY_AFTER, first, inside)
    # Prefer a run on which time diverges. Only if there is none, accept one on which time stops.
    answer = seek(network, sought, meter, proper_only=True)
    if answer.run is None and not meter.stopped and answer.improper:
        answer = seek(network, sought, meter)
    return answer.run


# Acceptance by an automaton.


def _on_runs(question: _Question, query: nta.Query, formula: ex.Expression) -> _Result:
    """Decide whether all runs satisfy an LTL formula, or (`E`) some run does."""
    body, shows = formula, False
    if isinstance(formula, ex.PathFormula) and formula.op in (
        ex.PathOp.EVERY_RUN,
        ex.PathOp.SOME_RUN,
    ):
        body, shows = formula.body, formula.op is ex.PathOp.SOME_RUN
    check_linear(body, query.span)
    return _Result(shows, _accepted(question, guards.normal_form(body, positive=shows), query.span))


def _accepted(question: _Question, formula: ex.Expression, span: Span | None) -> Run | None:
    """Find a run that satisfies a normalised LTL formula, preferably one on which time diverges."""
    sought = Sought(Seek.RUN, automaton=buchi_of(formula, span))
    run = question.run(sought)
    # Real systems cannot stop time, so a run on which time diverges is more convincing.
    if run is not None and run.ending in (Ending.ZENO_LOOP, Ending.TIME_LOCK):
        better = question.run(replace(sought, progress=True))
        return run if better is None else better
    return run
