"""Open attempts of which only the instant of the trigger matters: moved in runs, not one by one."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from typing import TYPE_CHECKING, Any

from rvmon.runtime.rule import Rule
from rvmon.runtime.values import NEVER, PASSED, UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rvmon.runtime.table import Token


NOWHERE = -1
"""The target where no run comes at its next step."""

FROM_TRIGGER = (NEVER,)
"""The anchors of attempts whose clock has run since their triggers, the same to all of them."""


class Run:
    """Attempts in one location, in order of their triggers; 20 bytes each.

    Attributes:
        head: how many of the oldest are gone.
        triggers: the instants of the triggers.
        numbers: of the attempts.
        seen: what was seen at the trigger, as the clerk put it.
    """

    __slots__ = ("head", "numbers", "seen", "triggers")

    STATE = __slots__

    def __init__(self) -> None:
        self.head = 0
        self.triggers = array("q")
        self.numbers = array("q")
        self.seen = array("i")

    def append(self, triggered: int, number: int, seen: int) -> None:
        """Add the youngest."""
        size = len(self.triggers)
        try:
            self.triggers.append(triggered)
            self.numbers.append(number)
            self.seen.append(seen)
        except BaseException:  # an interrupt in between
            del self.triggers[size:], self.numbers[size:], self.seen[size:]
            raise

    def older(self, t: int) -> int:
        """The place of the first that was triggered after `t`."""
        return bisect_right(self.triggers, t, self.head)

    def copy(self, start: int, stop: int) -> Run:
        """Some of them."""
        made = Run()
        made.triggers = self.triggers[start:stop]
        made.numbers = self.numbers[start:stop]
        made.seen = self.seen[start:stop]
        return made

    def add(self, later: Run) -> None:
        """Append attempts that were triggered later."""
        self.triggers += later.triggers[later.head :]
        self.numbers += later.numbers[later.head :]
        self.seen += later.seen[later.head :]

    def drop(self, start: int, stop: int) -> None:
        """Leave some out; the oldest are passed over, and given back when they are the most."""
        if start == self.head:
            self.head = stop
            if stop < 64 or 2 * stop < len(self.triggers):
                return
            start = self.head = 0
        del self.triggers[start:stop]
        del self.numbers[start:stop]
        del self.seen[start:stop]


class BulkRule(Rule):
    """A rule whose automaton has one clock at most, which is started at the trigger.

    Attempts in one location are alike but for their age: those of one region take the same edge.
    So a position costs as much as there are locations and regions, however many attempts are open.
    The builder has proved as well that runs which meet in a location stand one behind the other.
    As soon as something unknown matters, attempts are driven one by one.

    Source: AUTOMATA 3.
    """

    __slots__ = ()

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        if self.position < t:
            self.visit(t)
        machine = self.machine
        kind = machine.class_of[self.letter]
        if kind != machine.class_of[self.other] or not self.is_plain:
            self.begin_alone(t, triggered)
            return
        location, _ = machine.start
        number, seen = self.clerk.entered(self)
        self.enter(triggered, plain=True)
        target, _ = machine.rows[machine.bases[location]][kind]
        if target <= PASSED:
            self._decide_in_run(number, triggered, seen, target == PASSED, t, machine.start)
            return
        run = self.runs.get(target)
        if run is None:
            run = self.runs[target] = Run()
        run.append(triggered, number, packed(seen))
        due = t + 1
        onward = machine.rows[machine.bases[target]][kind]
        if onward is not None and onward[0] == target:
            cuts = machine.cuts_of[target]
            due = triggered + cuts[0][0] if cuts else NEVER
        else:
            self.restless = True
        if self.due > due:
            self.due = due

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, at which the values are."""
        if not self.runs:
            Rule.visit(self, t)
            return
        if self.due < t:
            self.pass_to(t - 1)
        kinds = self.machine.class_of
        worse, better = self.letters(self.values)
        if kinds[worse] != kinds[better]:
            self.loosen()
        if self.attempts:
            Rule.visit(self, t)
            if not self.runs:
                return
        else:
            self.letter, self.other = worse, better
            self.restless = False
            self.position = t
            self.due = NEVER
        if self.step_runs(t):
            self.restless = True
            self.due = t + 1
        elif self.runs:
            self.due = min(self.due, self.next_cut(t))

    def step_runs(self, t: int) -> bool:
        """Step all runs at the position `t`; returns whether the same letter would lead on."""
        parts = self._moving(t)
        if not parts:
            return False
        if len(self.runs) > 1:
            parts.sort(key=_first_trigger)
        self._move(parts, t)
        return bool(self._moving(t))

    def _moving(self, t: int) -> list[Any]:
        """All runs in parts of one region with their targets; empty if they stay as they are."""
        machine = self.machine
        kind = machine.class_of[self.letter]
        parts = []
        stays = True
        for location, run in self.runs.items():
            base = machine.bases[location]
            start, stop = run.head, len(run.triggers)
            if machine.cuts_of[location]:
                cuts = machine.cuts_of[location][0]
                stride = machine.strides[location][0]
                for region in range(len(cuts), 0, -1):
                    end = run.older(t - cuts[region - 1])
                    if end > start:
                        edge = machine.rows[base + region * stride][kind]
                        target = NOWHERE if edge is None else edge[0]
                        parts.append((location, run, start, end, target))
                        stays = stays and target == location
                        start = end
            if stop > start:
                edge = machine.rows[base][kind]
                target = NOWHERE if edge is None else edge[0]
                parts.append((location, run, start, stop, target))
                stays = stays and target == location
        return [] if stays else parts

    def _move(self, parts: Sequence[Any], t: int) -> None:
        """Take parts of runs, oldest first, to their targets."""
        fresh: dict[int, Run] = {}
        for location, run, start, stop, target in parts:
            if target <= PASSED:
                self._decide(location, run, start, stop, target == PASSED, t)
                continue
            if stop == len(run.triggers):
                run.drop(run.head, start)
                part = run
            else:
                part = run.copy(start, stop)
            if target in fresh:
                fresh[target].add(part)
            else:
                fresh[target] = part
        self.runs = fresh

    def _decide(
        self,
        location: int,
        run: Run,
        start: int,
        stop: int,
        verdict: bool,
        t: int | None,
        cut: int = 0,
    ) -> None:
        """Tell of decisions at `t`; without it, at the age `cut` of each."""
        token: Token = (location, FROM_TRIGGER if self.machine.cuts_of[location] else ())
        for index in range(start, stop):
            triggered = run.triggers[index]
            at = triggered + cut if t is None else t
            number, seen = run.numbers[index], run.seen[index]
            self._decide_in_run(number, triggered, seen, verdict, at, token)

    def _decide_in_run(
        self, number: int, triggered: int, seen: Any, verdict: bool, t: int, before: Token
    ) -> None:
        if not verdict:
            self.fail(triggered, t)
        self.clerk.decided_in_run(self, number, triggered, seen, verdict, t, before)

    def next_cut(self, t: int) -> int:
        """The first instant after `t` at which an attempt of a run enters another region."""
        found = NEVER
        machine = self.machine
        for location, run in self.runs.items():
            if machine.cuts_of[location]:
                for cut in machine.cuts_of[location][0]:
                    index = run.older(t - cut)
                    if index < len(run.triggers):
                        found = min(found, run.triggers[index] + cut)
        return found

    def settle_runs(self, position: int, until: int) -> None:
        """Let time pass from `position` to `until` without a position."""
        machine = self.machine
        for location, run in self.runs.items():
            if not machine.cuts_of[location]:
                continue
            base, stride = machine.bases[location], machine.strides[location][0]
            for region, cut in enumerate(machine.cuts_of[location][0], start=1):
                truth = machine.time_values[base + region * stride]
                if truth != UNKNOWN:
                    start, stop = run.older(position - cut), run.older(until - cut)
                    if start < stop:
                        self._decide(location, run, start, stop, bool(truth), None, cut)
                        run.drop(start, stop)
        self.runs = {at: run for at, run in self.runs.items() if run.head < len(run.triggers)}

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        position, due = self.position, self.due
        Rule.pass_to(self, t)
        if not self.runs:
            return
        gap = self.gap
        if gap is None:
            self.restless = self.restless or due <= t
            self.settle_runs(position, t)
            self.due = min(self.due, self.next_cut(max(t, position)))
        elif t > position:
            self.due = min(self.due, self._run_on(position, t, gap))
            self.position = position + (t - position) // gap * gap
            self.restless = False
        else:
            self.due = min(self.due, due)

    def _run_on(self, position: int, last: int, gap: int) -> int:
        """Step runs through equal letters behind `position`; returns when they are due."""
        while True:
            following = position + gap
            if gap > 1:
                self.settle_runs(position, min(following - 1, last))
            if following > last or not self.runs:
                return min(following, self.next_cut(last)) if self.runs else NEVER
            # Records of decisions show from where time alone has gone on.
            position = self.position = following
            if not self.step_runs(position):
                cut = self.next_cut(position)
                ahead = min(cut - 1 - position, last - position) // gap * gap
                position += max(ahead, 0)
                if cut > last:
                    return cut

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        Rule.reach(self, t)
        if self.runs:
            self.settle_runs(self.position, t)
            self.due = min(self.due, self.next_cut(t))
            if self.gap is not None and self.runs and self.due > t:
                self.due = t

    def loosen(self) -> None:
        """Drive all attempts one by one from now on."""
        self.attempts = self.undecided()
        self.runs = {}

    def undecided(self) -> list[Any]:
        """The open attempts, oldest first, each as an object of its own."""
        found = list(self.attempts)
        for location, run in self.runs.items():
            clocked = bool(self.machine.cuts_of[location])
            for index in range(run.head, len(run.triggers)):
                triggered = run.triggers[index]
                token: Token = (location, (triggered,) if clocked else ())
                number, seen = run.numbers[index], run.seen[index]
                found.append(self.clerk.reopened(self, number, triggered, token, seen))
        found.sort(key=lambda attempt: attempt.triggered)
        return found


def packed(truths: Sequence[int]) -> int:
    """Truth values as one number.

    >>> unpacked(packed((2, 0, 1)), 3)
    (2, 0, 1)
    """
    number = 0
    for truth in truths:
        number = 3 * number + truth
    return number


def unpacked(number: int, count: int) -> tuple[int, ...]:
    """So many truth values that `packed` made one number of."""
    truths = []
    for _ in range(count):
        number, truth = divmod(number, 3)
        truths.append(truth)
    return tuple(reversed(truths))


def _first_trigger(part: tuple[int, Run, int, int, int]) -> int:
    """The oldest trigger of a part of a run."""
    _, run, start, _, _ = part
    first: int = run.triggers[start]
    return first
