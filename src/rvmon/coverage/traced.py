"""Which locations and edges of its automaton the attempts of a requirement go through."""

from __future__ import annotations

from typing import Any

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.automaton.table import TableMachine
from rvmon.coverage.hits import Hit
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.attempts.machine_judge import MachineJudge
from rvmon.runtime.rule import Rule
from rvmon.runtime.values import UNKNOWN

Passage = tuple[int, int]
"""From a location to one."""


class TracedMachine(TableMachine):
    """Steps an automaton and notes how.

    Attributes:
        sure: whether what is stepped is what an attempt does, and not one of two possibilities.
        passages: how often each was made, and when first.
    """

    def __init__(self, automaton: Automaton) -> None:
        super().__init__(automaton)
        self.moves = None  # each step is to be seen
        self.sure = True
        self.passages: dict[Passage, Hit] = {}

    def step(self, token: Token, t: int, letter: int) -> Token:
        """See `Machine`."""
        moved = super().step(token, t, letter)
        self._note(token[0], moved[0], t)
        return moved

    def time_value(self, token: Token, t: int) -> int:
        """See `Machine`; time alone leads to a verdict."""
        truth = super().time_value(token, t)
        if truth != UNKNOWN:
            self._note(token[0], PASSED if truth else FAILED, t)
        return truth

    def _note(self, source: int, target: int, t: int) -> None:
        if self.sure:
            key = source, target
            known = self.passages.get(key)
            self.passages[key] = Hit(1, t) if known is None else Hit(known.count + 1, known.first)


class _Traced(Rule):
    """Has its machine note steps, but those of attempts in two minds."""

    __slots__ = ()

    def stepped(self, attempt: Any, t: int) -> int | None:
        """See `Rule`."""
        self._look_at(attempt)
        return super().stepped(attempt, t)

    def _both(self, attempt: Any, drive: Any) -> int | None:
        self._look_at(attempt)
        return super()._both(attempt, drive)

    def _look_at(self, attempt: Open) -> None:
        alone = attempt.better is None and self.letter == self.other
        self.machine.sure = alone and attempt.sure


class TracedRule(_Traced):
    """A rule of generated code."""

    __slots__ = ()


class TracedJudge(_Traced, MachineJudge):
    """A rule that knows its requirement."""
