"""Whether a run shows what the model checker says it shows, by the plain rules alone."""

from __future__ import annotations

from fractions import Fraction

from rvmon.models.network.expressions import Expression, PathFormula, PathOp
from rvmon.models.network.guards import has_paths, normal_form, speaks_of_deadlock, with_deadlock
from rvmon.models.network.network import LeadsToFormula, Network
from rvmon.models.runs.exact_times import (
    Configuration,
    Rules,
    initial_configuration,
)
from rvmon.models.runs.run import Run
from rvmon.models.search.budget import Outcome
from tests.tools.timed_regions import RegionGraph, truth_of

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
    if not speaks_of_deadlock(formula):
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
