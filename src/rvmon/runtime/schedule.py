"""Whom a position or an instant concerns, and when something is due."""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING, Any

from rvmon.runtime.values import NEVER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rvmon.runtime.rule import Rule


class Schedule:
    """Drives rules through positions and the time between them; each is asked when it has to be.

    Attributes:
        rules: what is driven.
        position: that the values are of.
        restless: the rules to be asked at the next position whatever changes.
        repeating: those that start an attempt at the next position if nothing changes.
        asked: of what `triggers` may hold, what somebody asks for.
        looking: the rules that have to see their triggers first.
        failing: those whose episode runs on after a failure.
        resume_at: the next position at which one of them may go on though nothing changes.
        awaited: the next position at which samples that were taken will show.
        active: the rules that have open attempts.
        dues: when rules are due; `due_at` says which entries still hold.

    Sets of rules are numbers, with a bit for the place of each.
    """

    STATE: tuple[str, ...] = (
        *("rules", "position", "restless", "repeating", "asked", "looking", "failing"),
        *("resume_at", "awaited", "dues", "due_at", "active"),
    )

    GAP: int | None
    """Ticks between two positions; `None` if only samples are positions."""
    gathered: bool
    """Whether something that occurred belongs to the position."""
    rules: list[Any]
    position: int
    restless: int
    repeating: int
    asked: int
    looking: int
    failing: int
    resume_at: int
    awaited: int
    dues: list[tuple[int, int]]
    due_at: list[int]
    active: int

    def visit(self, t: int) -> None:
        """Move to the position at `t`."""
        raise NotImplementedError

    def next_change(self) -> int:
        """The first position after this one at which a value can change by time alone."""
        raise NotImplementedError

    def leave(self) -> None:
        """Forget what occurred at the position."""
        raise NotImplementedError

    def set_up(self, rules: Sequence[Rule]) -> None:
        """Begin with rules that have no attempts."""
        self.rules = list(rules)
        self.restless = self.repeating = self.looking = self.failing = self.active = 0
        self.asked = (1 << len(self.rules)) - 1
        self.resume_at = self.awaited = NEVER
        self.dues = []
        self.due_at = [NEVER] * len(self.rules)

    def conclude(self, t: int, letters: int, triggers: int) -> None:
        """Have the position judged by those whom it concerns."""
        self.awaited = NEVER
        if triggers & self.looking:
            self.look(triggers & self.looking)
        letters = (letters | self.restless) & self.active
        dues, due_at = self.dues, self.due_at
        while dues and dues[0][0] <= t:
            due, index = heappop(dues)
            if due_at[index] == due:
                due_at[index] = NEVER
                letters |= 1 << index & self.active
        rules = self.rules
        while letters:
            bit = letters & -letters
            letters ^= bit
            index = bit.bit_length() - 1
            rule = rules[index]
            rule.visit(t)
            if (
                rule.restless
                or self.restless
                or rule.due != due_at[index]
                or not (rule.attempts or rule.runs)
                or rule.failed_at is not None
            ):
                self.note(rule)
        again = triggers >> len(rules)
        triggers = triggers & (1 << len(rules)) - 1 | self.repeating
        while triggers:
            bit = triggers & -triggers
            triggers ^= bit
            index = bit.bit_length() - 1
            rule = rules[index]
            if rule.trigger < 0:
                continue
            if rule.starts(rule.values[rule.trigger]):
                self.begin(rule, t, t)
            if rule.pulse or self.repeating & bit:
                self.repeating = self.repeating | bit if rule.repeats else self.repeating & ~bit
        if again & self.failing or self.resume_at <= t:
            self.go_on(t, again)
        if self.gathered:
            self.leave()

    def begin(self, rule: Rule, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`.

        Args:
            rule: one of these.
            t: ticks.
            triggered: the instant of the trigger, which is another at the end of a trace.
        """
        rule.begin(t, triggered)
        self.note(rule)
        if rule.episodic:
            bit = 1 << rule.index
            self.looking = self.looking | bit if rule.looking else self.looking & ~bit

    def look(self, looking: int) -> None:
        """Have requirements see their triggers before their attempts do."""
        while looking:
            bit = looking & -looking
            looking ^= bit
            self.rules[bit.bit_length() - 1].look()

    def go_on(self, t: int, again: int) -> None:
        """Follow failures by other attempts at the position `t`, where it is time for that.

        Args:
            t: the position.
            again: the requirements for which that may have changed.
        """
        asked = self.failing
        if self.resume_at > t:
            asked &= again
        else:
            self.resume_at = NEVER
        while asked:
            bit = asked & -asked
            asked ^= bit
            rule = self.rules[bit.bit_length() - 1]
            failed_at = rule.failed_at
            if failed_at is None:
                self.follow(rule)
            elif t <= failed_at:
                self.await_next(failed_at)
            elif rule.goes_on:
                self.begin(rule, t, t)

    def follow(self, rule: Rule) -> None:
        """Note whether a requirement's episode runs on after a failure."""
        bit = 1 << rule.index
        if rule.failed_at is None:
            self.failing &= ~bit
            self.asked &= ~(bit << len(self.rules))
            return
        self.failing |= bit
        self.asked |= bit << len(self.rules)
        # Where it fails at once, something has to change first.
        if rule.goes_on:
            self.await_next(rule.failed_at)

    def await_next(self, t: int) -> None:
        """Have the first position behind `t` visited."""
        gap = self.GAP
        following = t + 1
        if gap is not None:
            following = self.position + ((t - self.position) // gap + 1) * gap
        self.resume_at = min(self.resume_at, following)

    def _see_who_resumes(self) -> None:
        """Forget those whose episode is over since their failure."""
        self.resume_at = NEVER
        failing = self.failing
        while failing:
            bit = failing & -failing
            failing ^= bit
            rule = self.rules[bit.bit_length() - 1]
            if rule.failed_at is not None and rule.goes_on:
                self.await_next(rule.failed_at)

    def note(self, rule: Rule) -> None:
        """Note when a requirement is due, and whether it has to be asked at the next position."""
        bit = 1 << rule.index
        if rule.attempts or rule.runs or rule.watches:
            self.active |= bit
        elif self.active & bit:
            self.active ^= bit
        if rule.restless:
            self.restless |= bit
        elif self.restless & bit:
            self.restless ^= bit
        if rule.failed_at is not None:
            self.follow(rule)
        due = rule.due
        if due != self.due_at[rule.index]:
            self.due_at[rule.index] = due
            if due < NEVER:
                heappush(self.dues, (due, rule.index))
                if len(self.dues) > 64 + 8 * len(self.rules):
                    self.dues = [(t, i) for i, t in enumerate(self.due_at) if t < NEVER]
                    heapify(self.dues)

    def next_due(self) -> int:
        """The next instant at which an attempt can be decided."""
        dues = self.dues
        while dues and self.due_at[dues[0][1]] != dues[0][0]:
            heappop(dues)
        return dues[0][0] if dues else NEVER

    def next_position(self) -> int:
        """The next position at which something can change without a further sample."""
        found = min(self.awaited, self.next_change())
        if self.GAP is not None:
            if self.resume_at < NEVER:
                self._see_who_resumes()
                found = min(found, self.resume_at)
            if self.repeating:
                found = min(found, self.position + self.GAP)
        return found

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`, positions there included, without a further sample."""
        while True:
            stop = min(self.next_position() - 1, limit)
            while (due := self.next_due()) <= stop:
                rule = self.rules[self.dues[0][1]]
                # What fails may be followed by another attempt at once.
                reached = due if rule.episodic and not rule.leaps else stop
                rule.pass_to(reached)
                if rule.due <= reached:
                    raise AssertionError("what has passed is due again: no run comes to stand so")
                self.note(rule)
                if self.GAP is not None:
                    stop = min(stop, self.resume_at - 1)
            position = self.next_position()
            if position > limit:
                break
            self.visit(position)

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
