"""The discrete side of a network: states of locations and variables, and the moves between them."""

from __future__ import annotations

from dataclasses import dataclass, field

from rvmon.errors import ModelError
from rvmon.timed.model.evaluate import Evaluator
from rvmon.timed.zones.clock_bounds import ClockBounds
from rvmon.timed.zones.compile import AtomMaker, CompiledEdge
from rvmon.timed.zones.dbm import Atom


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
        bounds: the numbers that clocks may still be compared with.
        uppers, lowers: the same in the form that `zones.cover_test` takes.
    """

    locations: tuple[int, ...]
    committed: frozenset[int]
    stops_time: bool
    candidates: tuple[Candidate, ...]
    broadcasts: tuple[Broadcast, ...]
    urgent: tuple[Candidate, ...]
    invariant_data: tuple[Evaluator, ...]
    invariant_atoms: tuple[AtomMaker, ...]
    bounds: ClockBounds
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
