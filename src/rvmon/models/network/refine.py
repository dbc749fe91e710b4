"""The same network in a finer unit of time."""

from __future__ import annotations

from dataclasses import replace

from rvmon.models.network.expressions import (
    BinaryOp,
    BinaryOperation,
    ClockCompare,
    Constant,
    Expression,
    Reset,
    Statement,
)
from rvmon.models.network.guards import resets_in
from rvmon.models.network.network import Automaton, Edge, Guard, Location, Network
from rvmon.models.network.rules import model_error


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
    if any(reset.value != Constant(0) for reset in resets_in([update])):
        fix = "set clocks in the updates of edges, not in functions"
        raise model_error("TA016", "a function sets a clock to a number of units", None, fix)
    return update


def _guard(guard: Guard, factor: int) -> Guard:
    return Guard(
        guard.data,
        tuple(
            ClockCompare(clock.clock, clock.op, _times(clock.bound, factor))
            for clock in guard.clocks
        ),
    )


def _times(number: Expression, factor: int) -> Expression:
    if isinstance(number, Constant):
        return Constant(number.value * factor)
    return BinaryOperation(BinaryOp.MUL, number, Constant(factor))
