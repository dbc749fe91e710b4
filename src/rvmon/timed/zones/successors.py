"""From a discrete state to the next ones; each state and vector is worked out once.

The rules: all guards are read before the step; the sender's update comes first, then the receivers'
in the order of the automata; while some location is committed, only steps in which a committed
location is left are taken; a broadcast takes along every automaton that can receive, which clocks
may decide; a step waits for those of higher priority that can be taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from math import inf

from rvmon.errors import ModelError
from rvmon.timed.model.evaluate import Evaluator, Frame
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import LocationKind
from rvmon.timed.zones.clock_bounds import ClockBounds, joined, location_bounds
from rvmon.timed.zones.dbm import Atom, negated
from rvmon.timed.zones.discrete import (
    AtomMaker,
    Broadcast,
    Candidate,
    CompiledEdge,
    Move,
    State,
    Vector,
    atoms_of,
    compile_edge,
    data_of,
)


class Space:
    """All discrete states met so far.

    Args:
        network: whose states they are.
        observers: number of clocks of queries, counted behind those of the network.
        uppers: upper bounds of those, as `zones.cover_test` takes them.
        lowers: their lower bounds, likewise.
    """

    def __init__(
        self,
        network: Network,
        observers: int = 0,
        uppers: Sequence[tuple[int, float]] = (),
        lowers: Sequence[tuple[int, float]] = (),
    ) -> None:
        self.network = network
        self.dim = 1 + len(network.clocks) + observers
        self._uppers, self._lowers = tuple(uppers), tuple(lowers)
        self._vectors: dict[tuple[int, ...], Vector] = {}
        self._states: dict[tuple[tuple[int, ...], tuple[int, ...]], State] = {}
        self._edges: list[list[list[CompiledEdge]]] = []
        self._invariants: list[list[tuple[Evaluator | None, AtomMaker]]] = []
        self._bounds: list[list[ClockBounds]] = []
        for index, automaton in enumerate(network.automata):
            leaving: list[list[CompiledEdge]] = [[] for _ in automaton.locations]
            for number, edge in enumerate(automaton.edges):
                leaving[edge.source].append(compile_edge(network, index, number))
            self._edges.append(leaving)
            self._invariants.append(
                [
                    (data_of(place.invariant), atoms_of(place.invariant.clocks, place.span))
                    for place in automaton.locations
                ]
            )
            self._bounds.append(location_bounds(network, automaton))

    def __len__(self) -> int:
        return len(self._states)

    def initial(self) -> State | None:
        """The initial state; `None` if an invariant forbids the variables' initial values."""
        locations = tuple(automaton.initial for automaton in self.network.automata)
        return self.state(locations, tuple(v.initial for v in self.network.variables))

    def state(self, locations: tuple[int, ...], values: tuple[int, ...]) -> State | None:
        """The state of some locations and values; `None` if its invariant forbids the values."""
        key = (locations, values)
        state = self._states.get(key)
        if state is None:
            vector = self._vectors.get(locations) or self._new_vector(locations)
            if not all(holds(locations, values) for holds in vector.invariant_data):
                return None
            state = self._states[key] = _new_state(vector, values)
        return state

    def moves(self, state: State) -> list[Move]:
        """All steps from a state whose guards on variables hold."""
        if state.moves is None:
            enabled = list(_enabled(state))
            state.moves = [
                move
                for edges, target, kept_back in enabled
                for move in self._variants(state, edges, target, kept_back)
            ]
            if self.network.priorities is not None:
                state.moves = list(self._first(state, enabled, state.moves))
        return state.moves

    def _variants(
        self,
        state: State,
        edges: tuple[CompiledEdge, ...],
        target: tuple[int, ...],
        kept_back: Iterable[Sequence[Atom]],
    ) -> Iterator[Move]:
        """A move for each choice of the bounds that fail."""
        for variant, without in enumerate(product(*kept_back)):
            move = self._move(state, edges, target, variant, without)
            if move is not None:
                yield move

    def _first(
        self, state: State, enabled: Iterable[Enabled], moves: Iterable[Move]
    ) -> Iterator[Move]:
        """The moves, kept back where those of higher rank can be taken."""
        blockers = [
            (self._rank(m.edges, state), needs)
            for m in moves
            if (needs := _needs(state, m)) is not None
        ]
        for edges, target, kept_back in enabled:
            rank = self._rank(edges, state)
            above = dict.fromkeys(needs for other, needs in blockers if other > rank)
            denied = [[negated(atom) for atom in needs] for needs in above]
            yield from self._variants(state, edges, target, [*kept_back, *denied])

    def _rank(self, edges: tuple[CompiledEdge, ...], state: State) -> int:
        assert self.network.priorities is not None, "asked of such networks only"
        channel = edges[0].channel
        number = None if channel is None else channel(state.vector.locations, state.values)
        return self.network.priorities.rank(number, (edge.automaton for edge in edges))

    def _move(
        self,
        state: State,
        edges: tuple[CompiledEdge, ...],
        target: tuple[int, ...],
        variant: int,
        without: tuple[Atom, ...],
    ) -> Move | None:
        locations, values = state.vector.locations, state.values
        guard = tuple(atom for edge in edges for atom in edge.atoms(locations, values))
        guard += without
        clocks: dict[int, int] = {}
        if any(edge.updates for edge in edges):
            frame = Frame(values, len(self.network.locals))
            try:
                for edge in edges:
                    if edge.updates is not None:
                        edge.updates(locations, frame)
            except ModelError as error:
                return Move(edges, guard, (), state, variant, error)
            values, clocks = frame.variables(), frame.clocks
        behind = self.state(target, values)
        if behind is None:
            return None
        resets = tuple((clock + 1, float(value)) for clock, value in clocks.items())
        return Move(edges, guard, resets, behind, variant)

    def _new_vector(self, locations: tuple[int, ...]) -> Vector:
        automata = self.network.automata
        kinds = [
            automaton.locations[place].kind
            for automaton, place in zip(automata, locations, strict=True)
        ]
        committed = frozenset(i for i, kind in enumerate(kinds) if kind is LocationKind.COMMITTED)
        leaving = [self._edges[i][place] for i, place in enumerate(locations)]
        invariants = [self._invariants[i][place] for i, place in enumerate(locations)]
        bounds = joined(self._bounds[i][place] for i, place in enumerate(locations))
        candidates = list(self._candidates(locations, leaving))
        broadcasts = list(self._broadcasts(leaving))
        urgent = [c for c in candidates if self._is_urgent(c.edges[0])] + [
            _alone(b.sender, locations) for b in broadcasts if self._is_urgent(b.sender)
        ]
        if committed:
            candidates = [c for c in candidates if any(e.automaton in committed for e in c.edges)]
        vector = Vector(
            locations,
            committed,
            any(kind is not LocationKind.NORMAL for kind in kinds),
            tuple(candidates),
            tuple(broadcasts),
            tuple(urgent),
            tuple(data for data, _ in invariants if data is not None),
            tuple(atoms for _, atoms in invariants),
            ((0, 0.0), *((c + 1, -float(u)) for c, u in bounds.upper.items()), *self._uppers),
            ((0, 0.0), *((c + 1, float(low)) for c, low in bounds.lower.items()), *self._lowers),
        )
        self._vectors[locations] = vector
        return vector

    def _is_urgent(self, edge: CompiledEdge) -> bool:
        return bool(edge.channels) and self.network.channels[edge.channels[0]].urgent

    def _is_broadcast(self, edge: CompiledEdge) -> bool:
        return bool(edge.channels) and self.network.channels[edge.channels[0]].broadcast

    def _candidates(
        self, locations: tuple[int, ...], leaving: Sequence[Sequence[CompiledEdge]]
    ) -> Iterator[Candidate]:
        for edges in leaving:
            for edge in edges:
                if edge.channel is None:
                    yield _alone(edge, locations)
                elif _sends(edge) and not self._is_broadcast(edge):
                    for receiver in _receivers(edge, leaving):
                        yield _pair(edge, receiver, locations)

    def _broadcasts(self, leaving: Sequence[Sequence[CompiledEdge]]) -> Iterator[Broadcast]:
        for edges in leaving:
            for edge in edges:
                if _sends(edge) and self._is_broadcast(edge):
                    groups: dict[int, list[CompiledEdge]] = {}
                    for receiver in _receivers(edge, leaving):
                        groups.setdefault(receiver.automaton, []).append(receiver)
                    yield Broadcast(edge, tuple(map(tuple, groups.values())))


