"""The rows of an automaton's tables: a location with a region for each of its clocks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import Location


def layout_of(
    locations: Sequence[Location],
) -> tuple[tuple[int, ...], tuple[tuple[int, ...], ...], int]:
    """First row and strides of each location, number of rows; the last clock runs fastest."""
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
    """The row of a location, for each clock of which so many of its cuts have been passed."""
    strides = automaton.strides[location]
    return automaton.bases[location] + sum(map(int.__mul__, regions, strides))
