"""State formulas with the judges that read them, driven through time.

All requirements without captured values share one evaluator. Each instance of a `for each`, and
each attempt of a requirement with `let`, has one of its own, because its propositions are its own.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from typing import Protocol

from rvmon.formula.state import FALSE, TRUE, Lapsed
from rvmon.monitor.attempts.attempt_judge import AttemptJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.graph import Graph
from rvmon.plan.inputs import Reported
from rvmon.plan.outages import Outage, Outages
from rvmon.runtime.copies import remembered, take_all, take_inputs, take_nodes
from rvmon.runtime.nodes import Nodes
from rvmon.runtime.past import History
from rvmon.runtime.rule import Rule
from rvmon.runtime.schedule import Schedule
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Payload, Scalar
from rvmon.trace.time import TIME_LIMIT


class WatchedAttempt(Protocol):
    """A captured attempt as the evaluator sees it in which it was triggered.

    Attributes:
        evaluator: its own.
    """

    evaluator: Evaluator

    def keeps(self, t: int) -> bool:
        """Look at the position `t`: whether to look at the next as well."""


class Evaluator(Nodes, Schedule):
    """Generated state formulas and the requirements that read them.

    It stands as `rvmon.plan.standing.Standing` for its judges.

    Args:
        outages: what is not known at first.
        captured: values of `let` and `for each`.
        made_for: the requirement of an instance or of a captured attempt; `None`: all others.

    Attributes:
        judges: of its rules, those that have attempts, in the order of the file.
        starters: of its rules, those of which attempts start in it; where attempts have evaluators
            of their own, what makes them.
        opens_at: nothing starts in it before this instant; `NEVER`: nothing does.
        waiting: samples whose position has not come yet.
        watched: the captured attempts that were triggered in this one.
        blurs: of a captured attempt, whether its values may turn out not to be known.
        cut: the instant from which on that is so.
        begun: of an instance, the position from which on it saw what is its own.
    """

    STATE = (
        *Nodes.STATE,
        *Schedule.STATE,
        *("clerk", "opens_at", "waiting", "blurs", "cut", "begun"),
    )

    graph: Graph
    """The formulas."""
    TAKE: Mapping[str, Callable[[Evaluator, int, Reported], int]]
    """By name, what takes a value; returns the nodes that may change with it."""
    SPARSE: int
    """The nodes that have to see every sample where samples are far apart."""
    SPAN: int
    """So far apart samples can be without leaving a hole in a stretch of time."""

    def __init__(
        self,
        outages: Outages,
        captured: Mapping[str, Scalar],
        made_for: CompiledRequirement | None = None,
    ) -> None:
        super().__init__(outages.absent)
        self.clear()
        self.captured = captured
        self.made_for = made_for
        self.opens_at = -TIME_LIMIT
        self.watched: list[WatchedAttempt] = []
        self.clerk: Outages = outages
        self.blurs = True
        self.cut = NEVER
        self.begun: int | None = None
        self.waiting: list[tuple[int, Mapping[str, Reported]]] = []
        self.drive((), ())

    def drive(self, rules: Sequence[Rule], starters: Sequence[Rule]) -> None:
        """Have rules driven.

        Args:
            rules: in the order of the file.
            starters: of these, those of which attempts start in it.
        """
        self.set_up(rules)
        judges = [rule for rule in rules if isinstance(rule, AttemptJudge)]
        self.judges: Sequence[AttemptJudge] = judges
        self.starters = starters
        # What no rule asks for has a bit, too: of all nodes it is kept since when they are so.
        letters = [1 << len(rules)] * self.NODES
        triggers = [0] * self.NODES
        for index, rule in enumerate(rules):
            rule.index = index
            if rule.trigger >= 0:
                triggers[rule.trigger] |= 1 << index
            if rule.again >= 0:
                triggers[rule.again] |= 1 << index + len(rules)
        for judge in self.judges:
            for place in judge.places:
                letters[place] |= 1 << judge.index
        self.LETTERS, self.TRIGGERS = tuple(letters), tuple(triggers)
        for rule in rules:
            self.note(rule)

    # What judges are given.

    @property
    def values(self) -> list[int]:
        """See `Standing`."""
        return self.v

    @property
    def gap(self) -> int | None:
        """See `Standing`."""
        return self.GAP

    @property
    def outages(self) -> Mapping[str, Outage]:
        """See `Standing`."""
        return self.clerk.now

    @property
    def is_cut(self) -> bool:
        """See `Standing`."""
        return self.cut < NEVER

    def last_with(self, place: int, value: int, t: int) -> int | None:
        """See `Standing`."""
        return t if self.v[place] == value else self.until[3 * place + value]

    # What expressions read; see `rvmon.runtime.expressions.Input`.

    def value_of(self, signal: str) -> Scalar:
        """The value of a signal as seen now; `None` if unknown."""
        found: Scalar = self.s[self.SIGNALS.index(signal)]
        return found

    def history_of(self, signal: str) -> History:
        """The last two updates of a signal."""
        found = self.h[self.SIGNALS.index(signal)]
        if found is None:
            raise AssertionError("the evaluator was generated without it")
        return found

    def payloads_of(self, event: str) -> Sequence[Payload | None]:
        """What occurs of an event at the position; `None` is unknown."""
        return (None,) if event in self.absent else self.p[self.EVENTS.index(event)]

    # Making further evaluators.

    def twin(self, made: Evaluator, varying: Iterable[int], own: Iterable[int]) -> None:
        """Have an evaluator of the same class, with other captured values, go on as this one will.

        Args:
            made: has seen nothing.
            varying: the nodes that depend on captured values; none of them remembers anything.
            own: the nodes of which nothing is reported that was before.
        """
        take_all(made, self)
        made.begun = self.position
        made.waiting, made.awaited = list(self.waiting), self.awaited
        if self.origin is not None:
            made.evaluate(self.position, _bits(varying))
            for place in own:
                made.since[place] = self.position

    def fork(self, made: Evaluator, own: Graph) -> None:
        """Have an evaluator of other formulas begin at this position, of which it sees what occurs.

        Args:
            made: it remembers nothing but by nodes of `own`.
            own: of the formulas of this one, those of its requirement.
        """
        take_inputs(made, self)
        if self.origin is None:
            return
        index = self.graph.index
        shared = [(n, index[one]) for n, one in enumerate(made.graph.nodes) if one in own.index]
        take_nodes(made, self, shared)
        # Momentary ones are seen to be over at the next position.
        dirty = made.KEPT & (made.momentary | ~_bits(place for place, _ in shared))
        _, _, made.fading = made.evaluate(self.position, dirty)

    def stands_like(self, other: Evaluator, varying: Container[int]) -> bool:
        """Whether an evaluator of the same class, at this instant too, goes on as this one will.

        Args:
            other: that evaluator.
            varying: the nodes that depend on captured values.
        """
        pairs = zip(self.v, other.v, strict=True)
        if any(one != its and place not in varying for place, (one, its) in enumerate(pairs)):
            return False
        stateful = self.graph.stateful
        return all(remembered(self, place) == remembered(other, place) for place in stateful)

    def lapsed_(self, place: int, t: int) -> int:
        """Whether it is not known any more which values were captured."""
        self.set_wake(place, self.cut if t < self.cut else NEVER)
        return FALSE if t < self.cut else TRUE

    def cut_at(self, t: int) -> None:
        """Let it be unknown which values were captured, from the position `t` or one to come."""
        self.cut = t
        places = [n for n, one in enumerate(self.graph.nodes) if isinstance(one.leaf, Lapsed)]
        for place in places:
            self.set_wake(place, t)
        if self.position == t:
            self.evaluate(t, _bits(places))

    # Time.

    def is_determined(self, compiled: CompiledRequirement) -> bool:
        """Whether the trigger of a requirement was ever true or false."""
        determined = compiled.obligation.determined
        return self.origin is not None and (
            determined is None or self.v[self.graph.index[determined]] == TRUE
        )

    @property
    def is_idle(self) -> bool:
        """Whether nothing is open in it and nothing will start, as in that of a decided attempt."""
        judged = bool(self.judges) and not any(judge.attempts for judge in self.judges)
        return judged and not self.starters and not any(judge.running for judge in self.judges)

    @property
    def is_quiet(self) -> bool:
        """Whether nothing is open in it, waits, or starts before something changes."""
        return not (
            self.waiting
            or self.watched
            or self.repeating
            or any(judge.attempts for judge in self.judges)
            or any(rule.running for rule in self.starters)
        )

    @property
    def alarm(self) -> int:
        """An instant before which nothing happens in it, no sample being taken."""
        return min(self.next_position(), self.next_due())

    def next_position(self) -> int:
        """See `Schedule`; where events are captured, they are others behind this position."""
        gap = self.GAP
        if gap is None:
            return self.awaited
        found = min(self.awaited, self.next_change(), self.resume_at)
        if self.watched and any(self.p):
            found = min(found, self.position + gap)
        if self.repeating:
            found = min(found, max(self.position + gap, -(-self.opens_at // gap) * gap))
        return found

    @property
    def next_decision(self) -> int:
        """The next instant at which time alone can decide an attempt or start one."""
        due = min((judge.next_due for judge in self.judges), default=NEVER)
        # What changes at an instant is known when that instant has passed.
        return min(due, self.next_position() + 1)

    def sample(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take a sample; time has come to `t − 1` before."""
        gap = self.GAP or 1
        self.waiting.append((t, values))
        self.awaited = -(-t // gap) * gap
        if self.awaited == t:
            self.visit(t)
            return
        # It is taken at a position to come, of which there may be none.
        for signal, name in enumerate(self.SIGNALS):
            if name in values:
                if self.first[signal] is None:
                    self.first[signal] = t
                if values[name] is not None and values[name] == values[name]:
                    self.clerk.found(name, t)
        self.reach(t)

    def visit(self, t: int) -> None:
        """See `Schedule`."""
        every = 0
        if self.gathered:
            super().leave()
        for taken, values in self.waiting:
            for name, value in values.items():
                take = self.TAKE.get(name)
                if take is not None:
                    self.dirty |= take(self, taken, value)
        self.waiting.clear()
        if self.origin is None:
            every = (1 << len(self.rules)) - 1
            self.enter(t)
        before = self.before = self.position if self.GAP is None else t - self.GAP
        dirty = self.dirty | self.fading | self.ring(t)
        if t - before > self.SPAN:
            dirty |= self.SPARSE
        letters, triggers, self.fading = self.evaluate(t, dirty)
        if every:
            self.until[:] = [None] * len(self.until)
        self.dirty = 0
        self.position = t
        # What looks back sees every position, whether attempts start or not.
        self.conclude(t, letters | every, 0 if self.opens_at == NEVER else triggers | every)
        self.watched = [one for one in self.watched if one.keeps(t)]

    def leave(self) -> None:
        """See `Schedule`; what occurred is seen until the next position by who captures."""

    def open(self, t: int) -> None:
        """Let attempts start from `t` on, as if none had run before."""
        self.opens_at = t
        for rule in self.starters:
            if rule.trigger >= 0:
                if self.origin is not None:
                    rule.before = self.v[rule.trigger]
                rule.running = False
                if rule.repeats:
                    self.repeating |= 1 << rule.index

    def stand_at_last(self, end: int) -> int:
        """Go to the last position at or before `end`, up to which time has come; returns it."""
        if self.GAP is not None:
            last = self.position + (end - self.position) // self.GAP * self.GAP
            if last > self.position:
                # Nothing that anyone waited for changes, but what occurred before is over.
                if self.gathered:
                    super().leave()
                self.before = last - self.GAP
                self.evaluate(last, self.fading)
                self.position = last
        return self.position


def _bits(places: Iterable[int]) -> int:
    return sum(1 << place for place in places)
