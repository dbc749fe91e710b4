"""Open attempts as positions of a delay network, which is shared by all of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import INFINITY, Token
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
        self._held: Pieces | None = None
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
        if self.worse is None or self.position < t:
            self._begin_network()
            self.visit(t)
        else:
            self._note_doubt()
            self._look(2 * t + 1)
        return attempt

    def _begin_network(self) -> None:
        if self.worse is None:
            self.worse = Network(self.plan, self.flow.gap)
            self._letters = None

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, which the flow is at."""
        if self.plan.looks_back:
            self._begin_network()
        self.position = t
        self.restless = False
        if self._letters is not None:
            self._look(2 * t)
        if self.worse is None:
            return
        letters = self.read()
        if letters != self._letters or self.flow.gap is None:
            self._step(t, self.worse, letters)
        self._look(2 * t + 1)
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
        """Hear of all decisions that are known at a stamp."""
        worse = self.worse
        if worse is None:
            return
        self.due = INFINITY
        kept, waiting = [], False
        for attempt in self.attempts:
            due = self._judge(attempt, worse, self.better or worse, limit)
            if due is not None:
                kept.append(attempt)
                waiting = waiting or WAITING in (attempt.token[0], (attempt.better or _NONE)[0])
                self.due = min(self.due, due)
        self.attempts = kept
        if not waiting and not self.plan.looks_back:
            self.worse = self.better = self._letters = None

    def _judge(self, attempt: Open, worse: Network, better: Network, limit: int) -> int | None:
        """Look at one attempt; returns when it is due, `None` if it was decided."""
        (position,) = attempt.token[1]
        due = INFINITY
        if attempt.token[0] == WAITING and (found := worse.truth(position)) is not None:
            value, at = found
            if at > limit:
                due = at // 2
            elif value:
                self.clerk.decided(self, attempt, True, at // 2, attempt.token)
                return None
            elif better is worse:
                self.clerk.decided(self, attempt, False, at // 2, attempt.token)
                return None
            else:
                attempt.better = attempt.better or attempt.token
                attempt.token = (FAILED, (position,))
        token = attempt.better or attempt.token
        found = None if better is worse or token[0] != WAITING else better.truth(position)
        if found is not None:
            value, at = found
            if at > limit:
                due = min(due, at // 2)
            elif not value:
                self.clerk.decided(self, attempt, False, at // 2, token)
                return None
            else:
                attempt.better = (PASSED, (position,))
        return due

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are."""
        self._look(2 * t + 1)

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self._look(2 * t)

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        return self.due

    def cuts(self, t: int) -> Iterable[int]:
        """The instants after `t` at which what is known changes, the letters staying."""
        for network in (self.worse, self.better):
            if network is not None:
                yield from network.cuts(t)

    def situation(self, t: int) -> object:
        """What is known as seen from `t`; equal for runs that go on alike."""
        standing = frozenset(
            (attempt.token[0], attempt.better and attempt.better[0], attempt.token[1][0] - t)
            for attempt in self.attempts
        )
        networks = (self.worse, self.better)
        return standing, tuple(network and network.relative(t) for network in networks)

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an attempt true; to be asked last."""
        if attempt.token[0] != WAITING or self.worse is None:
            return False
        if self._held is None:
            self._held = self.worse.held_at_end(end, reached)
        return stamp(self._held, attempt.token[1][0] // self.worse.positions.gap) is not None


_NONE: Token = (FAILED, ())
