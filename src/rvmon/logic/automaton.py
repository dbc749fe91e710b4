"""The deterministic timed automaton that monitors one formula, as integer tables.

A location is a residual formula whose clocks are numbered from the oldest to the youngest, together
with the ages at which each clock enters another region.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from itertools import permutations

from msgspec import Struct

from rvmon.logic.alphabet import Alphabet, LetterClasses
from rvmon.logic.formula import Release, Until
from rvmon.logic.residual import NO_CLOCK, Residual

FAILED, PASSED = 0, 1
"""The locations in which an attempt is decided: the first two of every automaton."""

NOW = -1  # the source of a clock that is started at the position of the step

Token = tuple[int, tuple[int, ...]]
"""The state of an attempt: its location, and the start instant (ticks) of each of its clocks."""


class Location(Struct, frozen=True):
    """A location: the residual formula of the attempts there, for all ages of its clocks."""

    residual: Residual  # its clocks are numbered 0, 1, … from the oldest
    # per clock, the ages in ticks, ascending, at which it enters its next region
    cuts: tuple[tuple[int, ...], ...]


def normalise(residual: Residual, clocks: int) -> tuple[Residual, tuple[int, ...]]:
    """Renumber the clocks of a residual after a step, oldest first, without unused ones.

    `clocks` is the number of clocks before the step, and so the number of the one it started.

    Returns:
        The renumbered residual, and for each of its clocks the old number, or `NOW`.
    """
    used = sorted({clock for clause in residual for _, clock in clause if clock != NO_CLOCK})
    sources = tuple(NOW if clock == clocks else clock for clock in used)
    if used == list(range(len(used))):
        return residual, sources
    renamed = {old: new for new, old in enumerate(used)}
    renamed[NO_CLOCK] = NO_CLOCK
    made = frozenset(
        frozenset((node, renamed[clock]) for node, clock in clause) for clause in residual
    )
    return made, sources


def location_of(residual: Residual) -> Location:
    """The location of a residual whose clocks are numbered by age."""
    cuts: dict[int, set[int]] = {}
    for clause in residual:
        for node, clock in clause:
            if clock == NO_CLOCK or not isinstance(node, Until | Release):
                continue
            bounds = cuts.setdefault(clock, set())
            if node.low:
                bounds.add(node.low)
            if node.high is not None:
                bounds.add(node.high + 1)
    return Location(residual, tuple(tuple(sorted(cuts[clock])) for clock in sorted(cuts)))


class Automaton(Struct, frozen=True, eq=False):
    """A monitor automaton: locations, clocks and edges. Built by `construct`, then immutable.

    A *row* is a location with a region for each of its clocks: `bases[location]` plus, for each
    clock, the number of its cuts that its age has reached, times its stride. The edge taken from a
    row with a letter is `edges[row * classes + class_of[letter]]`. `FAILED` and `PASSED` are the
    first two locations.
    """

    alphabet: Alphabet  # encodes the propositions of a position as a letter
    locations: tuple[Location, ...]  # with their residuals and cuts
    initial: int  # the location before the position of the trigger
    classes: int  # the number of classes of letters
    class_of: LetterClasses  # the class of each letter
    bases: tuple[int, ...]  # per location, its first row
    strides: tuple[tuple[int, ...], ...]  # per location and clock
    edges: array[int]  # row and class to the number of an edge; −1 in unreachable rows
    targets: tuple[int, ...]  # per edge, the location it leads to
    # per edge, for each clock of its target the clock it continues, or `NOW`
    sources: tuple[tuple[int, ...], ...]
    time_values: bytes  # per row, the truth value when time alone, without a letter, reaches it
    end_values: bytes  # per row, whether the residual holds if the trace ends there

    @property
    def clocks(self) -> int:
        """The largest number of clocks in one location."""
        return max(len(location.cuts) for location in self.locations)

    @property
    def cuts(self) -> set[int]:
        """The ages at which a clock enters another region, in some location."""
        return {cut for location in self.locations for clock in location.cuts for cut in clock}


EndClause = tuple[tuple[int, int, bool], ...]
"""Tests: clock (−1: none), least age in ticks, and whether the age counts at the end of the trace
(True) or at the last instant that time reached (False)."""


def end_clauses(residual: Residual) -> tuple[EndClause, ...]:
    """The conditions under which a residual is true at the end of a trace (SEMANTICS 3).

    A pending bounded `R` is true if time has passed the end of its window, an unbounded one if its
    window has opened; every other pending operator stays unknown.
    """
    made = []
    for clause in residual:
        releases = [(node, clock) for node, clock in clause if isinstance(node, Release)]
        if len(releases) == len(clause):
            tests: list[tuple[int, int, bool]] = []
            for node, clock in releases:
                if node.high is not None:
                    tests.append((clock, node.high + 1, False))
                elif clock != NO_CLOCK and node.low:
                    tests.append((clock, node.low, True))
            made.append(tuple(sorted(tests)))
    return tuple(sorted(made))


def layout_of(
    locations: Sequence[Location],
) -> tuple[tuple[int, ...], tuple[tuple[int, ...], ...], int]:
    """First row and strides of each location, and the number of rows; the last clock is fastest."""
    bases, strides, total = [], [], 0
    for location in locations:
        bases.append(total)
        own: list[int] = []
        size = 1
        for cuts in reversed(location.cuts):
            own.append(size)
            size *= len(cuts) + 1
        strides.append(tuple(reversed(own)))
        total += size
    return tuple(bases), tuple(strides), total


def row_of(automaton: Automaton, location: int, regions: Iterable[int]) -> int:
    """The row of a location; `regions` is, per clock, the number of cuts its age has reached."""
    strides = automaton.strides[location]
    return automaton.bases[location] + sum(map(int.__mul__, regions, strides))


_MOST = 5  # the most locations whose orders are searched (n! of them)


def moves_in_runs(automaton: Automaton) -> bool:
    """Whether the attempts of one location can be stepped together, as a run sorted by trigger.

    Sufficient: there is at most one clock, started at the trigger and never again, and the
    locations have an order that every letter preserves: read from the oldest attempt to the
    youngest, it never moves a younger one to an earlier location than an older one. Then a run,
    sorted by age, moves as a whole or is cut at a region bound, and runs that meet in a location
    are simply concatenated.

    Source: AUTOMATA 3.
    """
    if automaton.clocks > 1 or not _starts_once(automaton):
        return False
    live = [
        location
        for location in range(PASSED + 1, len(automaton.locations))
        if location != automaton.initial
    ]
    if len(live) > _MOST:
        return False
    return any(_age_decides(automaton, order) for order in permutations(live))


def _starts_once(automaton: Automaton) -> bool:
    for location in range(PASSED + 1, len(automaton.locations)):
        starts = location == automaton.initial
        for row in _rows(automaton, location):
            for kind in range(automaton.classes):
                edge = automaton.edges[row * automaton.classes + kind]
                if edge < 0 or automaton.targets[edge] <= PASSED:
                    continue
                sources = automaton.sources[edge]
                if automaton.targets[edge] == automaton.initial:
                    return False
                if sources and (sources[0] == NOW) is not starts:
                    return False
    return True


def _age_decides(automaton: Automaton, order: Sequence[int]) -> bool:
    """Whether every letter preserves an order of the locations, oldest attempts first."""
    rank = {location: index for index, location in enumerate(order)}
    rows = [row for location in order for row in reversed(_rows(automaton, location))]
    rows += _rows(automaton, automaton.initial)
    for kind in range(automaton.classes):
        last = 0
        for row in rows:
            edge = automaton.edges[row * automaton.classes + kind]
            if edge >= 0 and (target := automaton.targets[edge]) > PASSED:
                if rank[target] < last:
                    return False
                last = rank[target]
    return True


def _rows(automaton: Automaton, location: int) -> range:
    """The rows of a location, by ascending age."""
    first = automaton.bases[location]
    regions = [len(cuts) + 1 for cuts in automaton.locations[location].cuts]
    return range(first, first + (regions[0] if regions else 1))
