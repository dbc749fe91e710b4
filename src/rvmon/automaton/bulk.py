"""Whether open attempts can be moved in runs instead of one by one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import NOW, PASSED

_MOST = 5
"""Orders of more locations are not looked through."""


def moves_in_runs(automaton: Automaton) -> bool:
    """Whether attempts can be kept in order of their triggers by location alone.

    It is proved if there is one clock at most, which every attempt starts at its trigger and never
    again, and if the locations have an order in which age decides: read from the oldest attempts
    to the youngest, no letter ever leads a younger one to an earlier location than an older one.
    So a run, sorted by age, moves as a whole or is cut where a region ends, and runs that meet
    stand one behind the other.

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
    """Whether targets keep the order of the locations, given with the oldest attempts first."""
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
    """The rows of a location, by the age of its attempts."""
    first = automaton.bases[location]
    regions = [len(cuts) + 1 for cuts in automaton.locations[location].cuts]
    return range(first, first + (regions[0] if regions else 1))
