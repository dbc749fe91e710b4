"""What the members of windows come to, straight from their definitions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rvmon.spec.checked.formula import (
    Amount,
    Formula,
    Literal,
    Measured,
    Numeric,
    Passed,
    itself,
)
from rvmon.testing.law.numbers import compare_at, events_of, is_born, number
from rvmon.testing.law.syntax import constant_value
from rvmon.testing.law.word import Letter, Truth, conjunction, truth_of
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TICKS_PER_SECOND

_OF_SOME = (Measured.MEAN, Measured.VARIANCE, Measured.DELTA)
"""What is not of nothing."""
State = Callable[[Formula, int], Truth]
"""The truth of a formula at a position."""


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a window.

    Attributes:
        value: its number; `None`: not known.
        sure: whether it is one.
        size: for so many positions, or ticks, it stands.
    """

    value: int | float | None
    sure: bool
    size: int


@dataclass(frozen=True, slots=True)
class Past:
    """The positions of a word as an amount looks at them.

    Attributes:
        letters: of the word.
        captured: values of `let` and `for each`.
        state: the truth of a formula at a position.
    """

    letters: Sequence[Letter]
    captured: Mapping[str, Scalar]
    state: State

    def truth(self, formula: Amount, i: int) -> Truth:
        """Whether the members of the window of a position come to as much as the limit.

        Unborn as the limit is, and what is of nothing without signals as these are.
        """
        asked = [] if formula.known is None else [formula.known]
        if formula.value is not None and formula.measured in _OF_SOME:
            asked.append(itself(formula.value))
        if not all(is_born(part, self.letters[i]) for part in asked):
            return Truth.UNBORN
        limit = finite(number(formula.limit, self.letters[i], {}, self.captured))
        members = self.last(formula, i) if formula.most else [*self.window(formula, i)]
        if limit is None or members is None:
            return Truth.UNKNOWN
        return compared(formula, members, Fraction(limit))

    def window(self, formula: Amount, i: int) -> Iterator[Member]:
        """The members of the last D, the first one first."""
        for k in range(self.begin(formula, i), i + 1):
            if size := _size(self.letters, k, i, formula):
                for value, sure in self.at(formula, k):
                    yield Member(value, sure, size)

    def begin(self, formula: Amount, i: int) -> int:
        """The first position that is not before a captured instant, if members are behind one.

        Where there may be a position before it, too, that is no member.
        """
        since = self.letters[i].since
        left = getattr(formula.operand, "left", formula.operand)
        if since is None or not isinstance(left, Passed) or left.since is None:
            return 0
        captured = self.captured[left.since]
        if not isinstance(captured, int) or left.after != Literal(0) or left.strict:
            return 0
        return next(
            k for k in range(i + 1) if self.letters[k].instant - since >= captured or k == i
        )

    def last(self, formula: Amount, i: int) -> list[Member] | None:
        """The last so many members; `None` if it is not known which these are."""
        found: list[Member] = []
        for k in range(i, -1, -1):
            there = self.state(formula.operand, k)
            if there is Truth.UNKNOWN:
                return None
            at = [*self.at(formula, k)]
            if len(at) > 1:  # at one instant none is later
                return None
            found += [Member(value, sure, 1) for value, sure in at]
            if len(found) == formula.most:
                break
        return found[::-1]

    def at(self, formula: Amount, k: int) -> Iterator[tuple[int | float | None, bool]]:
        """The numbers of the members at a position, and whether they are some.

        What is false whatever is read makes none with a number, though there may be a position.
        """
        there = self.state(formula.operand, k)
        never = formula.value is not None and constant_value(formula.operand) is Truth.FALSE
        if never or there in (Truth.FALSE, Truth.UNBORN):
            return
        if formula.value is None and formula.counted is not None:
            counted = self.state(formula.counted, k)
            yield int(counted in (Truth.TRUE, Truth.UNKNOWN)), counted is not Truth.UNKNOWN
        elif formula.value is None:
            yield 1, there is Truth.TRUE
        elif isinstance(formula.value, Literal):
            yield finite(formula.value.value), there is Truth.TRUE
        elif not self.letters[k].sure:
            yield None, False
        else:
            yield from self._numbers(formula, formula.value, there, k)

    def _numbers(
        self, formula: Amount, value: Numeric, there: Truth, k: int
    ) -> Iterator[tuple[int | float | None, bool]]:
        letter = self.letters[k]
        events = {*events_of(value)}
        if any(self.state(part, k) in (Truth.FALSE, Truth.UNBORN) for part in formula.chosen):
            return
        if len(events) != 1:
            several = any(len(letter.events[event].occurrences) > 1 for event in events)
            first = {event: letter.events[event].occurrences[0].payload for event in events}
            found = None if several else number(value, letter, first, self.captured)
            yield finite(found), there is Truth.TRUE
            return
        (event,) = events
        for occurrence in letter.events[event].occurrences:
            payloads = {event: occurrence.payload}
            chosen = [compare_at(one, letter, payloads, self.captured) for one in formula.chosen]
            truth = conjunction([there, occurrence.truth, *chosen])
            if truth in (Truth.TRUE, Truth.UNKNOWN):
                found = number(value, letter, payloads, self.captured)
                yield finite(found), truth is Truth.TRUE


def finite(value: Scalar) -> int | float | None:
    """A number, if it is one."""
    if value is None or isinstance(value, str) or not math.isfinite(value):
        return None
    return value


def compared(formula: Amount, members: Sequence[Member], limit: Fraction) -> Truth:
    """What members come to beside the limit; where that may be less or more, both."""
    measured = formula.measured

    def enough(found: Fraction | int) -> Truth:
        return truth_of(found > limit if formula.strict else found >= limit)

    if measured is Measured.DISTINCT:
        known = {one.value for one in members if one.sure and one.value is not None}
        sure = enough(len(known))
        open_ = any(not one.sure or one.value is None for one in members)
        return Truth.UNKNOWN if open_ and sure is Truth.FALSE else sure
    if measured is Measured.DELTA:
        ends = [one.value if one.sure else None for one in (members[0], members[-1])]
        first, last = ends
        if first is None or last is None:
            return Truth.UNKNOWN
        return enough(Fraction(last) - Fraction(first))
    if any(one.value is None for one in members):
        return Truth.UNKNOWN
    numbers = [(Fraction(one.value or 0), one.sure, one.size) for one in members]
    if measured in (Measured.MEAN, Measured.VARIANCE):
        count = sum(size for _, _, size in numbers)
        if count == 0 or not all(sure for _, sure, _ in numbers):
            return Truth.UNKNOWN
        mean = Fraction(sum(value * size for value, _, size in numbers), count)
        if measured is Measured.MEAN:
            return enough(mean)
        squares = sum((value - mean) * (value - mean) * size for value, _, size in numbers)
        return enough(Fraction(squares, count))
    divisor = TICKS_PER_SECOND if measured is Measured.INTEGRAL else 1
    least, most = (
        sum(size * (value if sure else end(value, Fraction(0))) for value, sure, size in numbers)
        for end in (min, max)
    )
    ends_ = {enough(Fraction(least) / divisor), enough(Fraction(most) / divisor)}
    return ends_.pop() if len(ends_) == 1 else Truth.UNKNOWN


def _size(letters: Sequence[Letter], k: int, i: int, formula: Amount) -> int:
    """How many positions, or ticks, of the window of `i` a position stands for."""
    begin = letters[k].instant
    first = begin if formula.window is None else max(begin, letters[i].instant - formula.window)
    if not formula.measured.of_time:
        return int(begin == first)
    return max(0, letters[k + 1].instant - first) if k < i else 0
