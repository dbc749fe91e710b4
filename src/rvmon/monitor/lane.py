"""A flow with the judges that read it, driven through time.

All requirements without captured values share one lane. Each instance of a `for each`, and each
attempt of a requirement with `let`, has a lane of its own, because its propositions are its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.inputs import Reported
from rvmon.formula.state import TRUE
from rvmon.monitor.attempt_judge import AttemptJudge
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.runtime.rule import Rule
from rvmon.runtime.table import NEVER
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TIME_LIMIT


class Captive(Protocol):
    """A captured attempt as the lane sees it in which it was triggered."""

    def keeps(self, t: int) -> bool:
        """Look at the position `t`: whether to look at the next as well."""


class Lane:
    """One flow and the requirements that read it; a sample costs what it concerns.

    Attributes:
        flow: evaluates the propositions of its judges.
        judges: of the requirements in it, in the order of the file.
        starters: the same, those of which attempts start in it; where attempts have lanes of their
            own, what makes them.
        since: nothing starts in it before this instant; `NEVER`: nothing does.
        waiting: samples whose position has not come yet.
        made_for: the requirement of an instance or of a captured attempt, with its values.
        captured: the lanes of captured attempts that were triggered in this one.
        blurs: of such a lane, whether its values may turn out not to be known.
    """

    STATE = (
        *("flow", "judges", "starters", "since", "waiting", "_restless", "_repeating", "_failed"),
        *("blurs", "_soonest", "_awaited"),
    )

    def __init__(
        self, flow: Flow, made_for: tuple[CompiledRequirement, Mapping[str, Scalar]] | None = None
    ) -> None:
        self.flow = flow
        self.made_for = made_for
        self.judges: list[AttemptJudge] = []
        self.starters: list[Rule] = []
        self.since = -TIME_LIMIT
        self.captured: list[Captive] = []
        self.blurs = True
        self.waiting: list[tuple[int, Mapping[str, Reported]]] = []
        nodes = flow.graph.nodes
        self._judges_at: list[list[AttemptJudge]] = [[] for _ in nodes]
        self._asking_at: list[list[Rule]] = [[] for _ in nodes]
        self._going_on: list[list[AttemptJudge]] = [[] for _ in nodes]
        self._resumes = False
        """Whether a failure may be followed by another attempt."""
        self._expected: list[CompiledRequirement] = []
        self._failed: dict[Rule, None] = {}
        self._restless: dict[Rule, None] = {}
        self._repeating: dict[Rule, None] = {}
        self._soonest = NEVER
        """No judge is due before."""
        self._awaited = NEVER
        """The next position at which samples that were taken will show."""

    def add_judge(self, judge: AttemptJudge) -> None:
        """Have a requirement's attempts driven."""
        self.judges.append(judge)
        for place in judge.places:
            self._judges_at[place].append(judge)
        if judge.again >= 0:
            self._resumes = True
            self._going_on[judge.again].append(judge)
        self._note(judge)
        self._have_asked(judge)

    def add_starter(self, rule: Rule) -> None:
        """Have a requirement's attempts started."""
        self.starters.append(rule)
        self._have_asked(rule)

    def _have_asked(self, rule: Rule) -> None:
        if rule.trigger >= 0 and rule not in self._asking_at[rule.trigger]:
            self._asking_at[rule.trigger].append(rule)

    def expect(self, compiled: CompiledRequirement) -> None:
        """Have it seen whether the trigger of a requirement is ever true or false."""
        self._expected.append(compiled)

    @property
    def told(self) -> Iterable[str]:
        """The requirements of which it was."""
        values, index = self.flow.values, self.flow.graph.index
        for compiled in self._expected if self.flow.origin is not None else ():
            told = compiled.obligation.told
            if told is None or values[index[told]] == TRUE:
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
            or self._failed
            or self._repeating
            or any(judge.attempts for judge in self.judges)
            or any(rule.running for rule in self.starters)
        )

    @property
    def alarm(self) -> int:
        """An instant before which nothing happens in it, no sample being taken."""
        return min(self._awaited, self.flow.next_change, self._next_start, self._soonest)

    def twin(self, flow: Flow, captured: Mapping[str, Scalar]) -> Lane:
        """A lane for the same requirement that waits for what this one does.

        Args:
            flow: its own.
            captured: its values.
        """
        made = Lane(flow, self.made_for and (self.made_for[0], captured))
        made.waiting, made._awaited = list(self.waiting), self._awaited
        return made

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`, positions there included, without a further sample."""
        while True:
            position = min(self._awaited, self.flow.next_change, self._next_start)
            until = min(position - 1, limit)
            # What fails may be followed by another attempt at once.
            stop = min(until, self._soonest) if self._resumes else until
            self._pass_to(stop)
            starts = self._next_start < position
            if stop < until and self._soonest <= stop and not starts:
                raise AssertionError("what has passed is due again: no run comes to stand so")
            if stop < until or starts:
                continue
            if position > limit:
                return
            self._visit(position)

    @property
    def _next_start(self) -> int:
        """The next position at which an attempt may start though nothing changes."""
        gap, found = self.flow.gap, NEVER
        if gap is None:
            return found
        if self.captured and self.flow.inputs.occurrences:
            found = self.flow.position + gap  # there, what was captured of them is another
        if self._repeating:
            found = min(found, max(self.flow.position + gap, -(-self.since // gap) * gap))
        for rule in self._failed:
            late = (rule.failed_at or 0) - self.flow.position
            found = min(found, self.flow.position + max(late // gap + 1, 1) * gap)
        return found

    def _pass_to(self, t: int) -> None:
        if self._soonest > t:
            return
        for judge in self.judges:
            if judge.due <= t:
                judge.pass_to(t)
        self._look_over()

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, from `t − 1`."""
        if self._soonest > t:
            return
        for judge in self.judges:
            if judge.due <= t:
                judge.reach(t)
        self._look_over()

    def _look_over(self) -> None:
        soonest = NEVER
        for judge in self.judges:  # there may be thousands, most of which nothing happened to
            if judge.due < soonest:
                soonest = judge.due
            if judge.restless:
                self._restless[judge] = None
        self._soonest = soonest

    def _note(self, judge: Rule) -> None:
        """Remember when a judge has to be seen to, after something was done to it."""
        self._soonest = min(self._soonest, judge.due)
        if judge.restless:
            self._restless[judge] = None
        # Where it fails at once, something has to change first.
        if judge.failed_at is not None and judge.goes_on:
            self._failed[judge] = None

    def sample(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take a sample; time has come to `t − 1` before."""
        gap = self.flow.gap or 1
        self.flow.inputs.hear(t, values)
        self.waiting.append((t, values))
        self._awaited = -(-t // gap) * gap
        if self._awaited == t:
            self._visit(t)
        else:
            self.reach(t)

    def _visit(self, t: int) -> None:
        first = self.flow.origin is None
        self._awaited = NEVER
        for taken, values in self.waiting:
            self.flow.apply(taken, values)
        self.waiting.clear()
        changed = self.flow.evaluate(t)
        for place in changed:
            for rule in self._asking_at[place]:
                if rule.eyed:
                    rule.look()
        for judge in self.judges if first else self._concerned(changed, t):
            judge.visit(t)
            self._note(judge)
        asked = dict(self._repeating)
        if first:
            asked = dict.fromkeys(self.starters)
        for place in changed:
            asked.update(dict.fromkeys(self._asking_at[place]))
        for rule in asked:
            self._ask(rule, t)
        failed, self._failed = self._failed, {}
        for place in changed:
            failed.update(dict.fromkeys(self._going_on[place]))
        for rule in failed:
            self._go_on(rule, t)
        self.captured = [one for one in self.captured if one.keeps(t)]

    def _go_on(self, rule: Rule, t: int) -> None:
        """Follow a failure by another attempt at the position `t`, if it is time for that."""
        if rule.failed_at is None:
            return
        if t <= rule.failed_at:
            self._failed[rule] = None
        elif rule.goes_on:
            self.begin(rule, t, t)

    def begin(self, rule: Rule, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, which the flow is at.

        Args:
            rule: of this lane.
            t: ticks.
            triggered: the instant of the trigger, which is another at the end of a trace.
        """
        rule.begin(t, triggered)
        self._note(rule)

    def _concerned(self, changed: Sequence[int], t: int) -> Iterable[Rule]:
        """The judges that have to visit the position at `t`."""
        concerned = self._restless
        self._restless = {}
        for place in changed:
            for judge in self._judges_at[place]:
                concerned[judge] = None
        if self._soonest <= t:
            concerned.update((judge, None) for judge in self.judges if judge.due <= t)
        return concerned

    def _ask(self, rule: Rule, t: int) -> None:
        """Let a rule see its trigger at the position `t`."""
        if rule.trigger < 0:
            return
        if self.since == NEVER:
            if rule.running:
                rule.starts(self.flow.values[rule.trigger])  # what was captured ends with that
            return
        if rule.starts(self.flow.values[rule.trigger]):
            self.begin(rule, t, t)
        if rule.repeats:
            self._repeating[rule] = None
        else:
            self._repeating.pop(rule, None)

    def open(self, t: int) -> None:
        """Let attempts start from `t` on, as if none had run before."""
        self.since = t
        for rule in self.starters:
            if rule.trigger >= 0:
                if self.flow.origin is not None:
                    rule.before = self.flow.values[rule.trigger]
                rule.running = False
                if rule.repeats:
                    self._repeating[rule] = None

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
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt or start one."""
        due = min((judge.next_due for judge in self.judges), default=NEVER)
        # What changes at an instant is known when that instant has passed.
        return min(due, self.flow.next_change + 1, self._awaited + 1, self._next_start + 1)