def _sends(edge: CompiledEdge) -> bool:
    return edge.edge.sync is not None and edge.edge.sync.sends


def _receivers(
    sender: CompiledEdge, leaving: Iterable[Iterable[CompiledEdge]]
) -> Iterator[CompiledEdge]:
    for edges in leaving:
        for edge in edges:
            if edge.automaton == sender.automaton or edge.channel is None or _sends(edge):
                continue
            first, second = sender.channels, edge.channels
            if first.start < second.stop and second.start < first.stop:
                yield edge


def _alone(edge: CompiledEdge, locations: tuple[int, ...]) -> Candidate:
    tests = () if edge.data is None else (edge.data,)
    return Candidate((edge,), tests, False, _behind(locations, (edge,)))


def _pair(sender: CompiledEdge, receiver: CompiledEdge, locations: tuple[int, ...]) -> Candidate:
    edges = (sender, receiver)
    tests = tuple(edge.data for edge in edges if edge.data is not None)
    chosen = len(sender.channels) > 1 or len(receiver.channels) > 1
    return Candidate(edges, tests, chosen, _behind(locations, edges))


def _behind(locations: tuple[int, ...], edges: Iterable[CompiledEdge]) -> tuple[int, ...]:
    changed = list(locations)
    for edge in edges:
        changed[edge.automaton] = edge.edge.target
    return tuple(changed)


