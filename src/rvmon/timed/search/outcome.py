"""What a search may cost, and the answer to a query."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from rvmon.timed.model.network import Query
from rvmon.timed.runs.run import Run


@dataclass(frozen=True, slots=True)
class Budget:
    """When a search gives up; `None` is no limit.

    Attributes:
        states: symbolic states visited.
        seconds: of wall-clock time.
        megabytes: of memory that the whole process holds.
    """

    states: int | None = None
    seconds: float | None = None
    megabytes: int | None = None


UNLIMITED = Budget()


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a search is: symbolic states visited and waiting, seconds since it began."""

    visited: int
    waiting: int
    seconds: float


Watch = Callable[[Progress], None]


@dataclass(frozen=True, slots=True)
class Statistics:
    """What a search cost.

    Attributes:
        visited: symbolic states that were kept when they were met.
        stored: those that were not dropped later for a larger one.
        seconds: of wall-clock time.
    """

    visited: int
    stored: int
    seconds: float


class Policy(StrEnum):
    """Which run shows that a state can be reached, if several do."""

    SHORTEST = "shortest"
    """One with the fewest actions."""

    FASTEST = "fastest"
    """One that takes the least time."""

    LIKELIEST = "likely"
    """One with the largest product of edge weights."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether a query holds, and a run that shows why or why not.

    Attributes:
        query: the question.
        holds: `None` if the budget ended first.
        run: a witness where `E` holds, a counterexample where `A` or `-->` does not.
        policy: how the run was chosen; `None` where there is no choice.
        statistics: what it cost.
        remark: what else people should know; why it is not decided, or that time stops.
    """

    query: Query
    holds: bool | None
    run: Run | None
    policy: Policy | None
    statistics: Statistics
    remark: str = ""
