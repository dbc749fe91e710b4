"""The same network in a finer unit of time."""

from __future__ import annotations

from dataclasses import replace

from rvmon.timed.model.expressions import (
    BinaryOperation,
    ClockCompare,
    Constant,
    Expression,
    Invoke,
    Reset,
    Statement,
    expressions_of,
    statements_in,
)
from rvmon.timed.model.guards import parts_of
from rvmon.timed.model.network import Automaton, Edge, Guard, Location, Network
from rvmon.timed.model.operators import BinaryOp
from rvmon.timed.model.rules import model_error


def finer(network: Network, factor: int) -> Network:
    """A network whose unit of time is so many times smaller, and whose runs are the same.

    Its queries are left out, since they would speak of the old unit.
    """
    return replace(
        network,
        unit=None if network.unit is None else network.unit // factor,
        automata=tuple(_automaton(automaton, factor) for automaton in network.automata),
        queries=(),
    )


def _automaton(automaton: Automaton, factor: int) -> Automaton:
    return replace(
        automaton,
        locations=tuple(_location(location, factor) for location in automaton.locations),
        edges=tuple(_edge(edge, factor) for edge in automaton.edges),
    )


def _location(location: Location, factor: int) -> Location:
    return replace(location, invariant=_guard(location.invariant, factor))


def _edge(edge: Edge, factor: int) -> Edge:
    updates = tuple(_update(update, factor) for update in edge.updates)
    return replace(edge, guard=_guard(edge.guard, factor), updates=updates)


def _update(update: Statement, factor: int) -> Statement:
    if isinstance(update, Reset):
        return replace(update, value=_times(update.value, factor))
    if _sets_clocks(update):
        fix = "set clocks in the updates of edges, not in functions"
        raise model_error("TA016", "a function sets a clock to a number of units", None, fix)
    return update


def _sets_clocks(update: Statement) -> bool:
    """Whether functions that an update calls set clocks to more than 0."""
    for statement in statements_in([update]):
        if isinstance(statement, Reset) and statement.value != Constant(0):
            return True
        calls = (part for e in expressions_of(statement) for part in parts_of(e))
        for part in calls:
            if isinstance(part, Invoke) and any(map(_sets_clocks, part.function.body)):
                return True
    return False


def _guard(guard: Guard, factor: int) -> Guard:
    return Guard(
        guard.data,
        tuple(ClockCompare(one.clock, one.op, _times(one.bound, factor)) for one in guard.clocks),
    )


def _times(number: Expression, factor: int) -> Expression:
    if isinstance(number, Constant):
        return Constant(number.value * factor)
    return BinaryOperation(BinaryOp.MUL, number, Constant(factor))
