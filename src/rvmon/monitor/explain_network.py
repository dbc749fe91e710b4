"""The sentences and details of a record that a network decided."""

from __future__ import annotations

from rvmon.automaton.location import FAILED
from rvmon.dataflow.network import Network
from rvmon.monitor.bench import Open
from rvmon.monitor.cause_network import NetworkCauseFinder
from rvmon.monitor.explain import Explanation, longer
from rvmon.monitor.network_judge import WAITING, NetworkJudge
from rvmon.monitor.owed_network import Owed, owed_at
from rvmon.verdict.attempt import Blame


def network_decision(judge: NetworkJudge, attempt: Open, verdict: bool, t: int) -> Explanation:
    """Why an attempt was decided at `t`."""
    network = judge.worse if verdict else judge.better or judge.worse
    found = None if network is None else network.truth(attempt.token[1][0])
    if network is None or found is None:
        return Explanation()
    core = judge.compiled.obligation.owed
    position = attempt.token[1][0] // network.positions.gap
    cause = NetworkCauseFinder(network, verdict, found[1]).of(core, position)
    if cause is None:
        return Explanation("nothing was owed" if verdict else "it can never hold")
    words = judge.compiled.words
    blame: Blame | None = None if verdict else words.blame(cause, t, judge.flow)
    owed = owed_at(network, core, position, found[1] - 1, words)
    return Explanation(
        words.reason(cause, verdict, t, judge.flow),
        deadline=None if owed is None else owed.deadline,
        blame=blame,
    )


def network_open(judge: NetworkJudge, attempt: Open, end: int | None = None) -> Explanation:
    """What an undecided attempt waits for, or why it can wait no more."""
    network, token = judge.worse, attempt.token
    if token[0] == FAILED and attempt.better is not None:
        network, token = judge.better, attempt.better
    if network is None or token[0] != WAITING:
        return Explanation(f"left open by the input: {attempt.doubt}")
    owed = _owed_now(judge, network, token[1][0], end)
    doubt = f"; {attempt.doubt}" if attempt.doubt else ""
    if owed is None:
        return Explanation(f"still owed: what lies ahead{longer(judge, attempt, end)}{doubt}")
    reason = f"still owed: {owed.text}{longer(judge, attempt, end)}{doubt}"
    return Explanation(reason, owed.text, owed.deadline)


def _owed_now(judge: NetworkJudge, network: Network, t: int, end: int | None) -> Owed | None:
    now = judge.position if end is None else end
    core = judge.compiled.obligation.owed
    position = t // network.positions.gap
    return owed_at(network, core, position, 2 * now + 1, judge.compiled.words)
