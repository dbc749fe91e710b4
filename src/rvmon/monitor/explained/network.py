"""The sentences and details of a record that a network decided, or has open."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.location import FAILED, PASSED, Token
from rvmon.dataflow.network import Network, settled
from rvmon.dataflow.remaining import Remaining
from rvmon.formula.residual import TooManyClausesError
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.explanation import (
    Explanation,
    earlier,
    longer,
    still_owed,
    unborn,
)
from rvmon.monitor.explained.undecided import Undecided
from rvmon.monitor.reasons.cause_network import NetworkCauseFinder
from rvmon.monitor.reasons.owed_network import owed_at
from rvmon.monitor.reasons.sentence import Standing, rendered
from rvmon.verdict.attempt import Blame
from rvmon.verdict.verdict import Verdict

MOST_ATTEMPTS = 32
"""With more of a requirement open at once in a network, none is forecast."""

WAITING = PASSED + 1
"""In the place of a location: neither `FAILED` nor `PASSED`.

The token of an attempt is how it stands in a network, and the position whose value it is.
"""


def explained_by_network(
    compiled: CompiledRequirement,
    network: Network | None,
    position: int,
    verdict: bool,
    t: int,
    triggered: int,
    flow: Standing,
) -> Explanation:
    """Why an attempt was decided.

    Args:
        compiled: the requirement.
        network: that decided, as it stood then; `None` if there was none.
        position: the instant of the position whose value was waited for, ticks.
        verdict: the decision.
        t: its instant.
        triggered: that of the trigger.
        flow: how the propositions stood.
    """
    found = None if network is None else network.truth(position)
    if network is None or found is None:
        return Explanation()
    core, integer = compiled.obligation.owed, position // network.positions.gap
    cause = NetworkCauseFinder(network, verdict, found[1]).of(core, integer)
    if cause is None:
        return Explanation("there was no obligation" if verdict else "it can never hold")
    words, start = compiled.words, cause.start
    blame: Blame | None = None if verdict else words.blame(cause, t, start, flow)
    deadline = None
    if t > position:  # else it owed nothing yet
        last = _settled_before(network, integer, found[1])
        # What had long been settled when the attempt began was no deadline of it.
        if last is not None and last >= position - 1:
            deadline = last
    sentence = rendered(words.sentence(cause, verdict), t, start, triggered, flow)
    return Explanation(sentence, deadline=deadline, blame=blame)


def _settled_before(network: Network, position: int, at: int) -> int | None:
    """The last instant before time alone would have settled what became known at a stamp."""
    if at % 2 == 0:
        return at // 2 - 1  # as it did: no letter of that instant was needed
    alone = settled(network.alone_from(at - 1), position)
    return None if alone is None else alone[0]


@dataclass(frozen=True, slots=True)
class NetworkRuns:
    """Networks at a moment, as `rvmon.monitor.explained.undecided.Judged`.

    Attributes:
        worse: the network that takes the unknown for the worse; `None`: there is none.
        better: the same for the better.
        count: how many attempts are open in it.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    worse: Network | None
    better: Network | None
    count: int
    gap: int | None

    def met(self, worse: Token, better: Token) -> tuple[Token, Token]:
        """Two runs that wait, of which one may have come to its end by now."""
        for network, value, ended in ((self.worse, False, FAILED), (self.better, True, PASSED)):
            token = better if value else worse
            if network is None or token[0] != WAITING:
                continue
            found = network.truth(token[1][0])
            if found is not None and found[0] is value and value:
                better = (ended, token[1])
            elif found is not None and found[0] is value:
                worse = (ended, token[1])
        return worse, better

    def why_open(self, attempt: Undecided, now: int, end: int | None) -> Explanation:
        """See `Judged`."""
        del now  # the networks have come to it
        network, token = self.worse, attempt.worse
        if token[0] == FAILED and attempt.better != attempt.worse:
            network, token = self.better, attempt.better
        if network is None or token[0] != WAITING:
            return Explanation(f"left open by the input: {attempt.doubt}")
        compiled = attempt.compiled
        position = token[1][0] // network.positions.gap
        core = compiled.obligation.owed
        owed = owed_at(network, core, position, compiled.words)
        doubt = f"; {attempt.doubt}" if attempt.doubt else ""
        waiting = still_owed(owed or "what lies ahead", end)
        lasting = longer(core, attempt.triggered, end)
        reason = f"{waiting}{lasting}{doubt}{unborn(attempt.unborn, end)}"
        alone = (_alone(self.worse, attempt.worse), _alone(self.better, attempt.better))
        return Explanation(reason, owed, earlier(*alone, void=attempt.void))

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """As of an automaton; `None`, too, where too much is undecided.

        Each attempt costs a search of its own, so there is none with more than `MOST_ATTEMPTS`.
        """
        del now
        if self.count > MOST_ATTEMPTS:
            return None
        worse, better = attempt.worse, attempt.better
        if worse[0] > PASSED and not self._may_become(self.worse, attempt, worse, False):
            return Verdict.PASS
        if better[0] > PASSED and not self._may_become(self.better, attempt, better, True):
            return Verdict.FAIL
        return None

    def _may_become(
        self, network: Network | None, attempt: Undecided, token: Token, value: bool
    ) -> bool:
        """Whether continuations may give an attempt a value in a network."""
        if network is None:
            return True
        forecaster = attempt.compiled.forecaster
        remaining = Remaining(network, forecaster.duals)
        position = token[1][0] // network.positions.gap
        try:
            residual, ages = remaining.of(attempt.compiled.obligation.owed, position, value)
        except TooManyClausesError:
            return True
        return forecaster.admits(residual, ages, self.gap)


def _alone(network: Network | None, token: Token) -> tuple[int, bool] | None:
    """What time alone makes of a run, and the last instant before that."""
    if network is None or token[0] != WAITING:
        return None
    return settled(network.alone, token[1][0] // network.positions.gap)
