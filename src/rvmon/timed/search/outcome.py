"""The answer to a query."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from rvmon.timed.model.network import Query
from rvmon.timed.runs.run import Run
from rvmon.timed.search.problem import Statistics


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
