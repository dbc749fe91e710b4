"""The open attempts of one requirement, driven through positions and time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import INFINITY, Machine, Token
from rvmon.automaton.stretch import next_cut, run, settle
from rvmon.dataflow.flow import Flow
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TIME_LIMIT, format_ticks

Drive = Callable[[Token, int], tuple[Token, int]]
"""Takes a token on under a letter; gives it with the instant of its decision, or when it is due."""


class Open:
    """One undecided attempt.

    Attributes:
        number: of the attempt; 0 until it is numbered.
        triggered: the instant of its trigger.
        token: of the run that takes the unknown for the worse.
        better: of the run that takes it for the better; `None` as long as both are the same.
        seen: the values of the judge's leaves at the trigger.
        doubt: when and why the two runs parted; empty if they did not.
    """

    __slots__ = ("better", "doubt", "number", "seen", "token", "triggered")

    def __init__(self, triggered: int, token: Token, seen: tuple[int, ...]) -> None:
        self.number = 0
        self.triggered = triggered
        self.token = token
        self.better: Token | None = None
        self.seen = seen
        self.doubt = ""


class Clerk(Protocol):
    """Keeps the records."""

    def decided(self, judge: Judge, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """Take a decision at `t`; `before` is the token of the run that brought it, before that.

        Between the position of `before` and `t` the letters were as the judge has them.
        """


class Judge:
    """The open attempts that share their letters.

    Attributes:
        compiled: the requirement.
        machine: judges it.
        flow: gives the truth of the propositions.
        clerk: hears of decisions.
        captured: values of `let` and `for each`.
        places: of the propositions in the flow.
        leaves: place and text of what is read of the input.
        letters: of the position read last, the unknown taken for the worse and for the better.
        attempts: the undecided ones, oldest first; also those that only the end can settle.
        due: an instant before which, the letters staying, no attempt can be decided.
        restless: whether attempts may move at the next position though the letters stay.
    """

    def __init__(
        self,
        compiled: CompiledRequirement,
        machine: Machine,
        flow: Flow,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
    ) -> None:
        alphabet = compiled.alphabet
        self.compiled = compiled
        self.machine = machine
        self.flow = flow
        self.clerk = clerk
        self.captured = captured
        self.places = tuple(flow.graph.index[state] for state in alphabet.propositions)
        index = flow.graph.index
        self.leaves = tuple((index[leaf], text) for leaf, text in compiled.leaves if leaf in index)
        self._worse = tuple(zip(self.places, alphabet.pessimistic, strict=True))
        self._better = tuple(zip(self.places, alphabet.optimistic, strict=True))
        self.letters = (0, 0)
        self.attempts: list[Open] = []
        self.due = INFINITY
        self.restless = False
        self.position = -TIME_LIMIT

    def read(self) -> None:
        """Take the letters of the position that the flow is at."""
        values = self.flow.values
        self.letters = (
            sum([weights[values[place]] for place, weights in self._worse]),
            sum([weights[values[place]] for place, weights in self._better]),
        )

    def begin(self, t: int, triggered: int) -> Open:
        """Start an attempt at the position `t`, which the flow is at."""
        if self.position < t:
            self.visit(t)
        attempt = Open(triggered, self.machine.start, self.seen)
        due = self._drive(attempt, self._stepping(t))
        if due is not None:
            self.attempts.append(attempt)
            self.due = min(self.due, due)
        return attempt

    @property
    def seen(self) -> tuple[int, ...]:
        """The values of the leaves now."""
        values = self.flow.values
        return tuple([values[place] for place, _ in self.leaves])

    def visit(self, t: int) -> None:
        """Take all attempts to the position `t`, which the flow is at."""
        self.pass_to(t - 1)
        self.read()
        self.restless = False
        self.position = t
        if self.attempts:
            self._drive_all(self._stepping(t))

    def _stepping(self, t: int) -> Drive:
        machine = self.machine

        def drive(token: Token, letter: int) -> tuple[Token, int]:
            moved = machine.step(token, t, letter)
            if moved[0] <= PASSED:
                return moved, t
            if moved != token:
                self.restless = True
                return moved, t + 1
            return moved, next_cut(machine, moved, t)

        return drive

    @property
    def next_due(self) -> int:
        """The next instant at which time alone can decide an attempt, as far as is known now."""
        gap = self.flow.gap
        if gap is None or self.due > self.position + gap:
            return self.due
        following = self.position + gap
        found = INFINITY
        for attempt in self.attempts:
            runs = ((attempt.token, self.letters[0]), (attempt.better, self.letters[1]))
            for token, letter in runs:
                if token is not None and token[0] > PASSED:
                    found = min(
                        found, run(self.machine, token, letter, following, following, gap)[1]
                    )
        return found

    def pass_to(self, t: int) -> None:
        """Let time come to `t` with the letters as they are; positions up to there are stepped."""
        gap, position = self.flow.gap, self.position
        if not self.attempts:
            self.due = INFINITY
        elif gap is None:
            self.restless = self.restless or self.due <= t
            self._drive_all(lambda token, _: settle(self.machine, token, position, t))
        elif t > position:
            self._drive_all(
                lambda token, letter: run(self.machine, token, letter, position + gap, t, gap)
            )
            self.position += (t - position) // gap * gap
            self.restless = False

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which the letter is not known, from the instant before."""
        self.pass_to(t - 1)
        position = self.position
        self.restless = self.restless or self.due <= t
        self._drive_all(lambda token, _: settle(self.machine, token, position, t))
        if self.flow.gap is not None:
            self.due = min(self.due, t)

    def _drive_all(self, drive: Drive) -> None:
        due = INFINITY
        kept = []
        for attempt in self.attempts:
            own = self._drive(attempt, drive)
            if own is not None:
                kept.append(attempt)
                due = min(due, own)
        self.attempts = kept
        self.due = due

    def _drive(self, attempt: Open, drive: Drive) -> int | None:
        """Take one attempt on; returns when it is due, `None` if it was decided."""
        letter, other = self.letters
        worse, better = attempt.token, attempt.better
        if better is None and letter == other:
            token, t = drive(worse, letter)
            if token[0] <= PASSED:
                self.clerk.decided(self, attempt, token[0] == PASSED, t, worse)
                return None
            attempt.token = token
            return t
        if better is None:
            better = worse
            attempt.doubt = self._doubt()
        due = INFINITY
        moved, moved_better = worse, better
        if worse[0] != FAILED:
            moved, due = drive(worse, letter)
            if moved[0] == PASSED:
                self.clerk.decided(self, attempt, True, due, worse)
                return None
            due = INFINITY if moved[0] == FAILED else due
        if better[0] != PASSED:
            moved_better, t = drive(better, other)
            if moved_better[0] == FAILED:
                self.clerk.decided(self, attempt, False, t, better)
                return None
            due = due if moved_better[0] == PASSED else min(due, t)
        attempt.token = moved
        attempt.better = None if moved == moved_better else moved_better
        return due

    def _doubt(self) -> str:
        values = self.flow.values
        unknown = [text for place, text in self.leaves if values[place] == UNKNOWN]
        return (
            f"{', '.join(f'`{text}`' for text in unknown)} unknown at {format_ticks(self.position)}"
        )
