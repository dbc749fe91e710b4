"""The discrete side of a network: states of locations and variables, and the moves between them.

Edges and locations are made ready to be tried: closures over the variables, bounds as numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from rvmon.diagnostics import Span
from rvmon.errors import ModelError
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


@dataclass(slots=True, eq=False)  # not frozen, as all that a search makes many of
class Candidate:
    """Edges that move together if the variables allow: one alone, or a sender and a receiver.

    Attributes:
        edges: the sender first.
        tests: their guards on the variables.
        chosen: whether the variables choose the channel, so that both ends must be compared.
        target: the locations behind.
    """

    edges: tuple[CompiledEdge, ...]
    tests: tuple[Evaluator, ...]
    chosen: bool
    target: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Broadcast:
    """A sender, and for each other automaton the edges that may receive from it."""

    sender: CompiledEdge
    receivers: tuple[tuple[CompiledEdge, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Vector:
    """What all states with the same locations share.

    Attributes:
        locations: of each automaton.
        committed: the automata in a committed location; one of them must move next, if any.
        stops_time: whether some location is committed or urgent.
        candidates, broadcasts: what may move.
        urgent: the candidates, and the senders of broadcasts, whose channel is urgent.
        invariant_data, invariant_atoms: of all locations.
        uppers, lowers: what clocks may still be compared with, as `dbm.cover_test` takes it.
    """

    locations: tuple[int, ...]
    committed: frozenset[int]
    stops_time: bool
    candidates: tuple[Candidate, ...]
    broadcasts: tuple[Broadcast, ...]
    urgent: tuple[Candidate, ...]
    invariant_data: tuple[Evaluator, ...]
    invariant_atoms: tuple[AtomMaker, ...]
    uppers: tuple[tuple[int, float], ...]
    lowers: tuple[tuple[int, float], ...]


@dataclass(slots=True, eq=False)
class State:
    """Locations and values of the variables; one object for each combination.

    Attributes:
        delays: whether time may pass here.
        invariant: `(clock, bound)`: upper bounds; clocks count from 1.
        uppers, lowers: of the vector.
        moves: the steps from here; `None` until `successors.moves_of` was asked.
    """

    vector: Vector
    values: tuple[int, ...]
    delays: bool
    invariant: tuple[tuple[int, float], ...]
    uppers: tuple[tuple[int, float], ...]
    lowers: tuple[tuple[int, float], ...]
    moves: list[Move] | None = field(default=None, repr=False)

    @property
    def is_time_bounded(self) -> bool:
        """Whether time cannot pass for ever."""
        return not self.delays or bool(self.invariant)


@dataclass(slots=True, eq=False)
class Move:
    """A step between two states.

    Attributes:
        edges: those that take part, the sender first.
        guard: clock bounds that must hold before.
        resets: clocks that are set and their values; clocks count from 1.
        target: the state behind.
        variant: among the ways in which the same edges move together.
        failure: what is wrong with its updates; raised only if the step can be taken.
    """

    edges: tuple[CompiledEdge, ...]
    guard: tuple[Atom, ...]
    resets: tuple[tuple[int, float], ...]
    target: State
    variant: int = 0
    failure: ModelError | None = None


def compile_edge(network: Network, automaton: int, number: int) -> CompiledEdge:
    """Make an edge, given by its automaton and its number there, ready to be tried."""
    edge = network.automata[automaton].edges[number]
    channel, channels = None, range(0)
    if edge.sync is not None:
        slot = edge.sync.slot
        channel = slot_evaluator(slot)
        channels = range(slot.first, slot.first + slot.size)
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
