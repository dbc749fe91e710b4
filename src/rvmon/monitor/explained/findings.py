"""What is reported of decisions that are alike, worked out once."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from rvmon.automaton.location import Token, location_of
from rvmon.formula.progress import after, value
from rvmon.formula.residual import NO_CLOCK, Residual
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.reasons.cause import Cause, CauseFinder
from rvmon.monitor.reasons.obligation_words import deadline
from rvmon.monitor.reasons.sentence import Sentence

Instant = TypeVar("Instant")
"""In ticks: one, or an array of them."""


class Residuals(Protocol):
    """What runs stand in the locations of."""

    def residual(self, location: int) -> Residual:
        """What is owed in a location."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What decisions have in common that differ in instants alone.

    Attributes:
        cause: `None` if nothing could decide otherwise.
        sentence: about it.
    """

    cause: Cause | None
    sentence: Sentence

    def start(self, anchors: Sequence[Instant], t: Instant, triggered: Instant) -> Instant:
        """The instant at which what decided was instantiated."""
        clock = self.cause.start if self.cause else NO_CLOCK
        if clock == NO_CLOCK:
            return triggered
        return anchors[clock] if clock > NO_CLOCK else t


class Reasons:
    """Finds the reasons of the decisions of one requirement.

    What was owed, in which of its windows, and the letter: more makes no difference to a reason.
    """

    def __init__(self, compiled: CompiledRequirement, machine: Residuals) -> None:
        self.words = compiled.words
        self._alphabet = compiled.alphabet
        self._machine = machine
        self._cuts: dict[int, tuple[tuple[int, ...], ...]] = {}
        self._found: dict[tuple[int, ...], Finding] = {}
        self._deadlines: dict[int, int | None] = {}

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location, the ages at which a window opens or is over, ascending."""
        cuts = self._cuts.get(location)
        if cuts is None:
            cuts = self._cuts[location] = location_of(self._machine.residual(location)).cuts
        return cuts

    def of(self, before: Token, letter: int, verdict: bool, t: int) -> Finding:
        """What is reported of a decision."""
        location, anchors = before
        ages = zip(self.cuts(location), anchors, strict=True)
        key = (location, letter, verdict, *[bisect_right(cuts, t - at) for cuts, at in ages])
        found = self._found.get(key)
        if found is None:
            found = self._found[key] = self._find(before, letter, verdict, t)
        return found

    def _find(self, before: Token, letter: int, verdict: bool, t: int) -> Finding:
        residual = self._machine.residual(before[0])
        ages = [t - anchor for anchor in before[1]]
        by_time = value(after(residual, ages)) != UNKNOWN
        valuation = self._alphabet.valuation(letter)
        cause = CauseFinder(valuation, ages, verdict=verdict, by_time=by_time).of(residual)
        if cause is None:
            return Finding(None, ("there was no obligation" if verdict else "it can never hold",))
        return Finding(cause, self.words.sentence(cause, verdict))

    def deadline(self, before: Token) -> int | None:
        """The last instant before time alone settles what was owed; see `Attempt`."""
        location, anchors = before
        if len(anchors) != 1:
            return deadline(self._machine.residual(location), anchors)
        if location not in self._deadlines:
            self._deadlines[location] = deadline(self._machine.residual(location), (0,))
        after_start = self._deadlines[location]
        return None if after_start is None else anchors[0] + after_start
