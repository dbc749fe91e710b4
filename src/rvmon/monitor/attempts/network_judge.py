"""Open attempts as positions of a delay network, which is shared by all of them."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from typing import Any

from rvmon.automaton.location import FAILED, PASSED, Token
from rvmon.dataflow.at_end import held_at_end
from rvmon.dataflow.journal import Journal
from rvmon.dataflow.network import FOREVER, Network
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.dataflow.piecewise import Pieces, stamp
from rvmon.dataflow.ranges import merged
from rvmon.dataflow.sweep import Carried
from rvmon.dataflow.time_decisions import Moment
from rvmon.formula.state import FALSE, TRUE
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.attempts.network_letters import Letters, letter_reader
from rvmon.monitor.attempts.waiting import learnt, position_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.network import WAITING
from rvmon.plan.standing import Standing
from rvmon.plan.stood import Stood
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Scalar

PATIENCE = 6
"""So often it is looked before it is worked out what time brings if the letter stays."""


class NetworkJudge(AttemptJudge):
    """Judges by a network, or by two as soon as something was unknown.

    Attributes:
        plan: of the networks.
        worse: the network that takes the unknown for the worse; `None` while nothing is asked.
        better: the one that takes it for the better; `None` as long as both are the same.
        attempts: those whose value is not known.
        now: the stamp that the networks have come to.
        sleeps: an instant before which nothing becomes known, whatever letters come: till then
            these are but noted.
    """

    STATE = (*AttemptJudge.STATE, "worse", "better", "now", "sleeps", "_letters", "_held")

    leaps = True

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
        self._letters: Letters | None = None
        self._held: Pieces | None = None
        self._journals: list[Journal | None] = [None, None]
        self._stood: tuple[tuple[int, ...], Stood] | None = None
        self._moments: list[tuple[Network, tuple[int, ...], Moment]] = []
        """Those that were asked for last, of each network one."""
        self.now = -1 << 64
        self.sleeps = -NEVER
        self._bounded_at = -FOREVER
        """The stamp as of which `sleeps` holds for all that begins then, too."""
        self._looks = 0
        """How often it was looked since the letter changed."""
        self._ahead: list[tuple[bool, Pieces]] | None = None
        """What time alone makes known of attempts, the letter staying, if that was worked out."""
        self.texts = tuple(text for _, text in self.leaves)
        self._read = letter_reader(self.plan, flow.graph)

    @property
    def watches(self) -> bool:  # type: ignore[override]
        """See `Rule`: what it owes may depend on what was before."""
        return self.plan.looks_back

    def begin(self, t: int, triggered: int) -> None:
        """See `Rule`."""
        is_behind, self.position = self.position < t, t
        attempt = self.clerk.opened(self, triggered, (WAITING, (t,)), self.is_sure)
        self.enter(triggered, plain=self.is_plain)
        self.attempts.append(attempt)
        self._begin_network()
        if self._letters is None or is_behind:
            self.visit(t)
        self._note_doubt()
        self._stood = None
        if self.sleeps > t and self.now <= 2 * t and self._letters is not None:
            delay = min(map(self.compiled.network_delay, self._letters))
            self.sleeps = min(self.sleeps, t + delay)
            if delay > (self.flow.gap or 1):
                self.due = min(self.due, self.sleeps)
                return
        self._join(attempt, t)

    def _join(self, attempt: Open, t: int) -> None:
        """Judge what is known of an attempt that began at the position `t`."""
        self._look(2 * t + 1)
        # What was known of the position before the attempt began is no news.
        open_still = bool(self.attempts) and self.attempts[-1] is attempt
        if open_still and self.worse and self._judge(attempt, self.worse, self.better):
            self.attempts.pop()
            self._rest()
        elif self._bounded_at != 2 * t + 1:
            self._rest()

    def _begin_network(self) -> None:
        if self.worse is None:
            self.worse = Network(self.plan, self.flow.gap)
            self._letters = None
            self._journals = [None, None]
            self.now = -1 << 64
            self.sleeps = -NEVER if self.plan.looks_back else NEVER

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, which the flow is at."""
        if self.plan.looks_back:
            self._begin_network()
        letters = self._read(self.flow.values)
        if self.due <= t and letters[0] != letters[1]:
            self._look(2 * t)
        self.position = t
        if self.worse is not None:
            roused = False
            if letters != self._letters or self.flow.gap is None:
                self._turn(t, self.worse, letters)
                roused = any(map(Network.is_roused, self._networks, letters))
                # What is due was worked out for the letter before; `sleeps` holds for all of them.
                self.due = min(self.due, self.sleeps)
            if self.due > t and self.sleeps > t and not roused:
                self.restless = self.flow.gap is None
                return
            self._look(2 * t + 1)
        self._rest()

    def _turn(self, t: int, worse: Network, letters: Letters) -> None:
        self._letters, self._looks, self._ahead = letters, 0, None
        if self.better is None and letters[0] != letters[1]:
            self.better, self._journals[1] = worse.copy(), None
        self._note_doubt()
        self._journal(worse).note(worse, t, letters[0])
        if (better := self.better) is not None:
            self._journal(better).note(better, t, letters[1])

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

    def _look(self, limit: int) -> None:
        """Let time come to a stamp, and hear of the decisions that this brings."""
        if self.now < limit and self.worse is not None:
            self._looks += 1
            for network in self._networks:
                wanted = self._first_waiting(better=network is self.better)
                wanted = limit // 2 if wanted is None else wanted
                self._journal(network).grow(network, limit, wanted)
            self._hear(limit)

    def _journal(self, network: Network) -> Journal:
        """What brings a network its input."""
        index = int(network is not self.worse)
        journal = self._journals[index]
        if journal is None or journal.is_over:
            journal = self._journals[index] = Journal(network)
        return journal

    def journal_now(self, verdict: bool) -> tuple[Journal, int] | None:
        """The journal of the network that brings a verdict now, and how far that has come."""
        journal = self._journals[not verdict and self.better is not None]
        return None if journal is None else (journal, len(journal))

    @property
    def _networks(self) -> list[Network]:
        if self.worse is None:
            return []
        return [self.worse] if self.better is None else [self.worse, self.better]

    def _hear(self, now: int) -> None:
        """Judge what became known when the networks came to a stamp."""
        self.now = now
        self._stood = None
        worse, better = self.worse, self.better
        if worse is None:
            return
        found = [one for network in self._networks for one in learnt(self.attempts, network)]
        for start, end in reversed(merged(found) if len(found) > 1 else found):
            asked = self.attempts[start : end + 1]
            kept = [attempt for attempt in asked if not self._judge(attempt, worse, better)]
            self.attempts[start : end + 1] = kept

    def _rest(self) -> None:
        """Forget all if nothing is waited for; set when time alone may make known what is."""
        self._bounded_at = -FOREVER
        if not self._is_waited_for:
            self.due = NEVER
            if not self.plan.looks_back:
                self.worse = self.better = self._letters = None
        elif self._looks > PATIENCE:
            self.due = min((at // 2 for _, at in self._coming()), default=NEVER)
        else:
            if self._looks == 1 and not self.plan.looks_back:
                self.sleeps, self._bounded_at = self._soonest(), self.now
            # Mostly another letter comes first: it is not worked out what is next.
            self.due = max((self.now + 1) // 2, self.sleeps)
        self.restless = self.flow.gap is None and self.worse is not None

    def _soonest(self) -> int:
        """An instant before which no network has news of what is waited for in it."""
        found = NEVER
        for network in self._networks:
            first = self._first_waiting(better=network is self.better)
            if first is not None:
                found = min(found, network.soonest_news(first))
        return found

    @property
    def stood(self) -> tuple[tuple[int, ...], Stood]:
        """What is read of the input as it stands, and the propositions, to be kept."""
        if self._stood is None:
            flow, places = self.flow, self.places
            until = {
                3 * place + value: flow.last_with(place, value, flow.position)
                for place in places
                for value in (FALSE, TRUE)
            }
            values, since = (
                {place: of[place] for place in places} for of in (flow.values, flow.since)
            )
            stood = Stood(flow, values, since, until, {}, flow.position, flow.begun)
            self._stood = self.seen, stood
        return self._stood

    @property
    def _is_waited_for(self) -> bool:
        return any(
            WAITING in (attempt.token[0], (attempt.better or _NONE)[0]) for attempt in self.attempts
        )

    def _judge(self, attempt: Open, worse: Network, better: Network | None) -> bool:
        """Look at one attempt; returns whether it was decided."""
        t = position_of(attempt)
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
        """What is known of the position at `t`, and since which stamp, at least its own."""
        found = network.truth(t)
        return None if found is None else (found[0], max(found[1], 2 * t))

    def _coming(self) -> Iterator[tuple[bool, int]]:
        """What time alone makes known of attempts, if the letter stays.

        Yields:
            Whether that decides the attempt, and the stamp; of attempts that one piece of what
            comes speaks of, those of the first one, which is the soonest.
        """
        if self._ahead is None:
            self._ahead = list(self._foreseen())
        attempts, gap, now = self.attempts, self.flow.gap or 1, self.now
        for decides, pieces in self._ahead:
            for left, right, at, slope in pieces:
                if slope:
                    left = max(left, (now - at) // slope + 1)
                elif at <= now:
                    continue
                index = bisect_left(attempts, left * gap, key=position_of)
                if index < len(attempts):
                    t = position_of(attempts[index]) // gap
                    if t <= right:
                        yield decides, at + slope * t

    def _foreseen(self) -> Iterator[tuple[bool, Pieces]]:
        """What time alone makes known of positions, and whether that decides their attempts."""
        for network in self._networks:
            ahead = network.copy()
            ahead.grow(FOREVER)
            for value, pieces in zip((True, False), ahead.news[-2:], strict=True):
                yield self._decides(network, value), pieces

    def _decides(self, network: Network, value: bool) -> bool:
        """Whether a value in a network decides an attempt."""
        return self.better is None or value is (network is self.worse)

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are."""
        self._wait(2 * t + 1)

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self._wait(2 * t)

    def _wait(self, limit: int) -> None:
        self._look(limit)
        self._rest()

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        return min((at // 2 for decides, at in self._coming() if decides), default=NEVER)

    def moment(self, network: Network, now: int) -> Moment:
        """How one of the networks stands at a stamp, worked out once for all attempts."""
        stands = (network.grown, len(network.noted), now)
        for one, its_own, made in self._moments:
            if one is network and its_own == stands:
                return made
        made = Moment(network, now)
        self._moments = [*self._moments[-1:], (network, stands, made)]
        return made

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an attempt true; to be asked last."""
        if attempt.token[0] != WAITING or self.worse is None:
            return False
        if self._held is None:
            self._held = held_at_end(self.worse, end, reached)
        return stamp(self._held, position_of(attempt) // self.worse.positions.gap) is not None


_NONE: Token = (FAILED, ())
