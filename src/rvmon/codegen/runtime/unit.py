"""The clockwork of generated monitors: what changes, when, and whom that concerns."""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from itertools import product
from typing import TYPE_CHECKING, Any

from rvmon.codegen.runtime.past import History, Previous, Since
from rvmon.codegen.runtime.rule import Rule
from rvmon.codegen.runtime.table import NEVER

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

FALSE, UNKNOWN, TRUE = 0, 1, 2
LIMIT = 1 << 62
MISSING = object()


class Unit:
    """A generated monitor without its generated part, which fills in the constants below.

    Args:
        machines: per requirement, what judges its attempts.
        absent: the names without a source.

    Attributes:
        began: the instant of the first sample; `None` before it.
        after: samples have to be later than this instant.
        wake: before this instant, no sample coming, nothing happens.
        news: whether something was decided since it was last set to `False`.
    """

    SIGNALS: tuple[str, ...] = ()
    EVENTS: tuple[str, ...] = ()
    GAP: int | None = 1
    NODES = 0
    EVALUATE: tuple[Callable[[Any, int], int], ...] = ()
    PARENTS: tuple[int, ...] = ()
    LETTERS: tuple[int, ...] = ()
    """Per node, a bit for each requirement whose letter it is part of."""
    TRIGGERS: tuple[int, ...] = ()
    """Per node, a bit for each requirement that it triggers."""
    READERS: Mapping[str, int]
    """Per name, a bit for each leaf that reads it."""
    MOMENTARY: tuple[tuple[int, tuple[str, ...]], ...] = ()
    """The leaves that speak of one position, with the events that they need a source of."""
    STATEFUL = 0
    PAST: Mapping[int, tuple[int | None, int | None]]
    """Per node that remembers, its operator and bounds."""
    HISTORIES: tuple[int, ...] = ()
    RULES: tuple[tuple[Callable[[list[int]], tuple[int, int]], int, bool, bool], ...] = ()
    """Per requirement: the letters, the node of its trigger, pulse, episodic."""

    def __init__(self, machines: Sequence[Any], absent: frozenset[str] = frozenset()) -> None:
        self.machines = machines
        self.absent = absent

    def restart(self, clerk: Any) -> None:
        """Begin a run.

        Args:
            clerk: makes attempts and hears of decisions.
        """
        self.clerk = clerk
        absent = self.absent
        self.began: int | None = None
        self.v = [UNKNOWN] * self.NODES
        self.since = [0] * self.NODES
        self.until: dict[tuple[int, int], int] = {}
        self.s: list[Any] = [None] * len(self.SIGNALS)
        self.first: list[int | None] = [None] * len(self.SIGNALS)
        self.silent = [UNKNOWN if name in absent else FALSE for name in self.EVENTS]
        self.o = list(self.silent)
        self.p: list[list[Any]] = [[] for _ in self.EVENTS]
        self.u: set[str] = set()
        self.c: dict[int, int] = {}
        self.h = [History() if index in self.HISTORIES else None for index in range(len(self.s))]
        self.past = {place: self._operator(*spec) for place, spec in self.PAST.items()}
        self.momentary = 0
        for place, needs in self.MOMENTARY:
            if not absent.intersection(needs):
                self.momentary |= 1 << place
        self.rules = [
            Rule(index, machine, letters, pulse, episodic, self.GAP, self.v, clerk)
            for index, ((letters, _, pulse, episodic), machine) in enumerate(
                zip(self.RULES, self.machines)  # noqa: B905
            )
        ]
        self.origin: int | None = None
        self.position = 0
        self.before = 0
        self.after = -LIMIT
        self.wake = -LIMIT
        self.news = False
        self.dirty = 0
        self.fading = 0
        self.restless = 0
        self.repeating = 0
        self.gathered = False
        self.awaited = NEVER
        self.wakes = [NEVER] * self.NODES
        self.stale_at = [NEVER] * len(self.SIGNALS)
        self.expired: dict[int, tuple[int, int]] = {}
        self.timers: list[tuple[int, int]] = []
        self.dues: list[tuple[int, int]] = []
        self.due_at = [NEVER] * len(self.rules)

    def _operator(self, low: int | None, high: int | None) -> Any:
        gap = self.GAP or 1
        return Previous(gap) if low is None else Since(low, high, gap)

    def step(self, t: int, values: Mapping[str, Any]) -> Sequence[Any]:
        """Take one sample; returns what it decided."""
        raise NotImplementedError

    def take(self, t: int, values: Mapping[str, Any]) -> None:
        """Take the updates of a valid sample; time has come to `t` − 1 before."""
        raise NotImplementedError

    # What nodes call.

    def since_(self, place: int, t: int, left: int, right: int) -> int:
        """The value of a `since` at `t`."""
        node = self.past[place]
        value: int = node.step(t, self.before, left, right)
        self.set_wake(place, node.wake)
        return value

    def previous_(self, place: int, t: int, operand: int) -> int:
        """The value of a `previous` at `t`."""
        node = self.past[place]
        value: int = node.step(t, operand)
        self.set_wake(place, node.wake)
        return value

    def elapsed_(self, place: int, t: int, duration: int) -> int:
        """Whether so much time has passed since the first position."""
        due = (self.origin or 0) + duration
        self.set_wake(place, due if t < due else NEVER)
        return FALSE if t < due else TRUE

    def over_(self, events: Sequence[int], truth: Callable[[dict[int, Any]], int]) -> int:
        """The truth of a comparison over all occurrences of the events whose fields it reads."""
        for event in events:
            if self.silent[event] == UNKNOWN:
                return UNKNOWN
        found = FALSE
        for payloads in product(*[self.p[event] for event in events]):
            one = UNKNOWN if None in payloads else truth(dict(zip(events, payloads)))  # noqa: B905
            if one > found:
                found = one
        return found

    # What samples call.

    def occur(self, event: int, value: Any) -> None:
        """Take what a sample says of an event."""
        self.gathered = True
        payloads: tuple[Any, ...]
        if value is True:
            truth, payloads = TRUE, ({},)
        elif value is None:
            truth, payloads = UNKNOWN, (None,)
        elif value is False:
            truth, payloads = FALSE, ()
        elif isinstance(value, (tuple, list)):
            payloads = tuple(value)
            truth = max([UNKNOWN if one is None else TRUE for one in payloads], default=FALSE)
        else:
            truth, payloads = TRUE, (value,)
        self.p[event].extend(payloads)
        if truth > self.o[event]:
            self.o[event] = truth

    def mark(self, t: int, signal: int, value: Any) -> None:
        """Take the update of a signal that more is asked of than its value."""
        self.gathered = True
        self.u.add(self.SIGNALS[signal])
        history = self.h[signal]
        if history is not None:
            changed = history.update(t, value)
            self.c[signal] = max(changed, self.c.get(signal, FALSE))

    def set_stale(self, signal: int, t: int) -> None:
        """Note when a signal that is not awaited to be so will be stale."""
        heappush(self.timers, (t, self.NODES + signal))
        self.stale_at[signal] = t
        # The update may have changed no value: then nothing else has the timer seen to.
        self.wake = min(self.wake, t)

    def set_wake(self, place: int, t: int) -> None:
        """Note when a node changes by itself."""
        if self.wakes[place] != t:
            self.wakes[place] = t
            if t < NEVER:
                heappush(self.timers, (t, place))

    # Time.

    def next_change(self) -> int:
        """The first position after this one at which a value can change by time alone."""
        if self.GAP is None or self.origin is None:
            return NEVER
        timers = self.timers
        while timers:
            t, code = timers[0]
            if code < self.NODES:
                if self.wakes[code] == t:
                    break
                heappop(timers)
            else:
                actual = self.stale_at[code - self.NODES]
                if actual == t:
                    break
                heappop(timers)
                if actual < NEVER:
                    heappush(timers, (actual, code))
        found = timers[0][0] if timers else NEVER
        if self.fading:
            found = min(found, self.position + self.GAP)
        if found >= NEVER:
            return NEVER
        return self.position + -(-(found - self.position) // self.GAP) * self.GAP

    def next_due(self) -> int:
        """The next instant at which an attempt can be decided."""
        dues = self.dues
        while dues and self.due_at[dues[0][1]] != dues[0][0]:
            heappop(dues)
        return dues[0][0] if dues else NEVER

    def next_position(self) -> int:
        """The next position at which something can change without a further sample."""
        found = min(self.awaited, self.next_change())
        if self.repeating and self.GAP is not None:
            found = min(found, self.position + self.GAP)
        return found

    def note(self, rule: Rule) -> None:
        """Note when a requirement is due, and whether it has to be asked at the next position."""
        bit = 1 << rule.index
        self.restless = self.restless | bit if rule.restless else self.restless & ~bit
        if rule.due != self.due_at[rule.index]:
            self.due_at[rule.index] = rule.due
            if rule.due < NEVER:
                heappush(self.dues, (rule.due, rule.index))
                if len(self.dues) > 64 + 8 * len(self.rules):
                    self.dues = [(t, i) for i, t in enumerate(self.due_at) if t < NEVER]
                    heapify(self.dues)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`, positions there included, without a further sample."""
        while True:
            position = self.next_position()
            stop = min(position - 1, limit)
            while self.next_due() <= stop:
                rule = self.rules[self.dues[0][1]]
                rule.pass_to(stop)
                self.note(rule)
            if position > limit:
                break
            self.visit(position)
        self.set_alarm()

    def set_alarm(self) -> None:
        """Work out when something happens next."""
        if self.origin is None:
            return
        wake = min(self.next_position(), self.next_due())
        if self.GAP is None:
            if self.fading or self.restless or self.repeating or self.STATEFUL:
                wake = self.position
            elif self.timers:
                wake = min(wake, self.timers[0][0])
        self.wake = wake

    def sampled(self, t: int) -> None:
        """Go on after the updates of a sample were taken."""
        gap = self.GAP or 1
        if self.began is None:
            self.began = t
        self.awaited = -(-t // gap) * gap
        if self.awaited == t:
            self.visit(t)
        else:
            self.reach(t)
        self.set_alarm()

    def visit(self, t: int) -> None:
        """Move to the position at `t`."""
        dirty = self.dirty | self.fading
        gap = self.GAP
        first = self.origin is None
        if first:
            self.origin = t
            dirty = (1 << self.NODES) - 1
            self.since[:] = [t] * self.NODES
        elif gap is None:
            dirty |= self.STATEFUL
        self.before = self.position if gap is None else t - gap
        if self.timers and self.timers[0][0] <= t:
            dirty |= self._ring(t)
        letters = triggers = fading = 0
        v = self.v
        evaluate = self.EVALUATE
        momentary = self.momentary
        while dirty:
            bit = dirty & -dirty
            dirty ^= bit
            place = bit.bit_length() - 1
            new = evaluate[place](self, t)
            if new and bit & momentary:
                fading |= bit
            old = v[place]
            if new != old:
                self.until[place, old] = self.before
                self.since[place] = t
                v[place] = new
                dirty |= self.PARENTS[place]
                letters |= self.LETTERS[place]
                triggers |= self.TRIGGERS[place]
        self.fading = fading
        self.dirty = 0
        self.position = t
        self.awaited = NEVER
        letters |= self.restless
        dues = self.dues
        while dues and dues[0][0] <= t:
            due, index = heappop(dues)
            if self.due_at[index] == due:
                self.due_at[index] = NEVER
                letters |= 1 << index
        rules = self.rules
        while letters:
            bit = letters & -letters
            letters ^= bit
            rule = rules[bit.bit_length() - 1]
            if rule.attempts:
                rule.visit(t)
                self.note(rule)
        triggers |= self.repeating
        if first:
            triggers = (1 << len(rules)) - 1
        while triggers:
            bit = triggers & -triggers
            triggers ^= bit
            index = bit.bit_length() - 1
            place = self.RULES[index][1]
            if place < 0:
                continue
            rule = rules[index]
            if rule.starts(v[place]):
                rule.begin(t, t)
                self.note(rule)
            self.repeating = self.repeating | bit if rule.repeats else self.repeating & ~bit
        if self.gathered:
            self._leave()

    def _ring(self, t: int) -> int:
        """The leaves and operators that time alone makes change at `t`."""
        dirty = 0
        timers = self.timers
        while timers and timers[0][0] <= t:
            due, code = heappop(timers)
            if code < self.NODES:
                if self.wakes[code] == due:
                    self.wakes[code] = NEVER
                    dirty |= 1 << code
                continue
            signal = code - self.NODES
            actual = self.stale_at[signal]
            if actual <= t:
                self.s[signal] = None
                self.stale_at[signal] = NEVER
                count, at = self.expired.get(signal, (0, actual))
                self.expired[signal] = (count + 1, at)
                dirty |= self.READERS[self.SIGNALS[signal]]
            elif actual < NEVER:
                heappush(timers, (actual, code))
        return dirty

    def _leave(self) -> None:
        """Forget what occurred at the position."""
        self.gathered = False
        self.o[:] = self.silent
        for payloads in self.p:
            payloads.clear()
        self.u.clear()
        self.c.clear()

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, from `t − 1`."""
        due = []
        while self.next_due() <= t:
            _, index = heappop(self.dues)
            self.due_at[index] = NEVER
            due.append(self.rules[index])
        for rule in due:
            rule.reach(t)
            self.note(rule)

    def advance(self, t: int) -> None:
        """Learn that no sample before `t` will come; `t` is later than all before."""
        self.through(t - 1)
        self.reach(t)
        self.set_alarm()

    def last_position(self, end: int) -> int:
        """The last position at or before `end`, up to which time has come."""
        if self.GAP is None:
            return self.position
        return self.position + (end - self.position) // self.GAP * self.GAP

    def close(self, end: int, reached: int) -> None:
        """Come to the end of the trace; time has come to `end` before."""
        for rule in self.rules:
            rule.pass_to(end)
        for rule, (_, place, _, _) in zip(self.rules, self.RULES):  # noqa: B905
            if place < 0 and self.origin is not None:
                rule.begin(self.last_position(end), end)
        for rule in self.rules:
            rule.reach(reached)
