"""Zones of clock ages: bounds on each age and on the differences between ages.

Source: difference bound matrices after Dill 1989; widening by the bounds of the automaton after
Behrmann et al. 2006. Ages are integers, so all bounds are closed.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

NEVER = 1 << 62  # no bound

_NARROW = 8  # regions with fewer ages keep exact ages; in wider ones only differences are kept

Ages = tuple[tuple[int, ...], ...]
"""A closed difference bound matrix: entry (i, j) bounds by how much clock i is older than clock j.
Clock 0 is the reference clock of age 0; the real clocks are numbered from 1."""

Cuts = Sequence[Sequence[int]]  # per clock, the ages, ascending, at which it enters its next region


def point_zone(ages: Sequence[int]) -> Ages:
    """The zone in which every clock has a known age.

    >>> point_zone([5, 2])
    ((0, -5, -2), (5, 0, 3), (2, -3, 0))
    """
    known = (0, *ages)
    return tuple(tuple(one - other for other in known) for one in known)


def bounds(ages: Ages, clock: int) -> tuple[int, int]:
    """The least and the greatest age of a clock, numbered from 0."""
    return -ages[0][clock + 1], ages[clock + 1][0]


def region_bounds(cuts: Sequence[int], region: int) -> tuple[int, int]:
    """The least and the greatest age in a region."""
    low = cuts[region - 1] if region else 0
    return low, cuts[region] - 1 if region < len(cuts) else NEVER


def regions_between(cuts: Sequence[int], low: int, high: int) -> range:
    """The regions that an interval of ages intersects."""
    return range(bisect_right(cuts, low), bisect_right(cuts, high) + 1)


def within(ages: Ages, intervals: Sequence[tuple[int, int]]) -> Ages | None:
    """A zone intersected with an interval for each age; `None` if that is empty.

    >>> within(point_zone([5, 2]), [(0, 9), (3, 9)]) is None
    True
    """
    found = [[*row] for row in ages]
    for clock, (low, high) in enumerate(intervals, 1):
        for one, other, bound in ((clock, 0, high), (0, clock, -low)):
            if bound >= found[one][other]:
                continue
            if bound + found[other][one] < 0:
                return None
            _bind(found, one, other, bound)
    return tuple(map(tuple, found))


def _bind(found: list[list[int]], one: int, other: int, bound: int) -> None:
    """Tighten one bound and close the matrix again."""
    # Only paths through the tightened bound can have become shorter, so n² steps suffice to close
    # the matrix again, instead of n³.
    bounded = [(place, most) for place, most in enumerate(found[other]) if most < NEVER]
    for row in found:
        if row[one] < NEVER:
            through = row[one] + bound
            for place, most in bounded:
                if through + most < row[place]:
                    row[place] = through + most


def after(ages: Ages, longest: int) -> Ages:
    """The zone after 1 to `longest` ticks have passed; `longest` is 1 or `NEVER`.

    >>> after(point_zone([5, 2]), 1) == point_zone([6, 3])
    True
    """
    none, *rest = ages
    return (
        (0, *(bound - 1 for bound in none[1:])),
        *((min(row[0] + longest, NEVER), *row[1:]) for row in rest),
    )


def with_new_clock(ages: Ages) -> Ages:
    """The zone with one more clock, the last, of age 0."""
    # The new clock is as old as the reference clock 0, so it has the same row and column.
    rows = [(*row, row[0]) for row in ages]
    return (*rows, rows[0])


def projected(ages: Ages, clocks: Sequence[int]) -> Ages:
    """The zone of some clocks, in this order; clocks are numbered from 0, −1 is the last."""
    places = [0, *(range(1, len(ages))[clock] for clock in clocks)]
    return tuple(tuple(ages[place][other] for other in places) for place in places)


def widened(ages: Ages, cuts: Cuts, *, differences: bool) -> Ages:
    """A larger zone within the same regions, so that a search meets finitely many zones.

    Bounds on differences are kept if `differences` says so.
    """
    found = [[*row] for row in ages]
    apart = []
    for clock, own in enumerate(cuts):
        low, high = bounds(ages, clock)
        least, greatest = region_bounds(own, bisect_right(own, low))
        place = clock + 1
        # Beyond its last cut neither the age of a clock nor its difference from others matters.
        if not differences or greatest == NEVER:
            apart.append(place)
        if _is_wide(least, greatest, low) or (low < high and not differences):
            found[0][place], found[place][0] = -least, greatest
    # Close the matrix again: bounds of clocks with kept differences follow from each other, and
    # differences that were dropped follow from the bounds.
    together = [place for place in range(1, len(ages)) if place not in apart]
    for place in together:
        found[0][place] = min(found[0][other] + ages[other][place] for other in together)
        found[place][0] = min(ages[place][other] + found[other][0] for other in together)
    for place in apart:
        for other in range(1, len(ages)):
            if other != place:
                found[place][other] = _plus(found[place][0], found[0][other])
                found[other][place] = _plus(found[other][0], found[0][place])
    return tuple(map(tuple, found))


def _is_wide(least: int, greatest: int, age: int) -> bool:
    # The last age of a region is kept: the next position is certainly in another region.
    return greatest - least >= _NARROW and age < greatest


def alike(age: int, cuts: Sequence[int]) -> int:
    """A key of the age of a single clock: equal for ages that `widened` puts in the same zone.

    >>> [alike(age, [20]) for age in (0, 7, 18, 19, 20, 99)] == [0, 0, 0, -20, 1, 1]
    True
    """
    region = bisect_right(cuts, age)
    return region if _is_wide(*region_bounds(cuts, region), age) else -1 - age


def _plus(one: int, other: int) -> int:
    return NEVER if one == NEVER else one + other
