"""Episodes that only a letter can decide: at most one is open, and it has no clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rvmon.runtime.rule import Rule
from rvmon.runtime.values import PASSED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rvmon.runtime.table import Table, Token


def only_location(
    initial: int,
    cuts: Sequence[tuple[tuple[int, ...], ...]],
    bases: Sequence[int],
    rows: Sequence[Sequence[Any]],
) -> int | None:
    """The location in which all attempts wait, if there is but one and only letters move them.

    They have no clock there, and every letter decides them or leaves them as they are.

    Args:
        initial: as for `Table`; so are the others.
        cuts: per location and clock.
        bases: per location.
        rows: per row and class.
    """
    found = [place for place in range(PASSED + 1, len(bases)) if place != initial]
    place = found[0] if found else initial
    if len(found) > 1 or cuts[initial] or cuts[place]:
        return None
    for row in (rows[bases[initial]], rows[bases[place]]):
        if any(edge is None or (edge[0] > PASSED and edge[0] != place) for edge in row):
            return None
    return place


class SoloRule(Rule):
    """A rule of episodes whose automaton has one location only, without a clock.

    `runs` holds the open attempt under that location: the instant of its trigger, its number, what
    was seen there. What more there may be, and all as soon as something unknown matters, is driven
    as that of every rule.
    """

    __slots__ = ("firsts", "place", "targets")

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        machine: Table = self.machine
        start, _ = machine.start
        self.place = only_location(start, machine.cuts_of, machine.bases, machine.rows) or 0
        self.firsts = self._targets(start)
        """By letter, where an attempt starts."""
        self.targets = self._targets(self.place)
        """By letter, where one goes that waits."""

    def _targets(self, location: int) -> list[int]:
        machine = self.machine
        edges = machine.rows[machine.bases[location]]
        return [edges[kind][0] for kind in machine.class_of]

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        if self.attempts or self.runs:
            if self.position < t:
                self.visit(t)
            self.begin_alone(t, triggered)
            return
        letter, other = self.letters(self.values)
        self.letter, self.other = letter, other
        self.position = t
        if not self.is_plain or (letter != other and self._part(letter, other)):
            self.begin_alone(t, triggered)
            return
        number, seen = self.clerk.entered(self)
        self.enter(triggered, plain=True)
        target = self.firsts[letter]
        if target <= PASSED:
            self._decide(number, triggered, seen, target == PASSED, t, self.machine.start)
        else:
            self.runs[target] = (triggered, number, seen)

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, at which the values are."""
        worse, better = self.letters(self.values)
        if self.attempts or (worse != better and self._part(worse, better)):
            self.attempts = self.undecided()
            self.runs.clear()
            Rule.visit(self, t)
            return
        self.letter, self.other = worse, better
        self.position = t
        if self.runs:
            target = self.targets[worse]
            if target <= PASSED:
                triggered, number, seen = self.runs.pop(self.place)
                token: Token = (self.place, ())
                self._decide(number, triggered, seen, target == PASSED, t, token)

    def _decide(
        self, number: int, triggered: int, seen: Any, verdict: bool, t: int, before: Token
    ) -> None:
        if not verdict:
            self.fail(triggered, t)
        self.clerk.decided_in_run(self, number, triggered, seen, verdict, t, before)

    def _part(self, worse: int, better: int) -> bool:
        """Whether the automaton distinguishes these letters."""
        kinds = self.machine.class_of
        return bool(kinds[worse] != kinds[better])

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        position = self.position
        Rule.pass_to(self, t)
        if self.runs and self.gap is not None and t > position:
            self.position = position + (t - position) // self.gap * self.gap

    def undecided(self) -> list[Any]:
        """The open attempts, oldest first, each as an object of its own."""
        found = list(self.attempts)
        for location, (triggered, number, seen) in self.runs.items():
            found.append(self.clerk.reopened(self, number, triggered, (location, ()), seen))
        found.sort(key=lambda attempt: attempt.triggered)
        return found
