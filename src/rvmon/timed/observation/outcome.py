"""What checking a requirement on a network gives."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.timed.model.network import Network
from rvmon.timed.runs.run import Run
from rvmon.timed.search.problem import Statistics


@dataclass(frozen=True, slots=True)
class Observation:
    """A requirement on all runs of a network.

    Attributes:
        requirement: its id.
        text: the requirement in words.
        holds: whether no attempt of any run fails; `None` if the budget ended first, or if the
            network cannot express it.
        triggered: a run with an attempt; `None`: there is none, so that the claim is vacuous.
        passing: a run with an attempt that passes.
        failing: a run with an attempt that fails.
        network: in whose unit the runs are.
        statistics: what it cost.
        remark: why it is not decided, or what the answer does not cover.
    """

    requirement: str
    text: str
    holds: bool | None
    triggered: Run | None
    passing: Run | None
    failing: Run | None
    network: Network
    statistics: Statistics
    remark: str = ""
