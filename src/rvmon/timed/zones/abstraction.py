"""Zones coarsened to finitely many, up to bisimulation.

Simulation is enough for reaching a state, but it would invent deadlocks and hide loops; what asks
for those uses this instead.

Source: Behrmann, Bouyer, Larsen, Pelánek, Lower and Upper Bounds in Zone-Based Abstractions of
Timed Automata, 2006, section 3 (Extra_M).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from rvmon.timed.zones.clock_bounds import ClockBounds
from rvmon.timed.zones.dbm import STRICT, Zone, normalise


def largest(bounds: ClockBounds) -> tuple[float, ...]:
    """The largest number that each clock is compared with; clock 0 first, −inf for none."""
    return (0.0, *map(max, bounds.lower, bounds.upper))


def extrapolate(zone: Zone, dim: int, maxima: Sequence[float]) -> Zone:
    """A zone with what lies above the largest numbers blurred; a clock without any is free."""
    fresh = zone[:]
    changed = False
    for x in range(dim):
        lowest = -maxima[x]
        for y in range(dim):
            if x == y:
                continue
            bound = zone[x * dim + y]
            if bound != inf and bound > maxima[y]:
                fresh[x * dim + y] = inf
                changed = True
            elif bound < lowest:
                fresh[x * dim + y] = lowest - STRICT
                changed = True
        if maxima[x] == -inf:
            fresh[x * dim] = 0.0
    if not changed:
        return fresh
    _close(fresh, dim)
    return normalise(fresh)


def _close(zone: Zone, dim: int) -> None:
    for middle in range(dim):
        row = zone[middle * dim : middle * dim + dim]
        for base in range(0, dim * dim, dim):
            through = zone[base + middle]
            if through < inf:
                zone[base : base + dim] = [
                    new if (new := through + step) < old else old
                    for step, old in zip(row, zone[base : base + dim], strict=True)
                ]
