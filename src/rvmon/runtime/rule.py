"""The open attempts of one requirement, and how they are driven through time."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, Any

from rvmon.runtime.starts import Starts
from rvmon.runtime.table import (
    BARE,
    FRESH,
    next_cut,
    run,
    settle,
)
from rvmon.runtime.values import FAILED, NEVER, PASSED

if TYPE_CHECKING:
    from collections.abc import Callable

    from rvmon.runtime.table import Token

    Drive = Callable[[Token, int], tuple[Token, int]]


class Rule(Starts):
    """Starts attempts and drives them.

    Args:
        index: of the requirement.
        machine: judges its attempts; `None`: somebody else does.
        letters: gives, from the values, the letters with the unknown taken for worse and better;
            `None` without a machine.
        trigger: as for `Starts`; so are the next five.
        pulse: see there.
        episodic: see there.
        hidden: see there.
        again: see there.
        unborn: see there.
        gap: ticks between two positions; `None` if only samples are positions.
        values: the truth of the state formulas.
        clerk: makes attempts and hears of decisions.

    Attributes:
        attempts: the undecided ones, oldest first, but for those in runs.
        runs: by location the attempts that move together.
        due: an instant before which, the letters staying, no attempt can be decided.
        restless: whether attempts may move at the next position though the letters stay.
        slides: whether a clock moves along while an attempt loops.
        watches: whether it has to see positions though no attempt is open.
        leaps: whether attempts may begin at positions that time has passed.
    """

    __slots__ = (
        "due",
        "gap",
        "index",
        "letter",
        "letters",
        "machine",
        "moves",
        "other",
        "position",
        "restless",
        "runs",
        "slides",
    )

    STATE: tuple[str, ...] = (
        *Starts.STATE,
        *("runs", "due", "restless", "slides", "position", "letter", "other"),
    )

    def __init__(
        self,
        index: int,
        machine: Any,
        letters: Any,
        trigger: int,
        pulse: bool,
        episodic: bool,
        hidden: bool,
        again: int,
        unborn: int,
        gap: int | None,
        values: list[int],
        clerk: Any,
    ) -> None:
        super().__init__(trigger, pulse, episodic, hidden, again, unborn, values, clerk)
        self.index = index
        self.machine = machine
        self.moves: Any = None if machine is None else machine.moves
        self.letters = letters
        self.gap = gap
        self.runs: dict[int, Any] = {}
        self.due = NEVER
        self.restless = False
        self.slides = False
        self.position = -NEVER
        self.letter = self.other = 0

    watches = False
    leaps = False

    def begin(self, t: int, triggered: int) -> None:
        """Start an attempt at the position `t`, at which the values are."""
        if self.position < t:
            self.visit(t)
        self.begin_alone(t, triggered)

    def begin_alone(self, t: int, triggered: int) -> None:
        """Start an attempt that is driven by itself, at the position visited last."""
        machine = self.machine
        attempt = self.clerk.opened(self, triggered, machine.start, self.is_sure)
        self.enter(triggered, plain=self.is_plain)
        if self.moves is None or self.letter != self.other:
            due = self.stepped(attempt, t)
        else:
            move = self.moves[machine.class_of[self.letter]][machine.start[0]][0]
            due = NEVER if move is None else self._go(attempt, move, t)
        if due is not None:
            self.attempts.append(attempt)
            if due < self.due:
                self.due = due

    def _decided(self, attempt: Any, verdict: bool, t: int, before: Token) -> None:
        if not verdict:
            self.fail(attempt.triggered, t)
        self.clerk.decided(self, attempt, verdict, t, before)

    def undecided(self) -> list[Any]:
        """The open attempts, oldest first."""
        return self.attempts

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, at which the values are."""
        if self.slides or self.due < t:
            self.pass_to(t - 1)
        self.letter, self.other = self.letters(self.values)
        self.restless = self.slides = False
        self.position = t
        attempts = self.attempts
        if not attempts:
            self.due = NEVER
            return
        if self.moves is None or self.letter != self.other:
            self._move_all(lambda attempt: self.stepped(attempt, t))
            return
        machine = self.machine
        moves = self.moves[machine.class_of[self.letter]]
        kept = []
        due = NEVER
        for attempt in attempts:
            location, anchors = attempt.token
            own: int | None = NEVER
            if attempt.better is not None:
                own = self.stepped(attempt, t)
            elif anchors:
                cuts = machine.cuts_of[location][0]
                region = bisect_right(cuts, t - anchors[0])
                move = moves[location][region]
                if move is not None:
                    own = self._go(attempt, move, t)
                elif region < len(cuts):
                    own = anchors[0] + cuts[region]
            elif moves[location][0] is not None:
                own = self._go(attempt, moves[location][0], t)
            if own is not None:
                kept.append(attempt)
                if own < due:
                    due = own
        if len(kept) < len(attempts):
            self.attempts = kept
        self.due = due

    def stepped(self, attempt: Any, t: int) -> int | None:
        """Step an attempt at the position `t`; returns when it is due, `None` if it was decided."""
        if attempt.better is None and self.letter == self.other:
            before = attempt.token
            token, due = self._step(before, self.letter, t)
            return self._moved(attempt, before, token, due)
        return self._both(attempt, lambda token, letter: self._step(token, letter, t))

    def _go(self, attempt: Any, move: Any, t: int) -> int | None:
        """As `stepped`, by a move of `rvmon.runtime.table.moves_of`."""
        target, how, leads_on = move
        if target <= PASSED:
            self._decided(attempt, target == PASSED, t, attempt.token)
            return None
        machine = self.machine
        if how == BARE:
            attempt.token = machine.bare[target]
        else:
            token = attempt.token = (target, (t,) if how == FRESH else attempt.token[1])
            if leads_on is None:
                leads_on = not machine.stays(token, t, self.letter)
            if not leads_on:
                return next_cut(machine, token, t)
        if leads_on:
            self.restless = True
            return t + 1
        return NEVER

    def _step(self, token: Token, letter: int, t: int) -> tuple[Token, int]:
        moved = self.machine.step(token, t, letter)
        if moved[0] <= PASSED:
            return moved, t
        # Where the same letter leads on, it has to be asked again at the next position.
        if moved != token and not self.machine.stays(moved, t, letter):
            self.restless = True
            return moved, t + 1
        return moved, next_cut(self.machine, moved, t)

    def _moved(self, attempt: Any, before: Token, token: Token, due: int) -> int | None:
        if token[0] <= PASSED:
            self._decided(attempt, token[0] == PASSED, due, before)
            return None
        attempt.token = token
        return due

    def _both(self, attempt: Any, drive: Drive) -> int | None:
        """Drive the runs that take the unknown for the worse and for the better."""
        worse, better = attempt.token, attempt.better
        if better is None:
            if self.letter == self.other:
                token, due = drive(worse, self.letter)
                return self._moved(attempt, worse, token, due)
            better = worse
        due = NEVER
        moved, moved_better = worse, better
        if worse[0] != FAILED:
            moved, due = drive(worse, self.letter)
            if moved[0] == PASSED:
                self._decided(attempt, True, due, worse)
                return None
            if moved[0] == FAILED:
                due = NEVER
        if better[0] != PASSED:
            moved_better, own = drive(better, self.other)
            if moved_better[0] == FAILED:
                self._decided(attempt, False, own, better)
                return None
            if moved_better[0] != PASSED:
                due = min(due, own)
        apart = moved != moved_better
        if apart != (attempt.better is not None):
            self.clerk.parted(self, attempt, apart)
        attempt.token, attempt.better = moved, moved_better if apart else None
        return due

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        gap, position = self.gap, self.position
        if not self.attempts:
            self.due = NEVER
        elif gap is None:
            self.restless = self.restless or self.due <= t
            self._drive_all(lambda token, _: settle(self.machine, token, position, t))
        elif t > position:
            self.slides = False
            self._drive_all(lambda token, letter: self._run(token, letter, position + gap, t))
            self.position += (t - position) // gap * gap
            self.restless = False

    def _run(self, token: Token, letter: int, first: int, last: int) -> tuple[Token, int]:
        token, due, slides = run(self.machine, token, letter, first, last, self.gap or 1)
        if slides:
            self.slides = True
        return token, due

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self.pass_to(t - 1)
        position = self.position
        self.restless = self.restless or self.due <= t
        self._drive_all(lambda token, _: settle(self.machine, token, position, t))
        if self.gap is not None and self.attempts and self.due > t:
            self.due = t

    def _drive_all(self, drive: Drive) -> None:
        self._move_all(lambda attempt: self._both(attempt, drive))

    def _move_all(self, move: Callable[[Any], int | None]) -> None:
        """Move all attempts; `move` returns when one is due, `None` if it was decided."""
        due = NEVER
        kept = []
        for attempt in self.attempts:
            own = move(attempt)
            if own is not None:
                kept.append(attempt)
                if own < due:
                    due = own
        self.attempts = kept
        self.due = due
