"""What the native search is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from rvmon.timed.model.expressions import ClockCompare, Expression
from rvmon.timed.search.linear import Ways
from rvmon.timed.zones.zone_unions import has_bounds


class Seek(IntEnum):
    """What a plan seeks, as `plan.h` says."""

    GOAL = 0
    DEADLOCK = 1
    STAY = 2
    STAY_AFTER = 3
    LATE = 4
    LATE_AFTER = 5
    NESTED = 6
    START = 7
    RUN = 8


class Choose(IntEnum):
    """By what a plan chooses among runs to a goal."""

    SHORTEST = 0
    FASTEST = 1
    LIKELY = 2


@dataclass(frozen=True, slots=True)
class Alternative:
    """A condition on the discrete state and bounds of clocks, which hold together."""

    condition: Expression
    compares: tuple[ClockCompare, ...]


@dataclass(frozen=True, slots=True)
class Sought:
    """What is sought in a network.

    Attributes:
        kind: of search.
        goal: normalised; where runs lead, or from where they are watched, or what holds where
            there is no deadlock.
        inside: normalised; where runs stay, or what holds where there is a deadlock.
        ways: the automaton of a formula of LTL, that accepts the run.
        progress: whether time has to pass on for ever on the run, beside what `ways` says.
        nested: normalised; where runs lead, or what holds at the start, if that speaks of runs.
        choose: among several runs.
        bound: units of time, if there is one.
    """

    kind: Seek
    goal: Expression | None = None
    inside: Expression | None = None
    nested: Expression | None = None
    ways: Ways | None = None
    progress: bool = False
    choose: Choose = Choose.SHORTEST
    bound: int | None = None

    @property
    def has_timer(self) -> bool:
        """Whether one more clock belongs to the query."""
        return (
            self.bound is not None
            or self.progress
            or self.choose is Choose.FASTEST
            or (self.nested is not None and has_bounds(self.nested))
        )

    @property
    def is_levelled(self) -> bool:
        """Whether only states that can do the same stand for each other, not those that do more."""
        return self.kind in (
            Seek.DEADLOCK,
            Seek.STAY,
            Seek.STAY_AFTER,
            Seek.NESTED,
            Seek.START,
            Seek.RUN,
        )
