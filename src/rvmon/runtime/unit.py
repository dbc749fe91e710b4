"""The clockwork of generated monitors: what is evaluated at a position, and whom it concerns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rvmon.runtime.nodes import LIMIT, Nodes
from rvmon.runtime.schedule import Schedule

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rvmon.runtime.rule import Rule


class Unit(Nodes, Schedule):
    """A generated monitor without its generated part.

    Args:
        machines: per requirement, what judges its attempts.
        absent: the names without a source.

    Attributes:
        began: the instant of the first sample; `None` before it.
        after: samples have to be later than this instant.
        news: whether something was decided since it was last set to `False`.
        torn: the instant of a sample at which generated code was interrupted; `None`: it was not.
    """

    __slots__ = (
        "active",
        "after",
        "asked",
        "awaited",
        "began",
        "due_at",
        "dues",
        "failing",
        "looking",
        "machines",
        "news",
        "repeating",
        "restless",
        "resume_at",
        "rules",
        "torn",
    )

    STATE = (
        *Nodes.STATE,
        *Schedule.STATE,
        *("began", "after", "news"),
    )

    ABOVE: tuple[int, ...] = ()
    """Per node, a bit for it and each that depends on it; left out where nobody asks."""
    NOTED: tuple[Callable[..., tuple[Any, ...]], ...]
    """Per requirement, where records are kept: what they note, from what was seen at the trigger,
    the instant, the token before it, the rule, `v`, `since` and `until`. One flat tuple costs the
    collector of garbage next to nothing."""
    RULES: tuple[tuple[Any, ...], ...]
    """Per rule its class, what gives its letters, and what else it takes. Rules judge requirements;
    behind these stand those that judge attempts in doubt."""
    DETERMINED: tuple[int, ...] = ()
    """Per requirement the node that is true once its trigger was true or false; −1: always."""

    step: Callable[[int, Mapping[str, Any]], Sequence[Any]]
    """Take one sample; returns what it decided."""
    take: Callable[[int, Mapping[str, Any]], None]
    """Take the updates of a valid sample; time has come to `t` − 1 before."""

    def __init__(self, machines: Sequence[Any], absent: frozenset[str] = frozenset()) -> None:
        super().__init__(absent)
        self.machines = machines

    def restart(self, clerk: Any, clerks: Sequence[Any]) -> None:
        """Begin a run.

        Args:
            clerk: takes samples that need a closer look, and reports decisions.
            clerks: per requirement, who makes attempts and hears of decisions.
        """
        self.clear()
        self.clerk = clerk
        self.began: int | None = None
        self.set_up([self._rule(index, one) for index, one in enumerate(clerks)])
        self.after = -LIMIT
        self.news = False
        self.torn: int | None = None

    def _rule(self, index: int, clerk: Any) -> Rule:
        class_, letters, *kind = self.RULES[index]
        machine = self.machines[index]
        made: Rule = class_(index, machine, letters, *kind, self.GAP, self.v, clerk)
        return made

    # Positions.

    def enter(self, t: int) -> None:
        """See `Nodes`."""
        if self.began is None:
            self.began = t
        super().enter(t)

    def meets(self, t: int, cone: int) -> bool:
        """Have timers ring at `t`; whether what they may change is among some nodes.

        Args:
            t: the next position.
            cone: a bit for each node, with all that depend on one of them.
        """
        due = self.dirty = self.dirty | self.ring(t)
        while due:
            bit = due & -due
            due ^= bit
            if self.ABOVE[bit.bit_length() - 1] & cone:
                return True
        return False

    def conclude_calmly(self, t: int, letters: int, triggers: int) -> None:
        """As `conclude`, where all requirements are episodes that only letters decide."""
        rules = self.rules
        if triggers & self.looking:
            self.look(triggers & self.looking)
        letters &= self.active
        while letters:
            bit = letters & -letters
            letters ^= bit
            rule = rules[bit.bit_length() - 1]
            rule.visit(t)
            if not (rule.runs or rule.attempts):
                self.active ^= bit
            if rule.failed_at is not None:
                self.follow(rule)
        again = triggers >> len(rules)
        triggers &= (1 << len(rules)) - 1
        while triggers:
            bit = triggers & -triggers
            triggers ^= bit
            rule = rules[bit.bit_length() - 1]
            if rule.starts(self.v[rule.trigger]):
                self.begin(rule, t, t)
        if again & self.failing or self.resume_at <= t:
            self.go_on(t, again)
        if self.gathered:
            self.leave()

    def conclude_alone(self, t: int, letters: int, triggers: int) -> None:
        """As `conclude_calmly`, where there is but one requirement."""
        (rule,) = self.rules
        if self.looking and triggers & 1:
            rule.look()
        if letters and self.active:
            rule.visit(t)
            if not (rule.runs or rule.attempts):
                self.active = 0
            if rule.failed_at is not None:
                self.follow(rule)
        if triggers & 1 and rule.starts(self.v[rule.trigger]):
            self.begin(rule, t, t)
        if triggers >> 1 & self.failing or self.resume_at <= t:
            self.go_on(t, triggers >> 1)
        if self.gathered:
            self.leave()

    def set_alarm(self) -> None:
        """Work out before when nothing happens; it may come to nothing at that instant."""
        if self.origin is None:
            return
        wake = min(LIMIT, self.next_timer(), self.awaited, self.resume_at)
        if self.dues:
            wake = min(wake, self.dues[0][0])
        if self.fading or self.repeating or (self.restless and self.GAP is None):
            wake = min(wake, self.position + 1)
        self.wake = wake

    # Time.

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`, positions there included, without a further sample."""
        if limit < self.wake or self.began is None:
            return
        super().through(limit)
        self.set_alarm()

    def sampled(self, t: int) -> None:
        """Go on after the updates of a sample were taken, where not every instant is a position."""
        gap = self.GAP or 1
        if self.began is None:
            self.began = t
        self.awaited = -(-t // gap) * gap
        if self.awaited == t:
            self.visit(t)
        else:
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
        for rule in self.rules:
            if rule.trigger < 0 and self.origin is not None:
                rule.begin(self.last_position(end), end)
        for rule in self.rules:
            rule.reach(reached)

    def is_determined(self, index: int) -> bool:
        """Whether the trigger of a requirement was ever true or false."""
        place = self.DETERMINED[index]
        return self.origin is not None and (place < 0 or self.v[place] == 2)


def closures(parents: Sequence[int]) -> tuple[int, ...]:
    """Per node a bit for it and each that depends on it.

    Args:
        parents: per node a bit for each that depends on it directly; all of them stand behind it.

    >>> closures([0b10, 0b100, 0])
    (7, 6, 4)
    """
    found: list[int] = [0] * len(parents)
    for place in reversed(range(len(parents))):
        above = 1 << place
        rest = parents[place]
        while rest:
            bit = rest & -rest
            rest ^= bit
            above |= found[bit.bit_length() - 1]
        found[place] = above
    return tuple(found)
