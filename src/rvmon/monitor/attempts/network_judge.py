"""Open attempts as positions of a delay network, which is shared by all of them."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.dataflow.at_end import held_at_end
from rvmon.dataflow.network import FOREVER, Network
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.dataflow.piecewise import Pieces, stamp
from rvmon.dataflow.ranges import Range, merged
from rvmon.dataflow.sweep import Carried
from rvmon.dataflow.time_decisions import Moment
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.standing import Standing
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Scalar

WAITING = PASSED + 1
"""In the place of a location: neither `FAILED` nor `PASSED`.

The token of an attempt is how it stands in a network, and the position whose value it is.
"""

_PATIENCE = 4
"""A letter that has stayed for a while is looked ahead for so many times that."""


_VALUES = (FALSE, UNKNOWN, TRUE)

_LETTERS = {
    sense: (
        tuple(value == (TRUE if sense is Sense.TRUE else FALSE) for value in _VALUES),
        tuple(
            value == (TRUE if sense is Sense.TRUE else FALSE)
            or (value == UNKNOWN and sense is not Sense.KNOWN_FALSE)
            for value in _VALUES
        ),
    )
    for sense in Sense
}
"""By sense and value, whether a leaf is true, the unknown taken for the worse and the better."""


class NetworkJudge(AttemptJudge):
    """Judges by a network, or by two as soon as something was unknown.

    Attributes:
        plan: of the networks.
        worse: the network that takes the unknown for the worse; `None` while nothing is asked.
        better: the one that takes it for the better; `None` as long as both are the same.
        attempts: those whose value is not known.
        now: the stamp that time has come to.
    """

    STATE = (
        *(*AttemptJudge.STATE, "worse", "better", "now", "_letters", "_held"),
        *("_news", "_next_decision", "_changed", "_span"),
    )

    def __init__(
        self,
        compiled: CompiledRequirement,
        flow: Standing,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
        **kind: Any,
    ) -> None:
        super().__init__(compiled, None, flow, clerk, captured, **kind)
        self.plan: NetworkPlan = compiled.network_plan
        self.worse: Network | None = None
        self.better: Network | None = None
        self._letters: tuple[list[bool], list[bool]] | None = None
        self._news = FOREVER
        """The stamp at which a value that is waited for is known next, if the letter stays."""
        self._next_decision = NEVER
        self._changed = self.position
        """When the letter changed last."""
        self._span = self.plan.settles
        """How far it is worth while to look ahead when it does, ticks."""
        self._held: Pieces | None = None
        self._moments: list[tuple[Network, tuple[int, ...], Moment]] = []
        """Those that were asked for last, of each network one."""
        self.now = -1 << 64
        index = flow.graph.index
        self._reads = tuple(
            (-1, (core.value,), (core.value,))
            if isinstance(core, Constant)
            else (index[core.proposition], *_LETTERS[core.sense])
            for _, core in self.plan.leaves
        )

    def read(self) -> tuple[list[bool], list[bool]]:
        """The truth of the plan's leaves, the unknown taken for the worse and for the better."""
        values = self.flow.values
        reads = self._reads
        return (
            [worse[values[place] if place >= 0 else 0] for place, worse, _ in reads],
            [better[values[place] if place >= 0 else 0] for place, _, better in reads],
        )

    @property
    def watches(self) -> bool:  # type: ignore[override]
        """See `Rule`: what it owes may depend on what was before."""
        return self.plan.looks_back

    def begin(self, t: int, triggered: int) -> None:
        """See `Rule`."""
        attempt = self.clerk.opened(self, triggered, (WAITING, (t,)), self.is_sure)
        self.enter(triggered, plain=self.is_plain)
        self.attempts.append(attempt)
        self._begin_network()
        if self._letters is None or self.position < t:
            self.visit(t)
        self._note_doubt()
        # What was known of the position before the attempt began is no news.
        open_still = bool(self.attempts) and self.attempts[-1] is attempt
        if open_still and self.worse and self._judge(attempt, self.worse, self.better):
            self.attempts.pop()
        self._rest()
        self._foresee()
        self.restless = self.flow.gap is None and self.worse is not None

    def _begin_network(self) -> None:
        if self.worse is None:
            self.worse = Network(self.plan, self.flow.gap)
            self._letters = None
            self.now = -1 << 64

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, which the flow is at."""
        if self.plan.looks_back:
            self._begin_network()
        self.restless = False
        if self._letters is not None:
            self._look(2 * t)
        self.position = t
        if self.worse is not None:
            letters = self.read()
            if letters != self._letters or self.flow.gap is None:
                self._turn(t, self.worse, letters)
            self._look(2 * t + 1)
        self._foresee()
        self.restless = self.flow.gap is None and self.worse is not None

    def _turn(self, t: int, worse: Network, letters: tuple[list[bool], list[bool]]) -> None:
        self._letters = letters
        self._news = -FOREVER
        self._span = max(min(t - self._changed, self.plan.settles), self._span // 2)
        self._changed = t
        if self.better is None and letters[0] != letters[1]:
            self.better = worse.copy()
        self._note_doubt()
        ahead = self._far(t, self._span)
        worse.visit(t, letters[0], self._first_waiting(better=False), ahead)
        if self.better is not None:
            self.better.visit(t, letters[1], self._first_waiting(better=True), ahead)

    def _note_doubt(self) -> None:
        """Note in each attempt what was unknown first while it was open."""
        if self._letters is not None and self._letters[0] != self._letters[1]:
            for attempt in self.attempts:
                attempt.doubt = attempt.doubt or self.doubt

    def _first_waiting(self, *, better: bool) -> int | None:
        """The first position whose value is waited for in a network."""
        for attempt in self.attempts:
            token = (attempt.better or attempt.token) if better else attempt.token
            if token[0] == WAITING:
                position: int = token[1][0]
                return position
        return None

    def _look(self, limit: int, ahead: int = -FOREVER) -> None:
        """Let time come to a stamp, and hear of the decisions that this brings.

        Args:
            limit: the stamp.
            ahead: what the letter brings up to here if it stays is worked out at once, unless more
                is already.
        """
        networks = self._networks
        unforeseen = any(network.ahead < limit for network in networks)
        for network in networks:
            if network.ahead <= limit + 1:
                network.foresee(ahead)
            network.grow(limit)
        if not networks or limit <= self.now:
            return
        before, self.now = self.now, limit
        if unforeseen or self._news <= limit:
            self._hear(before)

    @property
    def _networks(self) -> list[Network]:
        if self.worse is None:
            return []
        return [self.worse] if self.better is None else [self.worse, self.better]

    def _hear(self, before: int) -> None:
        """Judge what became known after a stamp."""
        worse, better = self.worse, self.better
        if worse is None:
            return
        found = [span for network in self._networks for span in self._learnt(network, before)]
        for start, end in reversed(merged(found)):
            asked = self.attempts[start : end + 1]
            kept = [attempt for attempt in asked if not self._judge(attempt, worse, better)]
            self.attempts[start : end + 1] = kept
        if found:
            self._rest()

    def _rest(self) -> None:
        """Forget all if nothing is waited for."""
        if not self.plan.looks_back and not self._is_waited_for:
            self.worse = self.better = self._letters = None

    @property
    def _is_waited_for(self) -> bool:
        return any(
            WAITING in (attempt.token[0], (attempt.better or _NONE)[0]) for attempt in self.attempts
        )

    def _learnt(self, network: Network, before: int) -> Iterator[Range]:
        """The attempts, by first and last index, whose value became known after a stamp."""
        if not self.attempts:
            return
        gap = network.positions.gap
        oldest, youngest = (_position(self.attempts[end]) // gap for end in (0, -1))
        for left, right, at, slope in chain(*network.news[-1]):
            if right < oldest or left > youngest or not (slope or before < at <= self.now):
                continue
            first, last = left, right
            if slope:
                first = max(left, (before - at) // slope + 1)
                last = min(right, (self.now - at) // slope)
            start = bisect_left(self.attempts, first * gap, key=_position)
            end = bisect_right(self.attempts, last * gap, key=_position)
            if start < end:
                yield start, end - 1

    def _judge(self, attempt: Open, worse: Network, better: Network | None) -> bool:
        """Look at one attempt; returns whether it was decided."""
        t = _position(attempt)
        if attempt.token[0] == WAITING and (found := self._known(worse, t)):
            value, at = found
            if value or better is None:
                self._decided(attempt, value, at // 2, attempt.token)
                return True
            attempt.better = attempt.better or attempt.token
            attempt.token = (FAILED, (t,))
        token = attempt.better or attempt.token
        found = None if better is None or token[0] != WAITING else self._known(better, t)
        if found:
            value, at = found
            if not value:
                self._decided(attempt, False, at // 2, token)
                return True
            attempt.better = (PASSED, (t,))
        return False

    def _known(self, network: Network, t: int) -> Carried:
        """What is known by now of the position at `t`, and since which stamp, at least its own."""
        found = network.truth(t)
        if found is None or found[1] > self.now:
            return None
        return found[0], max(found[1], 2 * t)

    def _foresee(self) -> None:
        """Set when what is waited for is known next, and when that decides something."""
        self.due, self._next_decision, self._news = NEVER, NEVER, FOREVER
        for network in self._networks if self.attempts else ():
            for value, at in self._coming(network):
                self._news = min(self._news, at)
                if self._decides(network, value):
                    self._next_decision = min(self._next_decision, at // 2)
        self.due = min(self.due, self._news // 2)
        if self.due == NEVER:
            # As far as can be seen there is nothing: look again then.
            self.due = min([NEVER, *(network.ahead // 2 for network in self._networks)])

    def _coming(self, network: Network) -> Iterator[tuple[bool, int]]:
        """The values that attempts will have by a network, if the letter stays, and the stamps."""
        attempts, now, gap = self.attempts, self.now, network.positions.gap
        oldest, youngest = _position(attempts[0]) // gap, _position(attempts[-1]) // gap
        coming = [
            (value, piece)
            for value, pieces in zip((True, False), network.news[-1], strict=True)
            for piece in pieces
            if (piece[3] or piece[2] > now) and piece[0] <= youngest and piece[1] >= oldest
        ]
        if len(attempts) <= len(coming):
            for attempt in attempts:
                found = network.truth(_position(attempt))
                if found is not None and found[1] > now:
                    yield found
            return
        for value, (left, right, at, slope) in coming:
            # The first one of a piece is the soonest.
            first = max(left, (now - at) // slope + 1) if slope else left
            index = bisect_left(attempts, first * gap, key=_position)
            if index < len(attempts) and (t := _position(attempts[index]) // gap) <= right:
                yield value, at + slope * t

    def _decides(self, network: Network, value: bool) -> bool:
        """Whether a value in a network decides an attempt."""
        return self.better is None or value is (network is self.worse)

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are."""
        self._look(2 * t + 1, self._far(t + 1, _PATIENCE * (t - self._changed)))
        self._foresee()

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self._look(2 * t, self._far(t + 1, _PATIENCE * (t - self._changed)))
        self._foresee()

    def _far(self, t: int, span: int) -> int:
        """The stamp so many ticks behind an instant; if nothing more comes then, behind all."""
        return 2 * (t + span) if span < self.plan.settles else FOREVER

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        for network in self._networks:
            network.foresee(FOREVER)
        self._foresee()
        return self._next_decision

    def moment(self, network: Network, now: int) -> Moment:
        """How one of the networks stands at a stamp, worked out once for all attempts."""
        stands = (network.grown, network.positions.last, now)
        for one, its_own, made in self._moments:
            if one is network and its_own == stands:
                return made
        made = Moment(network, now)
        self._moments = [*self._moments[-1:], (network, stands, made)]
        return made

    def situation(self, t: int) -> object:
        """What is known as seen from `t`; equal for runs that go on alike."""
        standing = frozenset(
            (attempt.token[0], attempt.better and attempt.better[0], _position(attempt) - t)
            for attempt in self.attempts
        )
        networks = (self.worse, self.better)
        return standing, tuple(network and network.relative(t) for network in networks)

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an attempt true; to be asked last."""
        if attempt.token[0] != WAITING or self.worse is None:
            return False
        if self._held is None:
            self._held = held_at_end(self.worse, end, reached)
        return stamp(self._held, _position(attempt) // self.worse.positions.gap) is not None


def _position(attempt: Open) -> int:
    """The instant of the position whose value is an attempt's."""
    return attempt.token[1][0]


_NONE: Token = (FAILED, ())
