"""Open attempts as tokens of a machine, driven through positions and time."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import INFINITY, Machine, Token
from rvmon.dataflow.flow import Flow
from rvmon.formula.progress import after, holds_at_end
from rvmon.monitor.attempt_judge import AttemptJudge, Clerk, Open
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.runtime.table import next_cut, run, settle
from rvmon.trace.sample import Scalar

Drive = Callable[[Token, int], tuple[Token, int]]
"""Takes a token on under a letter; gives it with the instant of its decision, or when it is due."""


class Judge(AttemptJudge):
    """Judges by the tokens of a machine.

    Attributes:
        machine: judges the attempts.
        letters: of the position read last, the unknown taken for the worse and for the better.
    """

    STATE = (*AttemptJudge.STATE, "letters")

    def __init__(
        self,
        compiled: CompiledRequirement,
        machine: Machine,
        flow: Flow,
        clerk: Clerk,
        captured: Mapping[str, Scalar],
    ) -> None:
        super().__init__(compiled, flow, clerk, captured)
        alphabet = compiled.alphabet
        self.machine = machine
        self._worse = tuple(zip(self.places, alphabet.pessimistic, strict=True))
        self._better = tuple(zip(self.places, alphabet.optimistic, strict=True))
        self.letters = (0, 0)

    def read(self) -> None:
        """Take the letters of the position that the flow is at."""
        values = self.flow.values
        self.letters = (
            sum([weights[values[place]] for place, weights in self._worse]),
            sum([weights[values[place]] for place, weights in self._better]),
        )

    def new_attempt(self, _: int, triggered: int) -> Open:
        """See `AttemptJudge`."""
        return Open(triggered, self.machine.start, self.seen)

    def begin(self, attempt: Open, t: int) -> None:
        """See `AttemptJudge`."""
        if self.position < t:
            self.visit(t)
        due = self._drive(attempt, self._stepping(t))
        if due is not None:
            self.attempts.append(attempt)
            self.due = min(self.due, due)

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
                lambda token, letter: run(self.machine, token, letter, position + gap, t, gap)[:2]
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

    def held_at_end(self, attempt: Open, end: int, reached: int) -> bool:
        """Whether the rule for the end of a trace makes an undecided attempt true."""
        location, anchors = attempt.token
        residual = after(self.machine.residual(location), [reached - a for a in anchors])
        return holds_at_end(residual, [end - a for a in anchors])
