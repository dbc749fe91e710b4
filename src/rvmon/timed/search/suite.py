"""Few runs that together go through every location, edge, or pair of edges of a network.

One search records a first way to each item; then ways are chosen greedily, the one with the most
items that are still missing first.

Source: Blom, Hessel, Jonsson, Pettersson, Specifying and Generating Test Cases Using Observer
Automata, FATES 2004 (coverage items as observers); Chvátal, A Greedy Heuristic for the Set-Covering
Problem, 1979.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from rvmon.timed.model.network import Network
from rvmon.timed.runs.paths import make_run, move_path
from rvmon.timed.runs.run import Run
from rvmon.timed.search.explore import Node, explore
from rvmon.timed.search.meter import Meter
from rvmon.timed.search.outcome import UNLIMITED, Budget, Statistics, Watch
from rvmon.timed.zones.dbm import Zone
from rvmon.timed.zones.discrete import Move, State
from rvmon.timed.zones.symbolic import Steps, check_clocks, check_start


class Criterion(StrEnum):
    """What a suite goes through."""

    LOCATIONS = "locations"
    EDGES = "edges"
    EDGE_PAIRS = "edge-pairs"
    """An edge of an automaton, and the one that the automaton takes next."""


@dataclass(frozen=True, slots=True)
class Item:
    """Something to go through: a location, an edge, or two edges, by their numbers."""

    automaton: int
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Suite:
    """Runs that cover what can be covered.

    Attributes:
        criterion: what was to be covered.
        runs: each with the items that it adds to those before.
        missing: items that no run goes through.
        statistics: what the search cost.
        stopped: which budget ended the search, so that `missing` may say too much; empty if none.
    """

    criterion: Criterion
    runs: tuple[tuple[Run, tuple[Item, ...]], ...]
    missing: tuple[Item, ...]
    statistics: Statistics
    stopped: str

    @property
    def covered(self) -> int:
        """The number of items that the runs go through."""
        return sum(len(items) for _, items in self.runs)


@dataclass(frozen=True, slots=True)
class _Site:
    """A discrete state, and one automaton with the number of the edge that it took last."""

    state: State
    last: tuple[int, int] | None

    @property
    def uppers(self) -> tuple[tuple[int, float], ...]:
        """Of the state."""
        return self.state.uppers

    @property
    def lowers(self) -> tuple[tuple[int, float], ...]:
        """Of the state."""
        return self.state.lowers


class _Tour:
    """Goes everywhere; `watched` is the automaton whose last edge distinguishes sites."""

    def __init__(self, network: Network, watched: int | None) -> None:
        self._steps = Steps(network)
        self._watched = watched
        self.dim = self._steps.dim

    def start(self) -> Iterator[tuple[_Site, Zone]]:
        for state, zone in self._steps.start():
            yield _Site(state, None), zone

    def successors(self, site: _Site, zone: Zone) -> Iterator[tuple[Move, _Site, Zone]]:
        for move, state, fresh in self._steps.successors(site.state, zone):
            last = site.last
            for edge in move.edges:
                if edge.automaton == self._watched:
                    last = edge.automaton, edge.number
            yield move, _Site(state, last), fresh


_Node = Node[_Site, Move]


def build_suite(
    network: Network,
    criterion: Criterion,
    *,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
) -> Suite:
    """Make a suite of runs.

    Args:
        network: what to go through.
        criterion: which of its parts.
        budget: when to stop looking.
        watch: called now and then.

    Raises:
        ModelError: the network cannot start, or a run of it leaves a variable's range.
    """
    check_start(network)
    check_clocks(network)
    meter = Meter(budget, watch)
    ways: dict[Item, _Node] = {}

    def visit(node: _Node) -> None:
        for item in _items_at(node, criterion):
            ways.setdefault(item, node)

    watched: Iterable[int | None] = [None]
    if criterion is Criterion.EDGE_PAIRS:
        watched = range(len(network.automata))
    for automaton in watched:
        explore(_Tour(network, automaton), meter, visit)
        if meter.stopped:
            break
    runs = tuple(_chosen(network, ways, criterion))
    missing = tuple(item for item in all_items(network, criterion) if item not in ways)
    return Suite(criterion, runs, missing, meter.statistics(), meter.stopped)


def all_items(network: Network, criterion: Criterion) -> Iterator[Item]:
    """Everything that a criterion asks for, whether or not a run can get there."""
    for index, automaton in enumerate(network.automata):
        match criterion:
            case Criterion.LOCATIONS:
                for number in range(len(automaton.locations)):
                    yield Item(index, (number,))
            case Criterion.EDGES:
                for number in range(len(automaton.edges)):
                    yield Item(index, (number,))
            case Criterion.EDGE_PAIRS:
                for first, before in enumerate(automaton.edges):
                    for second, after in enumerate(automaton.edges):
                        if before.target == after.source:
                            yield Item(index, (first, second))


def item_text(network: Network, item: Item, criterion: Criterion) -> str:
    """An item for people."""
    automaton = network.automata[item.automaton]
    if criterion is Criterion.LOCATIONS:
        return f"{automaton.name}.{automaton.locations[item.numbers[0]].name}"
    return f"{automaton.name}: " + ", then ".join(
        automaton.edges[number].text for number in item.numbers
    )


def _items_at(node: _Node, criterion: Criterion) -> list[Item]:
    """The items that the last step to a node adds, as far as its site knows."""
    if criterion is Criterion.LOCATIONS:
        places = node.site.state.vector.locations
        return [Item(index, (place,)) for index, place in enumerate(places)]
    edges = () if node.link is None else node.link.edges
    if criterion is Criterion.EDGES:
        return [Item(edge.automaton, (edge.number,)) for edge in edges]
    last = None if node.parent is None else node.parent.site.last
    return [
        Item(edge.automaton, (last[1], edge.number))
        for edge in edges
        if last is not None and edge.automaton == last[0]
    ]


def _items_on(node: _Node, criterion: Criterion) -> frozenset[Item]:
    """All items on the way to a node."""
    nodes = node.path()
    if criterion is not Criterion.EDGE_PAIRS:
        return frozenset(item for one in nodes for item in _items_at(one, criterion))
    last: dict[int, int] = {}
    found = set()
    for one in nodes:
        for edge in () if one.link is None else one.link.edges:
            if edge.automaton in last:
                found.add(Item(edge.automaton, (last[edge.automaton], edge.number)))
            last[edge.automaton] = edge.number
    return frozenset(found)


def _chosen(
    network: Network, ways: Mapping[Item, _Node], criterion: Criterion
) -> Iterator[tuple[Run, tuple[Item, ...]]]:
    nodes = list(dict.fromkeys(ways.values()))
    on_way = {node: _items_on(node, criterion) for node in nodes}
    left = set(ways)
    while left:
        # The first of the best, so that equal networks have equal suites.
        best = max(nodes, key=lambda node: len(on_way[node] & left))
        added = on_way[best] & left
        left -= added
        path = best.path()
        steps = move_path(path[0].site.state, [one.link for one in path if one.link is not None])
        items = tuple(sorted(added, key=lambda item: (item.automaton, item.numbers)))
        yield make_run(network, path[0].site.state, steps), items
