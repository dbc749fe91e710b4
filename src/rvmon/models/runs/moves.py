"""Discrete states of a network (locations and values of variables), and the moves between them.

The rules: all guards are read before the step. The sender is updated first, then the receivers in
the order of the automata. While some location is committed, only steps that leave a committed
location are taken. A broadcast includes every automaton that can receive, which may depend on
clocks. A step is held back while a step of higher priority is possible. Conditions on clocks are
returned as bounds. Each state is computed once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import inf

from rvmon.diagnostics import Label, Span
from rvmon.errors import ModelError
from rvmon.models import model_error
from rvmon.models.network import Edge, Guard, Network, evaluate
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import alternatives_of
from rvmon.models.runs import Atom, bound_of

AtomMaker = Callable[[evaluate.Locations, evaluate.Values], tuple[Atom, ...]]
"""The clock bounds of a guard or invariant, given the variables."""


@dataclass(frozen=True, slots=True)
class ReadyEdge:
    """An edge of one automaton, compiled."""

    automaton: int
    number: int  # of the edge in the automaton
    edge: Edge
    data: evaluate.Evaluator | None  # the guard on the variables; `None` if it always holds
    atoms: AtomMaker  # the clock bounds of the guard
    # gives the index of the channel; `None` without synchronisation
    channel: evaluate.Evaluator | None
    channels: range  # all channels that it may use; more than one only if variables choose
    updates: evaluate.Runner | None  # runs the updates; `None` if there are none

    @property
    def sends(self) -> bool:
        """Whether it initiates a synchronisation."""
        return self.edge.sync is not None and self.edge.sync.sends


@dataclass(slots=True, eq=False)  # not frozen, since creating many frozen ones is slow
class State:
    """Locations and values of the variables; there is one object for each combination."""

    locations: tuple[int, ...]
    values: tuple[int, ...]
    delays: bool  # whether time may pass here
    invariant: tuple[tuple[int, float], ...]  # `(clock, bound)`: upper bounds; clocks count from 1
    # the moves from here; `None` until `Space.moves` computes them
    moves: list[Move] | None = field(default=None, repr=False)

    @property
    def is_time_bounded(self) -> bool:
        """Whether time cannot pass forever."""
        return not self.delays or bool(self.invariant)


@dataclass(slots=True, eq=False)
class Move:
    """A step between two states."""

    edges: tuple[ReadyEdge, ...]  # the edges that take part, the sender first
    guard: tuple[Atom, ...]  # clock bounds that must hold before
    # for each receiver that is left out, the bounds of its guard, which must not all hold
    left_out: tuple[tuple[Atom, ...], ...]
    # clocks that are set, with their values; clocks count from 1
    resets: tuple[tuple[int, float], ...]
    target: State
    rank: int = 0  # the priority; moves of higher rank come first
    # the error of its updates, which is raised only if the move can be taken
    failure: ModelError | None = None


class Space:
    """All discrete states of a network found so far."""

    def __init__(self, network: Network, grid: int = 1) -> None:
        self.network = network
        self._grid = grid
        self._states: dict[tuple[tuple[int, ...], tuple[int, ...]], State] = {}
        self._edges = [
            [_ready(network, index, number, grid) for number in range(len(automaton.edges))]
            for index, automaton in enumerate(network.automata)
        ]
        self._leaving = [
            [[edges[number] for number in leaving] for leaving in automaton.leaving()]
            for automaton, edges in zip(network.automata, self._edges, strict=True)
        ]
        self._invariants = [
            [(_data(p.invariant), atoms_of(p.invariant.clocks, p.span, grid)) for p in a.locations]
            for a in network.automata
        ]

    def initial(self) -> State | None:
        """The initial state; `None` if an invariant forbids the initial values of variables."""
        locations = tuple(automaton.initial for automaton in self.network.automata)
        return self.state(locations, tuple(v.initial for v in self.network.variables))

    def state(self, locations: tuple[int, ...], values: tuple[int, ...]) -> State | None:
        """The state with some locations and values; `None` if an invariant forbids the values."""
        key = (locations, values)
        state = self._states.get(key)
        if state is None:
            here = [own[place] for own, place in zip(self._invariants, locations, strict=True)]
            if not all(holds is None or holds(locations, values) for holds, _ in here):
                return None
            tightest: dict[int, float] = {}
            for _, atoms in here:
                for _, clock, bound in atoms(locations, values):
                    tightest[clock] = min(bound, tightest.get(clock, inf))
            invariant = tuple(sorted(tightest.items()))
            state = State(locations, values, delays=True, invariant=invariant)
            state.delays = not self._stops_time(state)
            self._states[key] = state
        return state

    def step(self, state: State, edges: Iterable[tuple[int, int]]) -> Move | None:
        """The joint move of some edges (automaton and index); `None` if it is impossible."""
        return self._move(state, tuple(self._edges[a][number] for a, number in edges), ())

    def moves(self, state: State) -> list[Move]:
        """All moves from a state whose guards on the variables hold."""
        if state.moves is None:
            found = (self._move(state, *together) for together in self._together(state))
            state.moves = [move for move in found if move is not None]
        return state.moves

    def _move(
        self, state: State, edges: tuple[ReadyEdge, ...], left_out: tuple[tuple[Atom, ...], ...]
    ) -> Move | None:
        locations, values, changed = state.locations, state.values, [*state.locations]
        guard = tuple(atom for edge in edges for atom in edge.atoms(locations, values))
        rank = self._rank(state, edges)
        frame = evaluate.Frame(values, len(self.network.locals))
        try:
            for edge in edges:
                changed[edge.automaton] = edge.edge.target
                if edge.updates is not None:
                    edge.updates(locations, frame)
        except ModelError as error:
            return Move(edges, guard, left_out, (), state, rank, error)
        target = self.state(tuple(changed), frame.variables())
        if target is None:
            return None
        resets = tuple((c + 1, value * self._grid) for c, value in frame.clocks.items())
        return Move(edges, guard, left_out, resets, target, rank)

    def _rank(self, state: State, edges: tuple[ReadyEdge, ...]) -> int:
        priorities, channel = self.network.priorities, edges[0].channel
        if priorities is None:
            return 0
        number = None if channel is None else channel(state.locations, state.values)
        return priorities.rank(number, (edge.automaton for edge in edges))

    def _kinds(self, state: State) -> list[ex.LocationKind]:
        pairs = zip(self.network.automata, state.locations, strict=True)
        return [automaton.locations[place].kind for automaton, place in pairs]

    def _stops_time(self, state: State) -> bool:
        if any(kind is not ex.LocationKind.NORMAL for kind in self._kinds(state)):
            return True
        tried = _Tried(state, self._leaving)
        # All channels of an array are of one kind, so the first tells.
        return any(
            self.network.channels[edge.channels[0]].urgent
            and tried.is_able(edge)
            and (self.network.channels[edge.channels[0]].broadcast or any(tried.receivers(edge)))
            for edge in tried.leaving()
            if edge.sends
        )

    def _together(
        self, state: State
    ) -> Iterator[tuple[tuple[ReadyEdge, ...], tuple[tuple[Atom, ...], ...]]]:
        """Edges that may move together, with the clock bounds of the receivers left out."""
        tried = _Tried(state, self._leaving)
        kinds = enumerate(self._kinds(state))
        committed = {index for index, kind in kinds if kind is ex.LocationKind.COMMITTED}

        def may_move(edges: Iterable[ReadyEdge]) -> bool:
            return not committed or any(edge.automaton in committed for edge in edges)

        broadcasts = []
        for edge in tried.leaving():
            if edge.channel is None:
                if may_move((edge,)) and tried.is_able(edge):
                    yield (edge,), ()
            elif edge.sends and self.network.channels[edge.channels[0]].broadcast:
                broadcasts.append(edge)
            elif edge.sends and tried.is_able(edge):
                for other in tried.receivers(edge):
                    if may_move((edge, other)):
                        yield (edge, other), ()
        for sender in filter(tried.is_able, broadcasts):
            groups: dict[int, list[ReadyEdge | None]] = {}
            for other in tried.receivers(sender):
                groups.setdefault(other.automaton, []).append(other)
            # An automaton is left out only if clocks can disable all its receiving edges.
            for group in groups.values():
                if all(edge is not None and edge.edge.guard.clocks for edge in group):
                    group.append(None)
            for chosen in product(*groups.values()):
                edges = (sender, *(edge for edge in chosen if edge is not None))
                if may_move(edges):
                    yield (
                        edges,
                        tuple(
                            other.atoms(state.locations, state.values)
                            for group, edge in zip(groups.values(), chosen, strict=True)
                            for other in (group if edge is None else ())
                            if other is not None
                        ),
                    )


class _Tried:
    """The edges that leave the locations of a state. Each guard is evaluated at most once."""

    def __init__(self, state: State, leaving: Sequence[Sequence[Sequence[ReadyEdge]]]) -> None:
        self._here = (state.locations, state.values)
        self._edges = [own[place] for own, place in zip(leaving, state.locations, strict=True)]
        self._known: dict[tuple[int, int], bool] = {}

    def leaving(self) -> Iterator[ReadyEdge]:
        """All these edges."""
        return (edge for edges in self._edges for edge in edges)

    def is_able(self, edge: ReadyEdge) -> bool:
        """Whether the guard of an edge on the variables holds."""
        key = edge.automaton, edge.number
        if key not in self._known:
            self._known[key] = edge.data is None or bool(edge.data(*self._here))
        return self._known[key]

    def receivers(self, sender: ReadyEdge) -> Iterator[ReadyEdge]:
        """The edges that can receive from a sender."""
        assert sender.channel is not None, "asked of senders"
        first = sender.channels
        for edge in self.leaving():
            if edge.automaton == sender.automaton or edge.channel is None or edge.sends:
                continue
            second = edge.channels
            if first.start < second.stop and second.start < first.stop and self.is_able(edge):
                single = len(first) == len(second) == 1
                if single or edge.channel(*self._here) == sender.channel(*self._here):
                    yield edge


def _ready(network: Network, automaton: int, number: int, grid: int) -> ReadyEdge:
    edge = network.automata[automaton].edges[number]
    channel, channels = None, range(0)
    if edge.sync is not None:
        slot = edge.sync.slot
        channel = evaluate.slot_evaluator(slot)
        channels = range(slot.first, slot.first + slot.size)
    atoms = atoms_of(edge.guard.clocks, edge.span, grid)
    updates = evaluate.runner(edge.updates) if edge.updates else None
    return ReadyEdge(automaton, number, edge, _data(edge.guard), atoms, channel, channels, updates)


def _data(guard: Guard) -> evaluate.Evaluator | None:
    """The condition of a guard on the variables; `None` if it always holds."""
    return None if guard.data == ex.TRUE else evaluate.evaluator(guard.data)


def atoms_of(compares: Sequence[ex.ClockCompare], span: Span | None, grid: int = 1) -> AtomMaker:
    """Make a function that gives the bounds of some comparisons, in steps of a grid."""
    bounds = [compare.bound for compare in compares]
    numbers = [bound.value * grid for bound in bounds if isinstance(bound, ex.Constant)]
    if len(numbers) == len(bounds):
        fixed = tuple(map(_atom, compares, numbers))
        return lambda _locations, _values: fixed
    steps = [1 if isinstance(bound, ex.Fractional) else grid for bound in bounds]
    made = [*zip(compares, map(evaluate.evaluator, bounds), steps, strict=True)]
    return lambda locations, values: tuple(
        _atom(compare, evaluate.check_time(bound(locations, values), span) * step)
        for compare, bound, step in made
    )


def _atom(compare: ex.ClockCompare, number: int) -> Atom:
    clock, strict = compare.clock + 1, compare.op in (ex.ClockOp.LT, ex.ClockOp.GT)
    if compare.op in (ex.ClockOp.LT, ex.ClockOp.LE):
        return 0, clock, bound_of(number, strict)
    return clock, 0, bound_of(-number, strict)


PiecesMaker = Callable[[evaluate.Locations, evaluate.Values], list[tuple[Atom, ...]]]
"""The alternative clock bounds under which a formula holds in a discrete state."""


def pieces_of(formula: ex.Expression, grid: int = 1) -> PiecesMaker:
    """Make a function that gives the pieces of a plain normalised formula."""
    pieces = [
        (evaluate.evaluator(guard.data), atoms_of(guard.clocks, None, grid))
        for guard in alternatives_of(formula)
    ]
    return lambda locations, values: [
        atoms(locations, values) for holds, atoms in pieces if holds(locations, values)
    ]


def check_start(network: Network) -> None:
    """Refuse a network that has no initial state."""
    state = Space(network).initial()
    if state is None or any(bound < 0 for _, bound in state.invariant):
        places = [a.locations[a.initial] for a in network.automata]
        spans = [place.span for place in places if place.span is not None]
        span, others = (spans[0] if spans else None), [Label(other) for other in spans[1:]]
        message = "an invariant of the initial locations is false at time 0"
        fix = "weaken it, or start elsewhere"
        raise model_error("TA014", message, span, fix, others=others)
