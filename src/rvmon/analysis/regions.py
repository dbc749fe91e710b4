"""Regions of an automaton's clocks: between which cuts of a location their ages lie."""

from __future__ import annotations

from bisect import bisect_right

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import NOW

Regions = tuple[int, ...]
"""For each clock of a location how many of its cuts have been passed."""


def after_edge(automaton: Automaton, location: int, regions: Regions, edge: int) -> Regions:
    """The least regions behind an edge; locations may cut the age of one clock differently."""
    ours = automaton.locations[location].cuts
    theirs = automaton.locations[automaton.targets[edge]].cuts
    found = []
    for source, cuts in zip(automaton.sources[edge], theirs, strict=True):
        passed = 0 if source == NOW else regions[source]
        age = ours[source][passed - 1] if passed else 0
        found.append(bisect_right(cuts, age))
    return tuple(found)
