"""Open attempts as positions of a delay network, which is shared by all of them."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import INFINITY, Token
from rvmon.dataflow.alone import Moment
from rvmon.dataflow.at_end import held_at_end
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.network import Network
from rvmon.dataflow.nodes import Plan
from rvmon.dataflow.pieces import Pieces, stamp
from rvmon.formula.core import Constant, Sense
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.bench import Bench, Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.trace.sample import Scalar

WAITING = PASSED + 1
"""In the place of a location: neither `FAILED` nor `PASSED`.

The token of an attempt is how it stands in a network, and the position whose value it is.
"""


class NetworkJudge(Bench):
    """Judges by a network, or by two as soon as something was unknown.

    Attributes:
        plan: of the networks.
        worse: the network that takes the unknown for the worse; `None` while nothing is asked.
        better: the one that takes it for the better; `None` as long as both are the same.
        attempts: those whose value is not known.
        now: the stamp that time has come to.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        plan: Plan,
        flow: Flow,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
    ) -> None:
        super().__init__(compiled, flow, clerk, captured)
        self.plan = plan
        self.worse: Network | None = None
        self.better: Network | None = None
        self._letters: tuple[list[bool], list[bool]] | None = None
        self._stayed = plan.settles
        """How long the letter had stayed before it changed last, ticks."""
        self._held: Pieces | None = None
        self._moments: list[tuple[Network, tuple[int, ...], Moment]] = []
        """Those that were asked for last, of each network one."""
        self.now = -1 << 64
        index = flow.graph.index
        self._reads = tuple(
            (-1, core.value)
            if isinstance(core, Constant)
            else (index[core.proposition], core.sense)
            for _, core in plan.leaves
        )

    def read(self) -> tuple[list[bool], list[bool]]:
        """The truth of the plan's leaves, the unknown taken for the worse and for the better."""
        values = self.flow.values
        worse, better = [], []
        for place, sense in self._reads:
            if isinstance(sense, bool):
                worse.append(sense)
                better.append(sense)
                continue
            value = values[place]
            certain = value == (TRUE if sense is Sense.TRUE else FALSE)
            worse.append(certain)
            better.append(certain or (value == UNKNOWN and sense is not Sense.KNOWN_FALSE))
        return worse, better

    def begin(self, t: int, triggered: int) -> Open:
        """Start an attempt at the position `t`, which the flow is at."""
        attempt = Open(triggered, (WAITING, (t,)), self.seen)
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
        self._foresee(self._stayed)
        self.restless = self.flow.gap is None and self.worse is not None
        return attempt

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
        before, self.position = self.position, t
        if self.worse is None:
            return
        letters = self.read()
        if letters != self._letters or self.flow.gap is None:
            self._step(t, self.worse, letters)
        self._look(2 * t + 1)
        if t > before:
            self._stayed = t - before
        self._foresee(self._stayed)
        self.restless = self.flow.gap is None and self.worse is not None

    def _step(self, t: int, worse: Network, letters: tuple[list[bool], list[bool]]) -> None:
        self._letters = letters
        if self.better is None and letters[0] != letters[1]:
            self.better = worse.copy()
        self._note_doubt()
        worse.visit(t, letters[0], self._first_waiting(better=False))
        if self.better is not None:
            self.better.visit(t, letters[1], self._first_waiting(better=True))

    def _note_doubt(self) -> None:
        """Note in each attempt what was unknown first while it was open."""
        if self._letters is not None and self._letters[0] != self._letters[1]:
            for attempt in self.attempts:
                attempt.doubt = attempt.doubt or self._doubt()

    def _first_waiting(self, *, better: bool) -> int | None:
        """The first position whose value is waited for in a network."""
        for attempt in self.attempts:
            token = (attempt.better or attempt.token) if better else attempt.token
            if token[0] == WAITING:
                return token[1][0]
        return None

    def _look(self, limit: int) -> None:
        """Let time come to a stamp, and hear of the decisions that this brings."""
        worse, better = self.worse, self.better
        if worse is None:
            return
        self.now = max(self.now, limit)
        worse.grow(limit)
        asked = self._asked_in(worse)
        if better is not None:
            better.grow(limit)
            asked = sorted({*asked, *self._asked_in(better)})
        decided = {index for index in asked if self._judge(self.attempts[index], worse, better)}
        if decided:
            kept = enumerate(self.attempts)
            self.attempts = [attempt for index, attempt in kept if index not in decided]
        if asked:
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

    def _asked_in(self, network: Network) -> list[int]:
        """The attempts, by index, whose value became known since the last time."""
        gap = network.positions.gap
        fresh, network.fresh = network.fresh, []
        found: set[int] = set()
        for first, last in fresh:
            start = bisect_left(self.attempts, first * gap, key=_position)
            end = bisect_right(self.attempts, last * gap, key=_position)
            found.update(range(start, end))
        return sorted(found)

    def _judge(self, attempt: Open, worse: Network, better: Network | None) -> bool:
        """Look at one attempt; returns whether it was decided."""
        t = _position(attempt)
        if attempt.token[0] == WAITING and (found := worse.truth(t)) is not None:
            value, at = found
            if value or better is None:
                self.clerk.decided(self, attempt, value, at // 2, attempt.token)
                return True
            attempt.better = attempt.better or attempt.token
            attempt.token = (FAILED, (t,))
        token = attempt.better or attempt.token
        found = None if better is None or token[0] != WAITING else better.truth(t)
        if found is not None:
            value, at = found
            if not value:
                self.clerk.decided(self, attempt, False, at // 2, token)
                return True
            attempt.better = (PASSED, (t,))
        return False

    def _foresee(self, span: int) -> None:
        """Set when the next decision is due, or when to look again.

        Args:
            span: ticks for which the letter has stayed: to look much further may be in vain.
        """
        if self.flow.gap is None:
            self.due = max(self._next_over(), self.now // 2 + 1)
            return
        span = min(2 * span, self.plan.settles)
        self.due = self._foreseen(span)
        if self.due == INFINITY and self.worse is not None and span < self.plan.settles:
            self.due = self.now // 2 + span

    def _next_over(self) -> int:
        """Before which instant time alone decides nothing, where only samples are positions."""
        if not self._is_waited_for:
            return INFINITY
        known = [network.next_over for network in (self.worse, self.better) if network is not None]
        return min((one for one in known if one is not None), default=INFINITY)

    def _foreseen(self, span: int) -> int:
        """The instant of the next decision within a span, the letter staying."""
        found = INFINITY
        for network in (self.worse, self.better):
            if network is None or not self._is_waited_for:
                continue
            ahead = network.copy()
            ahead.fresh = []
            ahead.grow(self.now + 2 * span)
            for index in self._asked_in(ahead):
                known = ahead.truth(_position(self.attempts[index]))
                if known is not None and self._decides(network, known[0]):
                    found = min(found, known[1] // 2)
        return found

    def _decides(self, network: Network, value: bool) -> bool:
        """Whether a value in a network decides an attempt."""
        return self.better is None or value is (network is self.worse)

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are."""
        self._look(2 * t + 1)
        self._foresee(t - self.position)

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self._look(2 * t)
        self._foresee(t - self.position)

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        return self._foreseen(self.plan.settles)

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
