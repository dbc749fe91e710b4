"""The sentences and details of a record that a network decided."""

from __future__ import annotations

from rvmon.monitor.bench import Open
from rvmon.monitor.explain import Explanation
from rvmon.monitor.network_judge import NetworkJudge


def network_decision(judge: NetworkJudge, attempt: Open, verdict: bool, t: int) -> Explanation:
    """Why an attempt was decided at `t`."""
    return Explanation()


def network_open(judge: NetworkJudge, attempt: Open, end: int | None = None) -> Explanation:
    """What an undecided attempt waits for, or why it can wait no more."""
    return Explanation()
