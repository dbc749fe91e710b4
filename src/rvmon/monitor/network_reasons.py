"""Explains attempts judged by a network: the reason and the details of their records."""

from __future__ import annotations

from typing import assert_never

from msgspec import Struct

from rvmon.logic import formula as mtl
from rvmon.logic.automaton import FAILED, PASSED, Token
from rvmon.logic.residual import TooManyClausesError
from rvmon.monitor.cause import Cause, Moment, TruthValues, without_cause
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.explanation import Alone, Explanation, Undecided
from rvmon.monitor.network import Network, settled
from rvmon.monitor.network.piecewise import FAR
from rvmon.monitor.network.remaining import Remaining
from rvmon.monitor.obligation_words import Words, all_of
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Blame


class _PendingText:
    """Words the pending part of a formula at a position; "" if nothing is pending."""

    def __init__(self, network: Network, words: Words, origin: int) -> None:
        self.network = network
        self.words = words
        self.origin = origin
        self.gap = network.positions.gap

    def at(self, core: mtl.Core, position: int) -> str:
        if self.network.value_at(core, position) is not None:
            return ""
        match core:
            case mtl.Constant() | mtl.Literal():
                return ""
            case mtl.And(args=args):
                return all_of([self.at(arg, position) for arg in args])
            case mtl.Or(args=args):
                parts = dict.fromkeys(self.at(arg, position) for arg in args)
                return ", or ".join(part for part in parts if part)
            case mtl.Next() | mtl.Previous() | mtl.Since() | mtl.Until():
                return self.words.dated(core, position * self.gap, self.origin)
            case mtl.Release(right=right, low=low):
                spawned = self._first_pending(right, position - (-low // self.gap))
                return all_of([spawned, self.words.dated(core, position * self.gap, self.origin)])
            case _:
                assert_never(core)

    def _first_pending(self, core: mtl.Core, first: int) -> str:
        """The pending part of a formula at its first undecided position from `first` on."""
        if isinstance(core, mtl.Literal | mtl.Constant):
            return ""
        position = self.network.first_unknown(core, first)
        return "" if position is None else self.at(core, position)


class NetworkCauseFinder:
    """Finds the cause of a decision.

    The deciding literal became known at the very stamp of the decision, and so did every formula
    between it and the root: the search descends along operands with that stamp ("fresh").
    """

    def __init__(self, network: Network, verdict: bool, at: int) -> None:
        self.network = network
        self.verdict = verdict
        self.at = at
        self.gap = network.positions.gap

    def of(self, core: mtl.Core, position: int) -> Cause | None:
        """The cause of a formula's value at a position; `None` if the formula is constant."""
        match core:
            case mtl.Constant():
                return None
            case mtl.Literal():
                return Cause(core, position * self.gap, False, core)
            case mtl.And(args=args) | mtl.Or(args=args):
                # A temporal operand explains more than a literal next to it.
                parts = sorted(args, key=lambda arg: isinstance(arg, mtl.Literal))
                causes = (self.of(arg, position) for arg in parts if self._is_fresh(arg, position))
                return next((cause for cause in causes if cause is not None), None)
            case mtl.Next(operand=operand):
                return self._within(operand, position + 1, FAR)
            case mtl.Previous(operand=operand):
                return self._within(operand, -FAR, position - 1)
            case mtl.Until() | mtl.Release():
                return self._ahead(core, position)
            case mtl.Since(left=left, right=right, low=low, high=high):
                last = position - -(-low // self.gap)
                first = -FAR if high is None else position - high // self.gap
                return self._within(right, first, last) or self._within(left, -FAR, position)
            case _:
                assert_never(core)

    def _ahead(self, core: mtl.Until | mtl.Release, position: int) -> Cause | None:
        start = position * self.gap
        first = position - (-core.low // self.gap)
        last = FAR if core.high is None else position + core.high // self.gap
        if isinstance(core, mtl.Until) is self.verdict:
            return self._of_part(core, core.right, first, last, start)
        if core.high is not None and self.at == 2 * (start + core.high + 1):
            return Cause(core, start, True, None)
        if self._when(core.left, position, FAR) is not None:
            return self._of_part(core, core.left, position, FAR, start)
        return self._of_part(core, core.right, first, last, start)

    def _of_part(
        self, core: mtl.Until | mtl.Release, part: mtl.Core, first: int, last: int, start: int
    ) -> Cause:
        """The cause within an operand of an operator that was instantiated at `start`."""
        if isinstance(part, mtl.Literal):
            return Cause(core, start, False, part)
        return self._within(part, first, last) or Cause(core, start, False, None)

    def _within(self, core: mtl.Core, first: int, last: int) -> Cause | None:
        """The cause at the first fresh position of a window; `None` if there is none."""
        position = self._when(core, first, last)
        return None if position is None else self.of(core, position)

    def _is_fresh(self, core: mtl.Core, position: int) -> bool:
        return self._when(core, position, position) is not None

    def _when(self, core: mtl.Core, first: int, last: int) -> int | None:
        """The first position at which a formula got the verdict's value at the decision's stamp."""
        if isinstance(core, mtl.Constant):
            return None
        positions = self.network.positions
        # The stamp of a piece grows with the position by `slope`, so at most one position of it has
        # the stamp sought.
        for left, right, at, slope in self.network.known_of(core)[not self.verdict]:
            low, high = max(left, first), min(right, last)
            if low > high:
                continue
            position, rest = low, 0
            if slope:
                position, rest = divmod(self.at - at, slope)
            elif at != self.at:
                continue
            elif low > -FAR:
                position = positions.following(low)
            is_met = low <= position <= min(high, positions.last) and not rest
            if is_met and position == positions.following(position):
                return position if position > -FAR else None
        return None


MOST_ATTEMPTS = 32
"""If more attempts of a requirement are open in a network, none of them is forecast."""

WAITING = PASSED + 1
"""The pseudo-location of an undecided run in a network.

The token of a run in a network is FAILED, PASSED or WAITING with the position it waits for.
"""


def explained_by_network(
    compiled: CompiledRequirement,
    network: Network | None,
    position: int,
    verdict: bool,
    t: int,
    triggered: int,
    flow: TruthValues,
) -> Explanation:
    """Explain the decision of an attempt at `t`; all instants are in ticks.

    `network` is the deciding one as it was at the decision, `None` if no letters were kept; its
    value at `position` decides the attempt.
    """
    truth = None if network is None else network.truth(position)
    if network is None or truth is None:
        return Explanation()
    core, integer = compiled.obligation.required, position // network.positions.gap
    cause = NetworkCauseFinder(network, verdict, truth[1]).of(core, integer)
    if cause is None:
        return Explanation(without_cause(verdict))
    words, moment = compiled.words, Moment(t, cause.start, triggered, flow)
    blame: Blame | None = None if verdict else words.blame(cause, moment)
    deadline = None
    if t > position:  # else there was no obligation yet
        last = _settled_before(network, integer, truth[1])
        # A window that closed before the attempt started is not its deadline.
        if last is not None and last >= position - 1:
            deadline = last
    return Explanation(words.sentence(cause, verdict, moment), deadline=deadline, blame=blame)


def _settled_before(network: Network, position: int, at: int) -> int | None:
    """The last instant before time alone would have decided what became known at stamp `at`."""
    if at % 2 == 0:
        return at // 2 - 1  # an even stamp needs no letter: time alone did decide it
    alone = settled(network.alone_from(at - 1), position)
    return None if alone is None else alone[0]


class NetworkRuns(Struct, frozen=True):
    """Both networks of an open attempt at a stamp, as `rvmon.monitor.explanation.Judged`.

    They are `None` if no letters were kept; `count` attempts are open in them.
    """

    worse: Network | None
    better: Network | None
    count: int
    gap: int | None

    def met(self, worse: Token, better: Token) -> tuple[Token, Token]:
        """The tokens of both runs, updated where the networks have decided them by now."""
        if _value(self.worse, worse) is False:
            worse = (FAILED, worse[1])
        if _value(self.better, better) is True:
            better = (PASSED, better[1])
        return worse, better

    def required(self, attempt: Undecided, now: int, *, optimistic: bool) -> str | None:
        """See `Judged`."""
        del now  # the networks were evaluated for it
        network = self.better if optimistic else self.worse
        token = attempt.better if optimistic else attempt.worse
        if network is None or token[0] != WAITING:
            return None
        pending = _PendingText(network, attempt.compiled.words, attempt.origin)
        return pending.at(attempt.compiled.obligation.required, token[1][0] // pending.gap)

    def alone(self, attempt: Undecided) -> tuple[Alone, Alone]:
        """See `Judged`."""
        return _alone(self.worse, attempt.worse), _alone(self.better, attempt.better)

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """See `Judged`; `None` also if too much is undecided, or more than `MOST_ATTEMPTS` are."""
        del now
        # Each forecast is a search, and a live view would request one for every open attempt at
        # each update.
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
        """Whether some continuation may give an attempt this value in a network."""
        if network is None:
            return True
        forecaster = attempt.compiled.forecaster
        remaining = Remaining(network, forecaster.duals)
        position = token[1][0] // network.positions.gap
        try:
            residual, ages = remaining.of(attempt.compiled.obligation.required, position, value)
        except TooManyClausesError:
            return True
        return forecaster.admits(residual, ages, self.gap)


def _value(network: Network | None, token: Token) -> bool | None:
    """The value that a network gives to a waiting run; `None` if it is not decided."""
    truth = None if network is None or token[0] != WAITING else network.truth(token[1][0])
    return None if truth is None else truth[0]


def _alone(network: Network | None, token: Token) -> Alone:
    if network is None or token[0] != WAITING:
        return None
    return settled(network.alone, token[1][0] // network.positions.gap)
