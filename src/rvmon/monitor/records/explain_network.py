"""The sentences and details of a record that a network decided."""

from __future__ import annotations

from rvmon.automaton.location import FAILED
from rvmon.automaton.machine import Token
from rvmon.dataflow.network import Network
from rvmon.dataflow.time_decisions import known_alone, settled
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.network_judge import WAITING, NetworkJudge
from rvmon.monitor.reasons.cause_network import NetworkCauseFinder
from rvmon.monitor.reasons.owed_network import owed_at
from rvmon.monitor.reasons.sentence import rendered
from rvmon.monitor.records.explanation import Explanation, earlier, longer, still_owed, unborn
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
    words, start = judge.compiled.words, cause.start
    blame: Blame | None = None if verdict else words.blame(cause, t, start, judge.flow)
    deadline = None
    if t > attempt.token[1][0]:  # else it owed nothing yet
        last = _settled_before(network, position, found[1])
        # What had long been settled when the attempt began was no deadline of it.
        if last is not None and last >= attempt.token[1][0] - 1:
            deadline = last
    sentence = rendered(words.sentence(cause, verdict), t, start, attempt.triggered, judge.flow)
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
