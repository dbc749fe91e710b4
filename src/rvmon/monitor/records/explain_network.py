"""What is noted of a decision that networks have made, and how these stand at a moment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from rvmon.dataflow.journal import Journal
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import NetworkJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.explanation import truths_shown
from rvmon.monitor.explained.network import NetworkRuns, explained_by_network
from rvmon.plan.standing import Standing
from rvmon.trace.sample import Scalar
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.verdict import Verdict


class Noted(NamedTuple):
    """What the reason of a decision is worked out from.

    Attributes:
        compiled: the requirement.
        journal: of the network that decided; `None` if there was none.
        reached: how far it had come.
        position: the instant of the position whose value was waited for, ticks.
        seen_then: the values of what is read of the input at the trigger.
        seen: the same at the decision.
        texts: of these.
        captured: values of `let` and `for each`.
        flow: how the propositions stood.
        decided: the instant of the decision, ticks.
    """

    compiled: CompiledRequirement
    journal: Journal | None
    reached: int
    position: int
    seen_then: tuple[int, ...]
    seen: tuple[int, ...]
    texts: tuple[str, ...]
    captured: Mapping[str, Scalar]
    flow: Standing
    decided: int


def note_decision(judge: NetworkJudge, attempt: Open, verdict: bool, t: int) -> Noted:
    """Note what the reason for a decision at `t` is worked out from, when someone asks for it."""
    journal, reached = judge.journal_now(verdict) or (None, 0)
    seen, flow = judge.stood
    return Noted(
        judge.compiled,
        journal,
        reached,
        attempt.token[1][0],
        attempt.seen,
        seen,
        judge.texts,
        judge.captured,
        flow,
        t,
    )


def network_details(record: Attempt, noted: Noted) -> Mapping[str, Any]:
    """All that a record says beside the verdict; see `decided_attempt`."""
    why = explained_by_network(
        noted.compiled,
        None if noted.journal is None else noted.journal.after(noted.reached),
        noted.position,
        record.verdict is Verdict.PASS,
        noted.decided,
        record.triggered,
        noted.flow,
    )
    return {
        "reason": why.reason,
        "deadline": why.deadline,
        "at_trigger": truths_shown(noted.texts, noted.seen_then),
        "at_decision": truths_shown(noted.texts, noted.seen),
        "owed": why.owed,
        "captured": noted.captured,
        "blame": why.blame,
        "forecast": None,
        "robustness": None,
    }


def networks_of(judge: NetworkJudge, now: int) -> NetworkRuns:
    """The networks of a judge at a stamp."""
    worse = None if judge.worse is None else judge.moment(judge.worse, now)
    better = worse if judge.better is None else judge.moment(judge.better, now)
    return NetworkRuns(worse, better, len(judge.attempts), judge.flow.gap)
