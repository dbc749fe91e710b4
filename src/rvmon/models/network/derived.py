"""Networks derived from others: with a finer unit of time, or with a watching automaton added.

A watcher takes part in each move of the others and can test the names of the move. Edges note their
names in extra variables, and the watcher resets these in the same move, so that no state between
moves shows them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from rvmon.models import model_error
from rvmon.models import network as nta
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import resets_in


def finer(network: nta.Network, factor: int) -> nta.Network:
    """The network with a unit of time that is `factor` times smaller, and with the same runs.

    Queries are dropped, since they refer to the old unit.
    """

    def automaton(own: nta.Automaton) -> nta.Automaton:
        places = [replace(p, invariant=_guard(p.invariant, factor)) for p in own.locations]
        edges = [replace(e, guard=_guard(e.guard, factor), updates=updates(e)) for e in own.edges]
        return replace(own, locations=tuple(places), edges=tuple(edges))

    def updates(edge: nta.Edge) -> tuple[ex.Statement, ...]:
        return tuple(_update(update, factor) for update in edge.updates)

    unit = None if network.unit is None else network.unit // factor
    return replace(network, unit=unit, automata=tuple(map(automaton, network.automata)), queries=())


def _update(update: ex.Statement, factor: int) -> ex.Statement:
    if isinstance(update, ex.Reset):
        return replace(update, value=_times(update.value, factor))
    if any(reset.value != ex.Constant(0) for reset in resets_in([update])):
        fix = "set clocks in the updates of edges, not in functions"
        raise model_error("TA016", "a function sets a clock to a number of units", None, fix)
    return update


def _guard(guard: nta.Guard, factor: int) -> nta.Guard:
    finer = (replace(compare, bound=_times(compare.bound, factor)) for compare in guard.clocks)
    return replace(guard, clocks=tuple(finer))


def _times(number: ex.Expression, factor: int) -> ex.Expression:
    if isinstance(number, ex.Constant):
        return ex.Constant(number.value * factor)
    return ex.BinaryOperation(ex.BinaryOp.MUL, number, ex.Constant(factor))


def names_of(network: nta.Network, edge: nta.Edge) -> tuple[str, ...]:
    """The names that an edge gives to a move: its label, and its channel if it sends."""
    sends = edge.sync is not None and edge.sync.sends
    channel = network.channels[edge.sync.slot.first].name if edge.sync and sends else ""
    return tuple(dict.fromkeys(name for name in (edge.label, channel) if name))


class Watcher:
    """Builds a watcher, and the network that includes it."""

    def __init__(self, network: nta.Network, names: Iterable[str], clocks: Sequence[str]) -> None:
        self._network = network
        self._clocks = tuple(map(nta.Clock, clocks))
        self.clock = len(network.clocks)  # index of the watcher's first clock
        first = len(network.variables)
        self._slots = {name: ex.Slot(first + k) for k, name in enumerate(dict.fromkeys(names))}
        self._unnoted: tuple[ex.Statement, ...] = tuple(_set(s, 0) for s in self._slots.values())
        self._locations: list[nta.Location] = []
        self._edges: list[nta.Edge] = []

    def has(self, name: str) -> ex.Expression:
        """Whether the current move has a name; false between moves."""
        return ex.VariableValue(self._slots[name])

    def add_location(
        self, bounds: Iterable[ex.ClockCompare] = (), kind: ex.LocationKind = ex.LocationKind.NORMAL
    ) -> int:
        """Add a location with an invariant and return its index."""
        self._locations.append(nta.Location("", kind, nta.Guard(ex.TRUE, tuple(bounds))))
        return len(self._locations) - 1

    def add_edge(
        self,
        source: int,
        target: int,
        when: ex.Expression = ex.TRUE,
        bounds: Iterable[ex.ClockCompare] = (),
        resets: Iterable[int] = (),
        *,
        watches: bool = True,
    ) -> None:
        """Add an edge that accompanies moves, or (`watches=False`) one taken independently."""
        if when == ex.FALSE:
            return
        set_now = tuple(ex.Reset(clock, ex.Constant(0)) for clock in resets)
        unnoted = self._unnoted if watches else ()
        updates = (*unnoted, *set_now) if set_now else unnoted
        guard = nta.Guard(when, tuple(bounds))
        edge = nta.Edge(source, target, guard, None, updates, 1.0, "", "", watches=watches)
        self._edges.append(edge)

    def is_in(self, location: int) -> ex.Expression:
        """Whether the watcher is in a location."""
        return ex.InLocation(len(self._network.automata), location)

    def network(self, initial: int = 0) -> nta.Network:
        """The network with the watcher, which starts in one of its locations."""
        network, ranks = self._network, self._network.priorities
        own = (ex.Variable(name, 0, 1, 0, is_bool=True) for name in self._slots)
        automata = [
            replace(automaton, edges=tuple(map(self._noting, automaton.edges)))
            for automaton in network.automata
        ]
        watcher = nta.Automaton("", tuple(self._locations), tuple(self._edges), initial)
        return replace(
            network,
            clocks=(*network.clocks, *self._clocks),
            variables=(*network.variables, *own),
            automata=(*automata, watcher),
            queries=(),
            priorities=ranks
            and nta.Priorities((*ranks.automata, 0), ranks.internal, ranks.channels),
            original=network,
            is_watched=True,
        )

    def _noting(self, edge: nta.Edge) -> nta.Edge:
        names = (name for name in names_of(self._network, edge) if name in self._slots)
        noted = (_set(self._slots[name], 1) for name in names)
        return replace(edge, updates=(*edge.updates, *noted))


def _set(slot: ex.Slot, value: int) -> ex.Assignment:
    return ex.Assignment(slot, ex.Constant(value), ex.Variable("", 0, 1, 0, is_bool=True))
