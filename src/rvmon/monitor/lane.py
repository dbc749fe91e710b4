"""A flow with the judges that read it, driven through time.

All requirements without captured values share one lane. Each instance of a `for each`, and each
attempt of a requirement with `let`, has a lane of its own, because its propositions are its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rvmon.automaton.machine import INFINITY
from rvmon.dataflow.flow import Flow
from rvmon.dataflow.inputs import Reported
from rvmon.monitor.judge import Judge
from rvmon.monitor.trigger import Trigger


@dataclass(slots=True)
class Starter:
    """What starts the attempts of one requirement in a lane.

    Attributes:
        trigger: follows the truth of the trigger; `None` if that is the end of the trace.
        place: of the trigger's formula in the flow; −1 if there is none.
        start: starts an attempt; takes the position, which the flow is at, and the instant of the
            trigger (they differ only at the end of a trace).
    """

    trigger: Trigger | None
    place: int
    start: Callable[[int, int], None]

    @property
    def repeats(self) -> bool:
        """Whether it has to be asked at the next position, though nothing changes."""
        return self.trigger is not None and self.trigger.repeats


class Lane:
    """One flow and its seats.

    Attributes:
        flow: evaluates the propositions of its judges.
        judges: of the requirements in it, in the order of the file.
        starters: the same.
        waiting: samples whose position has not come yet.
    """

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.judges: list[Judge] = []
        self.starters: list[Starter] = []
        nodes = flow.graph.nodes
        self._judges_at: list[list[Judge]] = [[] for _ in nodes]
        self._starters_at: list[list[Starter]] = [[] for _ in nodes]
        self.waiting: list[tuple[int, Mapping[str, Reported]]] = []
        self._awaited = INFINITY
        """The next position at which samples that were taken will show."""

    def add_judge(self, judge: Judge) -> None:
        """Have a requirement's attempts driven."""
        self.judges.append(judge)
        for place in judge.places:
            self._judges_at[place].append(judge)

    def add_starter(self, starter: Starter) -> None:
        """Have a requirement's attempts started."""
        self.starters.append(starter)
        if starter.trigger is not None:
            self._starters_at[starter.place].append(starter)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`, positions there included, without a further sample."""
        while True:
            position = min(self._awaited, self.flow.next_change, self._next_repeat())
            self._run_due(min(position - 1, limit))
            if position > limit:
                return
            self._visit(position)

    def _next_repeat(self) -> int:
        gap = self.flow.gap
        if gap is not None and any(starter.repeats for starter in self.starters):
            return self.flow.position + gap
        return INFINITY

    def _run_due(self, limit: int) -> None:
        for judge in self.judges:
            if judge.due <= limit:
                judge.pass_to(limit)

    def sample(self, t: int, values: Mapping[str, Reported]) -> None:
        """Take a sample; time has come to `t − 1` before."""
        gap = self.flow.gap or 1
        self.waiting.append((t, values))
        self._awaited = -(-t // gap) * gap
        if self._awaited == t:
            self._visit(t)
        else:
            self.reach(t)

    def _visit(self, t: int) -> None:
        first = self.flow.origin is None
        self._awaited = INFINITY
        for taken, values in self.waiting:
            self.flow.apply(taken, values)
        self.waiting.clear()
        changed = self.flow.evaluate(t)
        letters = {judge for place in changed for judge in self._judges_at[place]}
        for judge in self.judges:
            if first or judge in letters or judge.due <= t or judge.restless:
                judge.visit(t)
        triggers = {id(starter) for place in changed for starter in self._starters_at[place]}
        for starter in self.starters:
            if starter.trigger is None:
                continue
            asked = first or id(starter) in triggers or starter.repeats
            if asked and starter.trigger.starts(self.flow.values[starter.place]):
                starter.start(t, t)

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, from `t − 1`."""
        for judge in self.judges:
            if judge.due <= t:
                judge.reach(t)

    def last_position(self, end: int) -> int:
        """The last position at or before `end`, up to which time has come."""
        flow = self.flow
        if flow.gap is None:
            return flow.position
        return flow.position + (end - flow.position) // flow.gap * flow.gap

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt or start one."""
        due = min((judge.due for judge in self.judges), default=INFINITY)
        return min(due, self.flow.next_change, self._awaited, self._next_repeat())
