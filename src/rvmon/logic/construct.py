"""Constructs the automaton of a formula by exploring its locations and their age regions."""

from __future__ import annotations

from array import array
from itertools import product

from msgspec import Struct

from rvmon.logic.alphabet import Alphabet, Diagrams, Node, TooManyClassesError
from rvmon.logic.automaton import NOW, Automaton, Location, layout_of, location_of, normalise
from rvmon.logic.formula import Literal, Temporal
from rvmon.logic.progress import after, holds_at_end, step, value
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Residual, TooManyClausesError


class Budget(Struct, frozen=True):
    """Limits beyond which the construction of an automaton is given up."""

    locations: int = 60
    clocks: int = 6  # clocks of one location
    rows: int = 600  # locations times their age regions
    clauses: int = 60  # clauses of one residual
    table: int = 1 << 17  # rows times classes of letters


class DoesNotCloseError(Exception):
    """The automaton of a formula exceeds its budget; the message names the limit."""


def construct(
    required: Temporal, alphabet: Alphabet, budget: Budget, ages: set[int] | None = None
) -> Automaton:
    """Build the automaton of a formula.

    `required` is `X` of the required formula, because an attempt starts before the position of its
    trigger. `ages`, if given, collects the clock ages (ticks) with which locations were explored.

    Raises:
        DoesNotCloseError: the budget was exceeded.

    Source: AUTOMATA 2; regions after Alur and Dill 1994.
    """
    return _Construction(alphabet, budget, set() if ages is None else ages).run(required)


class _Construction:
    def __init__(self, alphabet: Alphabet, budget: Budget, ages: set[int]) -> None:
        self.alphabet = alphabet
        self.budget = budget
        self.ages = ages
        self.locations: list[Location] = []
        self.index: dict[Residual, int] = {}
        self.youngest: list[tuple[int, ...]] = []
        """Per location, the least age of each clock on entry."""
        self.rows: dict[tuple[int, tuple[int, ...]], Node] = {}
        self.least: dict[tuple[int, tuple[int, ...]], tuple[int, ...]] = {}
        """Per row, the least ages with which it was explored."""
        self.diagrams = Diagrams(alphabet)
        self.todo: list[int] = []

    def run(self, required: Temporal) -> Automaton:
        # These two come first, as FAILED and PASSED are locations 0 and 1 of every automaton.
        for residual in (FAILS, HOLDS):
            self.enter(residual, ())
        initial = self.enter(frozenset([frozenset([(required, NO_CLOCK)])]), ())
        while self.todo:
            self.explore(self.todo.pop())
        return self.tables(initial)

    def enter(self, residual: Residual, ages: tuple[int, ...]) -> int:
        """The location of a residual; queued if it is new or is entered with a smaller age."""
        index = self.index.get(residual)
        if index is None:
            if len(residual) > self.budget.clauses:
                raise DoesNotCloseError(f"more than {self.budget.clauses} clauses")
            if len(ages) > self.budget.clocks:
                raise DoesNotCloseError(f"more than {self.budget.clocks} clocks")
            if len(self.locations) >= self.budget.locations:
                raise DoesNotCloseError(f"more than {self.budget.locations} locations")
            index = self.index[residual] = len(self.locations)
            self.locations.append(location_of(residual))
            self.youngest.append(ages)
            self.todo.append(index)
            return index
        known = self.youngest[index]
        least = tuple(map(min, known, ages))
        if least != known:
            self.youngest[index] = least
            # Explore it again: with smaller ages more of its regions can be reached.
            if index not in self.todo:
                self.todo.append(index)
        return index

    def explore(self, index: int) -> None:
        location = self.locations[index]
        # Between two cuts no window opens or closes, so one vector of ages represents its region.
        # It has to be the least one, so that the targets are entered with their least ages.
        for regions in product(*(range(len(cuts) + 1) for cuts in location.cuts)):
            row = (index, regions)
            ages = _least_ages(location.cuts, regions, self.youngest[index])
            # A row now reachable with smaller ages enters its targets with smaller ages too.
            if ages is None or self.least.get(row) == ages:
                continue
            if row not in self.rows and len(self.rows) >= self.budget.rows:
                raise DoesNotCloseError(f"more than {self.budget.rows} regions")
            self.least[row] = ages
            self.ages.update(ages)
            self.rows[row] = self.diagram(location.residual, ages)

    def diagram(self, residual: Residual, ages: tuple[int, ...]) -> Node:
        def read(literal: Literal) -> Residual:
            return frozenset([frozenset([(literal, NO_CLOCK)])])

        def leaf(reached: Residual) -> tuple[int, tuple[int, ...]]:
            made, sources = normalise(reached, len(ages))
            entered = tuple(0 if source == NOW else ages[source] for source in sources)
            return self.enter(made, entered), sources

        try:
            # One step for all letters: literals stay open as atoms, and the diagram decides them
            # one by one. A step per letter would be exponential in the propositions.
            opened = step(residual, ages, read, self.budget.clauses)
        except TooManyClausesError:
            raise DoesNotCloseError(f"more than {self.budget.clauses} clauses") from None
        return self.diagrams.of(opened, leaf)

    def tables(self, initial: int) -> Automaton:
        bases, strides, total = layout_of(self.locations)
        roots = list(self.rows.values())
        try:
            class_of, classes, leaves = self.diagrams.classes(roots, self.budget.table)
        except TooManyClassesError:
            raise DoesNotCloseError(f"a table of more than {self.budget.table} entries") from None
        edges = array("i", [-1]) * (total * classes)
        number: dict[tuple[int, tuple[int, ...]], int] = {}
        for position, (index, regions) in enumerate(self.rows):
            row = bases[index] + sum(map(int.__mul__, regions, strides[index]))
            for letter_class in range(classes):
                edge = leaves[letter_class][position]
                found = number.setdefault(edge, len(number))
                edges[row * classes + letter_class] = found
        time_values, end_values = bytearray(), bytearray()
        for location in self.locations:
            # The least ages of each region vector, in the order of rows.
            for ages in product(*((0, *clock) for clock in location.cuts)):
                settled = after(location.residual, ages)
                time_values.append(value(settled))
                end_values.append(holds_at_end(settled, ages))
        return Automaton(
            self.alphabet, tuple(self.locations), initial, classes, class_of, bases, strides, edges,
            tuple(target for target, _ in number), tuple(sources for _, sources in number),
            bytes(time_values), bytes(end_values),
        )  # fmt: skip


def _least_ages(
    cuts: tuple[tuple[int, ...], ...], regions: tuple[int, ...], entered: tuple[int, ...]
) -> tuple[int, ...] | None:
    """The least ages at a step in these regions; `None` if no step is possible there.

    At a step an age is at least 1 and more than on entry, and an older clock has a greater age.
    """
    ages: list[int] = []
    least = 0
    for clock in reversed(range(len(cuts))):
        region = regions[clock]
        start = cuts[clock][region - 1] if region else 0
        least = max(least + 1, start, entered[clock] + 1)
        if region < len(cuts[clock]) and least >= cuts[clock][region]:
            return None
        ages.append(least)
    return tuple(reversed(ages))
