"""Answers queries: each kind of query becomes the search that is sound for it."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import assert_never

from rvmon.timed.language.elaborate import query_on
from rvmon.timed.model.expressions import Expression, PathFormula
from rvmon.timed.model.guards import normal_form
from rvmon.timed.model.network import LeadsToFormula, Network, Query
from rvmon.timed.model.operators import PathOp
from rvmon.timed.model.rules import model_error
from rvmon.timed.runs.paths import PathStep, mark_step
from rvmon.timed.runs.run import Ending, Run
from rvmon.timed.search.ctl import is_decidable
from rvmon.timed.search.explore import explore, explore_best
from rvmon.timed.search.liveness import Escape, Staying
from rvmon.timed.search.meter import Meter, paused_collector
from rvmon.timed.search.nested import NestedReachability, alternatives, lasting_part, together
from rvmon.timed.search.outcome import Outcome, Policy
from rvmon.timed.search.problem import UNLIMITED, Budget, Found, Node, Watch
from rvmon.timed.search.reach import DeadlockReachability, Reachability
from rvmon.timed.search.respond import BoundedResponse, UnboundedResponse
from rvmon.timed.search.witness import (
    bounded_path,
    escape_path,
    make_run,
    plain_path,
    state_of,
)
from rvmon.timed.zones.dbm import Zone, cut, zero
from rvmon.timed.zones.deadlock import check_start
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.stay import Inside
from rvmon.timed.zones.symbolic import Steps, lowest
from rvmon.timed.zones.zone_unions import (
    Constraint,
    constraint_maker,
    has_paths,
    speaks_of_deadlock,
)


@dataclass(frozen=True, slots=True)
class _Question:
    """What all searches for one query share."""

    network: Network
    meter: Meter
    policy: Policy


def verify(
    network: Network,
    query: Query | str,
    *,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
    policy: Policy = Policy.SHORTEST,
) -> Outcome:
    """Decide a query, with a run that shows why.

    Args:
        network: what the query asks about.
        query: as resolved, or as text.
        budget: when to give up undecided.
        watch: called now and then.
        policy: which run to show for `E<>` and `A[]`, if several do.

    Raises:
        ModelError: the query is none that can be decided, or the network cannot start, or a run
            of it leaves a variable's range.
    """
    asked = query_on(network, query) if isinstance(query, str) else query
    check_start(network)
    question = _Question(network, Meter(budget, watch), policy)
    with paused_collector():
        shows, run, chosen = _search(question, asked)
    meter = question.meter
    holds = None if run is None and meter.stopped else (run is not None) == shows
    remark = f"not decided: {meter.stopped}" if holds is None else _remark(run)
    if run is not None and chosen not in (None, policy):
        remark = f"no {policy} run was found: {meter.stopped}"
    return Outcome(asked, holds, run, chosen, meter.statistics(), remark)


def _remark(run: Run | None) -> str:
    match run:
        case Run(ending=Ending.ZENO_LOOP):
            return "only by a Zeno loop: it goes round without end while time does not pass"
        case Run(ending=Ending.TIME_LOCK):
            return "time stops here: no edge can be taken, and time may not pass"
        case _:
            return ""


def _search(question: _Question, query: Query) -> tuple[bool, Run | None, Policy | None]:
    """Look for a run that decides a query.

    Returns:
        Whether a run shows that the query holds (else that it does not); the run, `None` if there
        is none; the policy that chose it, if there was a choice.
    """
    match query.formula:
        case LeadsToFormula(left, right, bound):
            _refuse_nests(query, left, right)
            _refuse_deadlock(query, left, right)
            return False, _unanswered(question, left, right, bound), None
        case PathFormula(op, body, bound):
            if op in (PathOp.POSSIBLY, PathOp.POTENTIALLY_ALWAYS):
                sought, shows = normal_form(body), True
            else:
                sought, shows = normal_form(body, positive=False), False
            match op:
                case PathOp.POSSIBLY | PathOp.INVARIANTLY if has_paths(sought):
                    return shows, _reach_nested(question, query, sought, bound), None
                case PathOp.POSSIBLY | PathOp.INVARIANTLY if speaks_of_deadlock(sought):
                    return shows, _reach_deadlock(question, sought, bound), None
                case PathOp.POSSIBLY | PathOp.INVARIANTLY:
                    return shows, *_reach(question, sought, bound)
                case PathOp.EVENTUALLY | PathOp.POTENTIALLY_ALWAYS:
                    _refuse_nests(query, sought)
                    _refuse_deadlock(query, sought)
                    return shows, _avoidance(question, sought, bound), None
                case _:
                    assert_never(op)
        case _:
            fix = "begin it with E<>, A[], A<> or E[], or write p --> q"
            raise model_error("TA020", "a query speaks of runs", query.span, fix)


def _refuse_nests(query: Query, *parts: Expression) -> None:
    if any(has_paths(part) for part in parts):
        message = "path operators inside this one are not decided"
        fix = "inside E<> and A[] are decided: E<> and A[], and A[] (p imply A<> q)"
        raise model_error("TA020", message, query.span, fix)


def _refuse_deadlock(query: Query, *parts: Expression) -> None:
    if any(speaks_of_deadlock(part) for part in parts):
        fix = "ask for it with E<> or A[]"
        raise model_error("TA020", "`deadlock` can only be reached", query.span, fix)


# Reaching.


def _reach(
    question: _Question, formula: Expression, within: int | None
) -> tuple[Run | None, Policy | None]:
    """A run to a normalised formula, as the policy chooses it, or the shortest if that ends early.

    Returns:
        The run and how it was chosen; twice `None` if there is none.
    """
    network, meter = question.network, question.meter
    found = explore(Reachability(network, formula, within=within), meter)
    if found.node is None or found.constraint is None:
        return None, None
    best = None
    if question.policy is not Policy.SHORTEST:
        best = _best(question, formula, within)
    if best is None or best.node is None or best.constraint is None:
        return _run_to(network, found.node, found.constraint), Policy.SHORTEST
    return _run_to(network, best.node, best.constraint), question.policy


def _best(question: _Question, formula: Expression, within: int | None) -> Found[State, Move]:
    """The end of the run that is fastest or likeliest."""
    fastest = question.policy is Policy.FASTEST
    problem = Reachability(question.network, formula, within=within, timed=fastest)
    if not fastest:
        return explore_best(
            problem, _unlikeliness, lambda before, _zone, _piece: before, question.meter
        )
    timer, dim = problem.timer, problem.dim
    return explore_best(
        problem,
        lambda _before, _move, zone: lowest(zone, dim, timer),
        lambda _before, zone, constraint: _earliest_in(zone, dim, constraint, timer),
        question.meter,
    )


def _run_to(network: Network, node: Node[State, Move], constraint: Constraint) -> Run:
    steps = plain_path(node)
    if constraint:
        steps.append(mark_step(node.site, constraint))
    return make_run(network, node.path()[0].site, steps)


def _earliest_in(zone: Zone, dim: int, constraint: Constraint, timer: int) -> float:
    inside = zone[:]
    cut(inside, dim, constraint)
    return lowest(inside, dim, timer)


def _unlikeliness(before: float, move: Move | None, _zone: Zone) -> float:
    if move is None:
        return before
    return before - sum(log(edge.edge.weight) for edge in move.edges)


def _reach_deadlock(question: _Question, formula: Expression, within: int | None) -> Run | None:
    problem = DeadlockReachability(question.network, formula, within=within)
    found = explore(problem, question.meter)
    if found.node is None or found.constraint is None:
        return None
    last = found.node.site
    steps = [*plain_path(found.node), mark_step(last, found.constraint)]
    start, ending = found.node.path()[0].site, problem.ending(last, found.constraint)
    return make_run(question.network, start, steps, ending)


def _reach_nested(
    question: _Question, query: Query, formula: Expression, bound: int | None
) -> Run | None:
    """A run to a formula that speaks of runs from there; each alternative is sought by itself."""
    network, meter = question.network, question.meter
    if bound is not None or speaks_of_deadlock(formula):
        _refuse_nests(query, formula)
    chosen = alternatives(formula)
    for parts in chosen:
        if not (is_decidable(together(parts)) or lasting_part(parts)):
            _refuse_nests(query, formula)
    for parts in chosen:
        lasting = lasting_part(parts)
        if lasting is None:
            problem = NestedReachability(network, together(parts), meter)
            found = explore(problem, meter)
            run = None
            if found.node is not None and found.constraint is not None:
                run = _run_to(network, found.node, found.constraint)
        else:
            first = together(part for part in parts if part is not lasting)
            away = normal_form(lasting.body, positive=False)
            run = _unanswered(question, first, away, lasting.bound)
        if run is not None or meter.stopped:
            return run
    return None


# Staying away.


def _avoidance(question: _Question, formula: Expression, bound: int | None) -> Run | None:
    """A run that stays inside a normalised formula for ever, or until the bound is over."""
    network, meter = question.network, question.meter
    if bound is not None:
        late = BoundedResponse(network, None, normal_form(formula, positive=False), bound)
        run = _late_run(network, late, meter)
        if run is not None or meter.stopped:
            return run
    for proper_only in (True, False):
        steps = Steps(network, formula)
        inside = Inside(steps.space, constraint_maker(formula))
        staying = Staying(inside, meter, proper_only=proper_only)
        state = steps.space.initial()
        assert state is not None  # noqa: S101 - the network can start
        for stand in inside.enter(state, zero(steps.dim)):
            escape = staying.find(stand)
            if escape is not None:
                return _escape_run(network, state, escape, staying, [], steps.dim)
        if meter.stopped or not staying.met_improper:
            return None
    return None


def _unanswered(
    question: _Question, left: Expression, right: Expression, bound: int | None
) -> Run | None:
    """A run on which `left` holds, but `right` not from there on, or not within the bound."""
    network, meter = question.network, question.meter
    left, right = normal_form(left), normal_form(right)
    if bound is not None:
        run = _late_run(network, BoundedResponse(network, left, right, bound), meter)
        if run is not None or meter.stopped:
            return run
    for proper_only in (True, False):
        problem = UnboundedResponse(network, left, right, meter, proper_only=proper_only)
        found = explore(problem, meter)
        if found.node is not None and found.constraint is not None and problem.escape is not None:
            stem = [*plain_path(found.node), mark_step(found.node.site, found.constraint)]
            start = found.node.path()[0].site
            return _escape_run(network, start, problem.escape, problem.staying, stem, problem.dim)
        if meter.stopped or not problem.staying.met_improper:
            return None
    return None


def _late_run(network: Network, problem: BoundedResponse, meter: Meter) -> Run | None:
    found = explore(problem, meter)
    if found.node is None or found.constraint is None:
        return None
    steps = bounded_path(found.node, problem.timer)
    last = found.node.site
    steps.append(mark_step(state_of(last), found.constraint))
    return make_run(network, state_of(found.node.path()[0].site), steps)


def _escape_run(
    network: Network,
    start: State,
    escape: Escape,
    staying: Staying,
    stem: list[PathStep],
    dim: int,
) -> Run:
    steps = escape_path(escape, staying, stem, dim)
    loop = escape.loop
    if loop is not None:
        # Crossings and the stem stand before the loop's first move too.
        loop = len(escape_path(escape.until(loop), staying, stem, dim))
    return make_run(network, start, steps, escape.ending, loop)
