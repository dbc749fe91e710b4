"""Differences of zones, and the sets they need: a list of zones is their union."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf

from rvmon.timed.zones.dbm import STRICT, Zone, constrain, normalise


def universe(dim: int) -> Zone:
    """All valuations."""
    zone = [inf] * (dim * dim)
    for clock in range(dim):
        zone[clock * dim] = zone[clock * dim + clock] = 0.0
    return zone


def before(zone: Zone, dim: int) -> Zone:
    """The valuations from which some delay leads into a zone; normalised."""
    earlier = normalise(zone)
    for clock in range(1, dim):
        earlier[clock * dim] = min(earlier[clock * dim + 1 : clock * dim + dim])
    return earlier


def negated(bound: float) -> float:
    """The bound on the difference the other way round that holds exactly where one does not.

    >>> negated(3.0) == -3 - STRICT, negated(3 - STRICT) == -3
    (True, True)
    """
    return -bound - STRICT


def subtract(zone: Zone, other: Zone, dim: int) -> list[Zone]:
    """The part of a zone outside another, as disjoint zones; both are normalised."""
    parts: list[Zone] = []
    rest = zone[:]
    for x in range(dim):
        for y in range(dim):
            bound = other[x * dim + y]
            if bound >= rest[x * dim + y]:
                continue
            outside = rest[:]
            if constrain(outside, dim, y, x, negated(bound)):
                parts.append(normalise(outside))
            if not constrain(rest, dim, x, y, bound):
                return parts
            rest = normalise(rest)
    return parts


def subtract_all(zones: Iterable[Zone], others: Sequence[Zone], dim: int) -> list[Zone]:
    """The part of some zones outside all of some others."""
    left = list(zones)
    for other in others:
        left = [part for zone in left for part in subtract(zone, other, dim)]
        if not left:
            break
    return left
