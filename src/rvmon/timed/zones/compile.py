"""Edges and locations ready to be tried: closures over the variables, clock bounds as numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import prod

from rvmon.diagnostics import Span
from rvmon.timed.model.arithmetic import check_time
from rvmon.timed.model.evaluate import (
    Evaluator,
    Locations,
    Runner,
    Values,
    evaluator,
    runner,
    slot_evaluator,
)
from rvmon.timed.model.expressions import TRUE, ClockCompare, ClockOp, Constant
from rvmon.timed.model.network import Edge, Guard, Network
from rvmon.timed.zones.dbm import Atom, bound_of

AtomMaker = Callable[[Locations, Values], list[Atom]]
"""The clock bounds of a guard or invariant, given the variables."""


@dataclass(frozen=True, slots=True)
class CompiledEdge:
    """An edge of one automaton.

    Attributes:
        automaton: its index.
        number: of the edge in the automaton.
        edge: the edge itself.
        data: its guard on the variables; `None` if there is none.
        atoms: its clock bounds.
        channel: gives the index of the channel; `None` without synchronisation.
        channels: all channels that it may be; one unless the variables choose.
        updates: runs them; `None` if there are none.
    """

    automaton: int
    number: int
    edge: Edge
    data: Evaluator | None
    atoms: AtomMaker
    channel: Evaluator | None
    channels: range
    updates: Runner | None


def compile_edge(network: Network, automaton: int, number: int) -> CompiledEdge:
    """Make an edge, given by its automaton and its number there, ready to be tried."""
    edge = network.automata[automaton].edges[number]
    channel, channels = None, range(0)
    if edge.sync is not None:
        slot = edge.sync.slot
        channel = slot_evaluator(slot)
        channels = range(slot.first, slot.first + prod(map(len, slot.extents)))
    return CompiledEdge(
        automaton,
        number,
        edge,
        data_of(edge.guard),
        atoms_of(edge.guard.clocks, edge.span),
        channel,
        channels,
        runner(edge.updates) if edge.updates else None,
    )


def data_of(guard: Guard) -> Evaluator | None:
    """A guard's condition on the variables; `None` if it always holds."""
    return None if guard.data == TRUE else evaluator(guard.data)


def atoms_of(compares: Sequence[ClockCompare], span: Span | None) -> AtomMaker:
    """A function that gives the bounds of some comparisons as entries of a zone."""
    if all(isinstance(compare.bound, Constant) for compare in compares):
        fixed = [
            atom_of(compare, compare.bound.value)
            for compare in compares
            if isinstance(compare.bound, Constant)
        ]
        return lambda _locations, _values: fixed
    bounds = [(compare, evaluator(compare.bound)) for compare in compares]

    def atoms(locations: Locations, values: Values) -> list[Atom]:
        return [
            atom_of(compare, check_time(bound(locations, values), span))
            for compare, bound in bounds
        ]

    return atoms


def atom_of(compare: ClockCompare, number: int) -> Atom:
    """A comparison with a number as an entry of a zone."""
    clock, strict = compare.clock + 1, compare.op in (ClockOp.LT, ClockOp.GT)
    if compare.op in (ClockOp.LT, ClockOp.LE):
        return 0, clock, bound_of(number, strict)
    return clock, 0, bound_of(-number, strict)
