"""A flow with the judges that read it, driven through time.

All requirements without captured values share one lane. Each instance of a `for each`, and each
attempt of a requirement with `let`, has a lane of its own, because its propositions are its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.inputs import Reported
from rvmon.formula.state import TRUE
from rvmon.monitor.attempts.attempt_judge import AttemptJudge
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.runtime.rule import Rule
from rvmon.runtime.schedule import Schedule
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TIME_LIMIT


class WatchedAttempt(Protocol):
    """A captured attempt as the lane sees it in which it was triggered."""

    def keeps(self, t: int) -> bool:
        """Look at the position `t`: whether to look at the next as well."""


class Lane(Schedule):
    """One flow and the requirements that read it; a sample costs what it concerns.

    Attributes:
        flow: evaluates the propositions of its judges.
        judges: of its rules, those that have attempts, in the order of the file.
        starters: of its rules, those of which attempts start in it; where attempts have lanes of
            their own, what makes them.
        since: nothing starts in it before this instant; `NEVER`: nothing does.
        waiting: samples whose position has not come yet.
        made_for: the requirement of an instance or of a captured attempt, with its values.
        captured: the lanes of captured attempts that were triggered in this one.
        blurs: of such a lane, whether its values may turn out not to be known.
    """

    STATE = ("flow", *Schedule.STATE, "since", "waiting", "blurs")

    gathered = False

    def __init__(
        self, flow: Flow, made_for: tuple[CompiledRequirement, Mapping[str, Scalar]] | None = None
    ) -> None:
        self.flow = flow
        self.GAP = flow.gap
        self.position = flow.position
        self.made_for = made_for
        self.judges: list[AttemptJudge] = []
        self.starters: list[Rule] = []
        self.since = -TIME_LIMIT
        self.captured: list[WatchedAttempt] = []
        self.blurs = True
        self.waiting: list[tuple[int, Mapping[str, Reported]]] = []
        self._concern = [(0, 0, 0) for _ in flow.graph.nodes]
        """Per node the rules whose letter it is part of, that it triggers, and that go on with it
        after a failure."""
        self._expected: list[CompiledRequirement] = []
        self.set_up(())

    def add_judge(self, judge: AttemptJudge) -> None:
        """Have a requirement's attempts driven."""
        self.judges.append(judge)
        self._add(judge)
        bit = 1 << judge.index
        for place in judge.places:
            self._note_concern(place, bit, 0, 0)
        if judge.again >= 0:
            self._note_concern(judge.again, 0, 0, bit)

    def add_starter(self, rule: Rule) -> None:
        """Have a requirement's attempts started."""
        self.starters.append(rule)
        if rule not in self.judges:
            self._add(rule)

    def _add(self, rule: Rule) -> None:
        rule.index = len(self.rules)
        self.rules.append(rule)
        self.due_at.append(NEVER)
        if rule.trigger >= 0:
            self._note_concern(rule.trigger, 0, 1 << rule.index, 0)
        self.note(rule)

    def _note_concern(self, place: int, letters: int, triggers: int, again: int) -> None:
        old = self._concern[place]
        self._concern[place] = (old[0] | letters, old[1] | triggers, old[2] | again)

    def expect(self, compiled: CompiledRequirement) -> None:
        """Have it seen whether the trigger of a requirement is ever true or false."""
        self._expected.append(compiled)

    @property
    def determined(self) -> Iterable[str]:
        """The requirements of which it was."""
        values, index = self.flow.values, self.flow.graph.index
        for compiled in self._expected if self.flow.origin is not None else ():
            determined = compiled.obligation.determined
            if determined is None or values[index[determined]] == TRUE:
                yield compiled.requirement.id

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
            or self.captured
            or self.repeating
            or any(judge.attempts for judge in self.judges)
            or any(rule.running for rule in self.starters)
        )

    @property
    def alarm(self) -> int:
        """An instant before which nothing happens in it, no sample being taken."""
        return min(self.next_position(), self.next_due())

    def twin(self, flow: Flow, captured: Mapping[str, Scalar]) -> Lane:
        """A lane for the same requirement that waits for what this one does.

        Args:
            flow: its own.
            captured: its values.
        """
        made = Lane(flow, self.made_for and (self.made_for[0], captured))
        made.waiting, made.awaited = list(self.waiting), self.awaited
        return made

    def next_change(self) -> int:
        """See `Schedule`."""
        return self.flow.next_change

    def next_position(self) -> int:
        """See `Schedule`; where events are captured, they are others behind this position."""
        gap = self.GAP
        if gap is None:
            return self.awaited
        found = min(self.awaited, self.flow.next_change, self.resume_at)
        if self.captured and self.flow.inputs.occurrences:
            found = min(found, self.position + gap)
        if self.repeating:
            found = min(found, max(self.position + gap, -(-self.since // gap) * gap))
        return found

    def sample(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take a sample; time has come to `t − 1` before."""
        gap = self.GAP or 1
        self.flow.inputs.hear(t, values)
        self.waiting.append((t, values))
        self.awaited = -(-t // gap) * gap
        if self.awaited == t:
            self.visit(t)
        else:
            self.reach(t)

    def visit(self, t: int) -> None:
        """See `Schedule`."""
        every = 0 if self.flow.origin is not None else (1 << len(self.rules)) - 1
        for taken, values in self.waiting:
            self.flow.apply(taken, values)
        self.waiting.clear()
        changed = self.flow.evaluate(t)
        self.position = t
        letters = triggers = every
        again = 0
        for place in changed:
            own = self._concern[place]
            letters |= own[0]
            triggers |= own[1]
            again |= own[2]
        if self.since == NEVER:
            triggers = again = 0
        self.conclude(t, letters, again << len(self.rules) | triggers)
        self.captured = [one for one in self.captured if one.keeps(t)]

    def open(self, t: int) -> None:
        """Let attempts start from `t` on, as if none had run before."""
        self.since = t
        for rule in self.starters:
            if rule.trigger >= 0:
                if self.flow.origin is not None:
                    rule.before = self.flow.values[rule.trigger]
                rule.running = False
                if rule.repeats:
                    self.repeating |= 1 << rule.index

    def stand_at_last(self, end: int) -> int:
        """Go to the last position at or before `end`, up to which time has come; returns it."""
        flow = self.flow
        if flow.gap is not None:
            last = flow.position + (end - flow.position) // flow.gap * flow.gap
            if last > flow.position:
                # Nothing that anyone waited for changes, but what occurred before is over.
                flow.evaluate(last)
        return flow.position

    @property
    def next_decision(self) -> int:
        """The next instant at which time alone can decide an attempt or start one."""
        due = min((judge.next_due for judge in self.judges), default=NEVER)
        # What changes at an instant is known when that instant has passed.
        return min(due, self.next_position() + 1)
