"""Locations: residuals with their clocks numbered by age, and the ages that make a difference."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.formula.core import Release, Until
from rvmon.formula.residual import NO_CLOCK, Residual

FAILED, PASSED = 0, 1
"""The locations in which an attempt is decided; they stand first in every machine."""

NOW = -1
"""As the source of a clock: it is started at the position of the step."""

Token = tuple[int, tuple[int, ...]]
"""Where an attempt is: its location, and for each clock the instant at which it was started."""


@dataclass(frozen=True, slots=True)
class Location:
    """What is owed, but for the ages.

    Attributes:
        residual: its clocks count from the oldest, from 0, without gaps.
        cuts: for each clock the ages, ascending, from which on it is in another region.
    """

    residual: Residual
    cuts: tuple[tuple[int, ...], ...]


def normalise(residual: Residual, clocks: int) -> tuple[Residual, tuple[int, ...]]:
    """Number the clocks of a residual after a step by age.

    Args:
        residual: what `rvmon.formula.progress.step` gave.
        clocks: the number of clocks before the step; the new one has this number.

    Returns:
        The residual, and for each of its clocks the old one it is, or `NOW`.
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
