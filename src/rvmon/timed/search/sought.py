"""What the native search is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from rvmon.timed.model.expressions import Expression, PathFormula
from rvmon.timed.model.guards import parts_of
from rvmon.timed.search.linear import Ways
from rvmon.timed.search.meter import Policy


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
    choose: Policy = Policy.SHORTEST
    bound: int | None = None

    @property
    def has_timer(self) -> bool:
        """Whether one more clock belongs to the query."""
        nested = () if self.nested is None else parts_of(self.nested)
        return (
            self.bound is not None
            or self.progress
            or self.choose is Policy.FASTEST
            or any(isinstance(part, PathFormula) and part.bound is not None for part in nested)
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
