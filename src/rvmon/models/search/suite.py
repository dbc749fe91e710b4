"""Small sets of runs that together cover every location, edge, or pair of edges of a network.

For each item not covered so far, a shortest run to it is searched. Then runs are chosen greedily:
always the one that covers most of the items still missing.

Source: Blom, Hessel, Jonsson, Pettersson, Specifying and Generating Test Cases Using Observer
Automata, FATES 2004 (coverage items as observers); Chvátal, A Greedy Heuristic for the Set-Covering
Problem, 1979.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from rvmon.models.network import Network, check_clocks
from rvmon.models.network import expressions as ex
from rvmon.models.runs import Run
from rvmon.models.runs.moves import check_start
from rvmon.models.search.budget import UNLIMITED, Budget, Meter, Statistics, Watch
from rvmon.models.search.native_search import seek
from rvmon.models.search.search_plan import Seek, Sought


class Criterion(StrEnum):
    """Coverage criteria for test suites."""

    LOCATIONS = "locations"
    EDGES = "edges"
    EDGE_PAIRS = "edge-pairs"  # an edge of an automaton and the edge that it takes next


@dataclass(frozen=True, slots=True)
class Item:
    """Something to cover: a location, an edge or two edges, by their indices."""

    automaton: int
    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Suite:
    """Runs that cover all items that can be covered."""

    criterion: Criterion
    # each run with the items that it adds to those of the runs before
    runs: tuple[tuple[Run, tuple[Item, ...]], ...]
    missing: tuple[Item, ...]  # items that no run covers
    statistics: Statistics
    # the budget that ended the search early, so that `missing` may list too many items; or ""
    stopped: str

    @property
    def covered(self) -> int:
        """The number of items that the runs cover."""
        return sum(len(items) for _, items in self.runs)


def build_suite(
    network: Network,
    criterion: Criterion,
    *,
    budget: Budget = UNLIMITED,
    watch: Watch | None = None,
) -> Suite:
    """Build a suite of runs that cover a criterion.

    Raises:
        ModelError: the network cannot start, or one of its runs leaves the range of a variable.
    """
    check_start(network)
    check_clocks(network)
    meter, found, covered = Meter(budget, watch), list[tuple[Run, frozenset[Item]]](), set[Item]()
    for item in all_items(network, criterion):
        if item not in covered and not meter.stopped:
            run = _run_to(network, criterion, item, meter)
            if run is not None:
                found.append((run, _items_on(network, run, criterion) | {item}))
                covered |= found[-1][1]
    missing = tuple(item for item in all_items(network, criterion) if item not in covered)
    return Suite(criterion, tuple(_chosen(found)), missing, meter.statistics(), meter.stopped)


def _run_to(network: Network, criterion: Criterion, item: Item, meter: Meter) -> Run | None:
    """A shortest run to an item; `None` if there is none or the search was stopped."""
    if criterion is Criterion.LOCATIONS:
        goal: ex.Expression = ex.InLocation(item.automaton, *item.numbers)
        return seek(network, Sought(Seek.GOAL, goal), meter).run
    # An extra variable counts how many of the item's edges have just been taken in sequence.
    slot, count = ex.Slot(len(network.variables)), len(item.numbers)
    progress = ex.Variable("", 0, count, 0)
    last, edges = item.numbers[-1], [*network.automata[item.automaton].edges]
    for number, edge in enumerate(edges):
        taken: ex.Expression = ex.Constant(int(number == item.numbers[0]))
        if count > 1 and number == last:
            before = ex.BinaryOperation(ex.BinaryOp.EQ, ex.VariableValue(slot), ex.Constant(1))
            taken = ex.Choice(before, ex.Constant(count), taken)
        edges[number] = replace(edge, updates=(*edge.updates, ex.Assignment(slot, taken, progress)))
    automata = [*network.automata]
    automata[item.automaton] = replace(automata[item.automaton], edges=tuple(edges))
    counting = replace(
        network,
        variables=(*network.variables, progress),
        automata=tuple(automata),
        original=network,
    )
    goal = ex.BinaryOperation(ex.BinaryOp.EQ, ex.VariableValue(slot), ex.Constant(count))
    return seek(counting, Sought(Seek.GOAL, goal), meter).run


def all_items(network: Network, criterion: Criterion) -> Iterator[Item]:
    """All items of a criterion, whether or not a run can reach them."""
    for index, automaton in enumerate(network.automata):
        match criterion:
            case Criterion.LOCATIONS:
                yield from (Item(index, (n,)) for n in range(len(automaton.locations)))
            case Criterion.EDGES:
                yield from (Item(index, (n,)) for n in range(len(automaton.edges)))
            case Criterion.EDGE_PAIRS:
                leaving = automaton.leaving()
                for first, before in enumerate(automaton.edges):
                    yield from (Item(index, (first, n)) for n in leaving[before.target])


def item_text(network: Network, item: Item, criterion: Criterion) -> str:
    """An item as text."""
    automaton = network.automata[item.automaton]
    if criterion is Criterion.LOCATIONS:
        return f"{automaton.name}.{automaton.locations[item.numbers[0]].name}"
    edges = (automaton.edges[number].text for number in item.numbers)
    return f"{automaton.name}: {', then '.join(edges)}"


def _items_on(network: Network, run: Run, criterion: Criterion) -> frozenset[Item]:
    """All items that a run covers."""
    positions = (run.start, *(step.position for step in run.steps))
    places = {
        Item(a, (place,)) for position in positions for a, place in enumerate(position.locations)
    }
    edges, pairs, last = set[Item](), set[Item](), dict[int, int]()
    numbers = {
        id(edge): k for automaton in network.automata for k, edge in enumerate(automaton.edges)
    }
    actions = (step.action for step in run.steps if step.action is not None)
    for automaton, edge in (pair for action in actions for pair in action.edges):
        number = numbers[id(edge)]
        edges.add(Item(automaton, (number,)))
        if automaton in last:
            pairs.add(Item(automaton, (last[automaton], number)))
        last[automaton] = number
    items = {Criterion.LOCATIONS: places, Criterion.EDGES: edges, Criterion.EDGE_PAIRS: pairs}
    return frozenset(items[criterion])


def _chosen(found: Sequence[tuple[Run, frozenset[Item]]]) -> Iterator[tuple[Run, tuple[Item, ...]]]:
    left = {item for _, items in found for item in items}
    while left:
        # `max` takes the first of the best, so that equal networks have equal suites.
        run, items = max(found, key=lambda one: len(one[1] & left))
        added, left = items & left, left - items
        yield run, tuple(sorted(added, key=lambda item: (item.automaton, item.numbers)))
