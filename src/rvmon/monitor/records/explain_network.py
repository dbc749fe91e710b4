"""The sentences and details of a record that a network decided."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from rvmon.automaton.location import FAILED
from rvmon.automaton.machine import Token
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import Network
from rvmon.dataflow.time_decisions import known_alone, settled
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import WAITING, NetworkJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.reasons.cause_network import NetworkCauseFinder
from rvmon.monitor.reasons.owed_network import owed_at
from rvmon.monitor.reasons.sentence import rendered
from rvmon.monitor.records.explanation import (
    Explanation,
    earlier,
    longer,
    still_owed,
    truths_shown,
    unborn,
)
from rvmon.plan.standing import Standing
from rvmon.trace.sample import Scalar
from rvmon.verdict.attempt import Attempt, Blame
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
    why = _why_decided(noted, record.verdict is Verdict.PASS, record.triggered)
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


def _why_decided(noted: Noted, verdict: bool, triggered: int) -> Explanation:
    network = None if noted.journal is None else noted.journal.after(noted.reached)
    found = None if network is None else network.truth(noted.position)
    if network is None or found is None:
        return Explanation()
    t, core, position = noted.decided, noted.compiled.obligation.owed, noted.position
    integer = position // network.positions.gap
    cause = NetworkCauseFinder(network, verdict, found[1]).of(core, integer)
    if cause is None:
        return Explanation("there was no obligation" if verdict else "it can never hold")
    words, start = noted.compiled.words, cause.start
    blame: Blame | None = None if verdict else words.blame(cause, t, start, noted.flow)
    deadline = None
    if t > position:  # else it owed nothing yet
        last = _settled_before(network, integer, found[1])
        # What had long been settled when the attempt began was no deadline of it.
        if last is not None and last >= position - 1:
            deadline = last
    sentence = rendered(words.sentence(cause, verdict), t, start, triggered, noted.flow)
    return Explanation(sentence, deadline=deadline, blame=blame)


def _settled_before(network: Network, position: int, at: int) -> int | None:
    """The last instant before time alone would have settled what became known at a stamp."""
    if at % 2 == 0:
        return at // 2 - 1  # as it did: no letter of that instant was needed
    alone = settled(known_alone(network, at - 1, (position, position)), position)
    return None if alone is None else alone[0]


def network_open(
    judge: NetworkJudge, attempt: Open, now: int, end: int | None = None
) -> Explanation:
    """What an undecided attempt waits for, or why it can wait no more; see `explain_machine`."""
    network, token = judge.worse, attempt.token
    if token[0] == FAILED and attempt.better is not None:
        network, token = judge.better, attempt.better
    if network is None or token[0] != WAITING:
        return Explanation(f"left open by the input: {attempt.doubt}")
    position = token[1][0] // network.positions.gap
    core = judge.compiled.obligation.owed
    network = judge.moment(network, now).network
    owed = owed_at(network, core, position, network.grown, judge.compiled.words)
    doubt = f"; {attempt.doubt}" if attempt.doubt else ""
    waiting = still_owed(owed or "what lies ahead", end)
    reason = f"{waiting}{longer(judge, attempt, end)}{doubt}{unborn(judge, attempt, end)}"
    return Explanation(reason, owed, _deadline(judge, attempt, now))


def _deadline(judge: NetworkJudge, attempt: Open, now: int) -> int | None:
    """The last instant before time alone decides an attempt."""

    def alone(network: Network | None, token: Token) -> tuple[int, bool] | None:
        if network is None or token[0] != WAITING:
            return None
        position = token[1][0] // network.positions.gap
        return settled(judge.moment(network, now).alone, position)

    better = judge.worse if judge.better is None else judge.better
    return earlier(
        attempt,
        alone(judge.worse, attempt.token),
        alone(better, attempt.better or attempt.token),
    )