def _new_state(vector: Vector, values: tuple[int, ...]) -> State:
    tightest: dict[int, float] = {}
    for make in vector.invariant_atoms:
        for _, clock, bound in make(vector.locations, values):
            tightest[clock] = min(bound, tightest.get(clock, inf))
    delays = not (vector.stops_time or any(_is_enabled(c, vector, values) for c in vector.urgent))
    invariant = tuple(sorted(tightest.items()))
    return State(vector, values, delays, invariant, vector.uppers, vector.lowers)


def _needs(state: State, move: Move) -> tuple[Atom, ...] | None:
    """The bounds under which a move can be taken, or fails; `None` if it never can."""
    if move.failure is not None:
        return move.guard
    needs, here, set_now = list(move.guard), dict(state.invariant), dict(move.resets)
    for clock, bound in move.target.invariant:
        if clock in set_now:
            if set_now[clock] > bound:
                return None
        elif bound < here.get(clock, inf):
            needs.append((0, clock, bound))
    return tuple(needs)


def _is_enabled(candidate: Candidate, vector: Vector, values: tuple[int, ...]) -> bool:
    locations = vector.locations
    for test in candidate.tests:
        if not test(locations, values):
            return False
    if candidate.chosen:
        sender, receiver = candidate.edges
        return _meet(sender, receiver, locations, values)
    return True


def _meet(
    sender: CompiledEdge,
    receiver: CompiledEdge,
    locations: tuple[int, ...],
    values: tuple[int, ...],
) -> bool:
    assert sender.channel is not None, "both ends have a channel"
    assert receiver.channel is not None, "both ends have one"
    return sender.channel(locations, values) == receiver.channel(locations, values)


Enabled = tuple[tuple[CompiledEdge, ...], tuple[int, ...], list[list[Atom]]]
"""Edges that move together, the locations behind, and for each edge that must be kept back what
does so: any of these bounds."""


def _enabled(state: State) -> Iterator[Enabled]:
    """What may move from a state, whatever the clocks say."""
    vector, values = state.vector, state.values
    for candidate in vector.candidates:
        if _is_enabled(candidate, vector, values):
            yield candidate.edges, candidate.target, []
    locations = vector.locations
    for broadcast in vector.broadcasts:
        sender = broadcast.sender
        if sender.data is not None and not sender.data(locations, values):
            continue
        groups: list[list[CompiledEdge | None]] = []
        for group in broadcast.receivers:
            able: list[CompiledEdge | None] = [
                edge
                for edge in group
                if (edge.data is None or edge.data(locations, values))
                and _meet(sender, edge, locations, values)
            ]
            if all(edge is not None and edge.edge.guard.clocks for edge in able):
                able.append(None)
            groups.append(able)
        for chosen in product(*groups):
            edges = (sender, *(edge for edge in chosen if edge is not None))
            if vector.committed and not any(e.automaton in vector.committed for e in edges):
                continue
            kept_back = [
                [negated(atom) for atom in edge.atoms(locations, values)]
                for group, one in zip(groups, chosen, strict=True)
                if one is None
                for edge in group
                if edge is not None
            ]
            yield edges, _behind(locations, edges), kept_back
