"""Measures of windows, computed from their definitions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from msgspec.structs import replace

from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.testing.law.numbers import at_edge, compare, compare_at, events_of, is_born, number
from rvmon.testing.law.syntax import constant_value
from rvmon.testing.law.word import Letter, Truth, conjunction, truth_of
from rvmon.trace.sample import Scalar
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

_OF_SOME = (
    *(rv.Measured.MEAN, rv.Measured.VARIANCE, rv.Measured.DELTA),
    *(rv.Measured.MIN, rv.Measured.MAX, rv.Measured.AGO),
)
"""The measures that are undefined for an empty window."""
_WHOLE = (
    *(rv.Measured.COUNT, rv.Measured.DISTINCT, rv.Measured.SUM),
    *(rv.Measured.DELTA, rv.Measured.MIN, rv.Measured.MAX, rv.Measured.AGO),
)
"""The measures that are whole numbers if all members are."""
UNKNOWN = rv.Arithmetic(NumericOp.DIV, (rv.Literal(0), rv.Literal(0)))
"""An expression whose value is unknown."""
State = Callable[[rv.Formula, int], Truth]
"""The truth of a formula at a position."""


@dataclass(frozen=True, slots=True)
class Member:
    """A member of a window."""

    value: int | float | None  # its number; `None` if unknown
    sure: bool  # whether it certainly is a member
    size: int  # the number of positions, or ticks, that it stands for


@dataclass(frozen=True, slots=True)
class Past:
    """Evaluates windows on letters; `state` gives the truth of a formula at a position."""

    letters: Sequence[Letter]
    captured: Mapping[str, Scalar]
    state: State

    def truth(self, formula: rv.Amount, i: int) -> Truth:
        """Whether the measure of the window at a position reaches its limit.

        UNBORN if the limit is unborn, or if the measure is undefined because a signal is unborn.
        """
        known = formula.known and self.state(formula.known, i)
        if known is Truth.UNBORN or not self.is_born(formula.of, i):
            return Truth.UNBORN
        limit = self.number(formula.limit, i)
        members = self.members(formula.of, i)
        if limit is None or members is None:
            return Truth.UNKNOWN
        ends = ends_of(formula.of, members)

        def enough(found: Fraction) -> Truth:
            above = found > Fraction(limit) if formula.strict else found >= Fraction(limit)
            return truth_of(above)

        if ends is None:
            return Truth.UNKNOWN
        least, most = ends
        found = {enough(least), Truth.TRUE if most is None else enough(most)}
        return found.pop() if len(found) == 1 else Truth.UNKNOWN

    def compared(self, formula: rv.Compare, i: int) -> Truth:
        """The truth of a comparison of expressions with windows."""
        parts = [*rv.numbers_in(formula.left, formula.right)]
        plain = [
            rv.itself(part)
            for part in parts
            if not isinstance(part, rv.WindowValue | rv.Arithmetic)
        ]
        windows = [part for part in parts if isinstance(part, rv.WindowValue)]
        born = all(is_born(comparison, self.letters[i]) for comparison in plain)
        if not born or not all(self.is_born(window, i) for window in windows):
            return Truth.UNBORN
        found = self.settled(formula.left, i), self.settled(formula.right, i)
        return compare(rv.Compare(formula.op, *found), self.letters[i], self.captured)

    def number(self, expression: rv.Numeric, i: int) -> int | float | None:
        """The value of an expression with windows at a position; `None` if unknown."""
        return finite(number(self.settled(expression, i), self.letters[i], {}, self.captured))

    def settled(self, expression: rv.Numeric, i: int) -> rv.Numeric:
        """An expression with each window replaced by its value at a position."""
        match expression:
            case rv.Arithmetic(args=args):
                return replace(expression, args=tuple(self.settled(arg, i) for arg in args))
            case rv.WindowValue():
                found = self.amount(expression, i)
                return UNKNOWN if found is None else rv.Literal(found)
            case _:
                return expression

    def is_born(self, window: rv.WindowValue, i: int) -> bool:
        """Whether the signals of a window have had values; for `ago`, whether they had D ago."""
        if window.value is None or window.measured not in _OF_SOME:
            return True
        letter = self.letters[i] if window.measured is not rv.Measured.AGO else self._ago(window, i)
        return letter is not None and is_born(rv.itself(window.value), letter)

    def _ago(self, window: rv.WindowValue, i: int) -> Letter | None:
        then = self.letters[i].instant - (window.window or 0)
        held = [letter for letter in self.letters[: i + 1] if letter.instant <= then]
        return held[-1] if held else None

    def amount(self, window: rv.WindowValue, i: int) -> int | float | None:
        """The value of a window, rounded once; `None` if it is not certain.

        Counts are whole numbers, and so are measures of whole numbers that need no division.
        """
        if window.measured is rv.Measured.AGO:
            letter = self._ago(window, i)
            return None if letter is None else self._value(window, letter)
        members = self.members(window, i)
        ends = None if members is None else ends_of(window, members)
        if members is None or ends is None or ends[0] != ends[1]:
            return None
        seconds = window.measured is rv.Measured.DURATION
        exact = ends[0] / TICKS_PER_SECOND if seconds else ends[0]
        if window.measured in _WHOLE and all(isinstance(member.value, int) for member in members):
            return finite(at_edge(int(exact), Kind.INT))
        try:
            return finite(float(exact))
        except OverflowError:
            return None

    def _value(self, window: rv.WindowValue, letter: Letter) -> int | float | None:
        if window.value is None:
            raise AssertionError("`ago` has a value")
        return finite(number(window.value, letter, {}, self.captured))

    def members(self, window: rv.WindowValue, i: int) -> list[Member] | None:
        """The members of the window at a position; `None` if it is unknown which they are."""
        return self.last(window, i) if window.most else [*self.window(window, i)]

    def window(self, formula: rv.WindowValue, i: int) -> Iterator[Member]:
        """The members of a window over a duration, the oldest first."""
        for k in range(self.start(formula, i), i + 1):
            if size := _size(self.letters, k, i, formula):
                for value, sure in self.at(formula, k):
                    yield Member(value, sure, size)

    def start(self, formula: rv.WindowValue, i: int) -> int:
        """The first position of a window that starts at a captured instant; otherwise 0.

        Possible positions before that instant are not members.
        """
        since = self.letters[i].since
        left = getattr(formula.operand, "left", formula.operand)
        if since is None or not isinstance(left, rv.Passed) or left.since is None:
            return 0
        captured = self.captured[left.since]
        if not isinstance(captured, int) or left.after != rv.Literal(0) or left.strict:
            return 0
        return next(
            k for k in range(i + 1) if self.letters[k].instant - since >= captured or k == i
        )

    def last(self, formula: rv.WindowValue, i: int) -> list[Member] | None:
        """The members of a window over the last N; `None` if it is unknown which they are."""
        found: list[Member] = []
        for k in range(i, -1, -1):
            there = self.state(formula.operand, k)
            if there is Truth.UNKNOWN:
                return None
            at = [*self.at(formula, k)]
            if len(at) > 1:  # members of one instant have no order
                return None
            found += [Member(value, sure, 1) for value, sure in at]
            if len(found) == formula.most:
                break
        return found[::-1]

    def at(self, formula: rv.WindowValue, k: int) -> Iterator[tuple[int | float | None, bool]]:
        """The members at a position: the number of each, and whether it certainly is a member.

        A condition that is constantly false has no member with a number, not even at a possible
        position, where it is UNKNOWN like every formula.
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
        elif isinstance(formula.value, rv.Literal):
            yield finite(formula.value.value), there is Truth.TRUE
        elif not self.letters[k].sure:
            yield None, False
        else:
            yield from self._numbers(formula, formula.value, there, k)

    def _numbers(
        self, formula: rv.WindowValue, value: rv.Numeric, there: Truth, k: int
    ) -> Iterator[tuple[int | float | None, bool]]:
        letter = self.letters[k]
        events = events_of(value)
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
            chosen = [
                compare_at(comparison, letter, payloads, self.captured)
                for comparison in formula.chosen
            ]
            truth = conjunction([there, occurrence.truth, *chosen])
            if truth in (Truth.TRUE, Truth.UNKNOWN):
                found = number(value, letter, payloads, self.captured)
                yield finite(found), truth is Truth.TRUE


def finite(value: Scalar) -> int | float | None:
    """The value if it is a finite number; `None` otherwise."""
    if value is None or isinstance(value, str) or not math.isfinite(value):
        return None
    return value


Ends = tuple[Fraction, Fraction | None]
"""Lower and upper bound of a measure; `None`: no upper bound."""


def ends_of(window: rv.WindowValue, members: Sequence[Member]) -> Ends | None:
    """The bounds of a measure over members; `None` if it has no known bounds."""
    measured = window.measured
    if measured is rv.Measured.DISTINCT:
        known = Fraction(
            len({member.value for member in members if member.sure and member.value is not None})
        )
        return known, None if any(
            not member.sure or member.value is None for member in members
        ) else known
    if measured is rv.Measured.DELTA:
        members = [*members[:1], *members[-1:]]
    if any(member.value is None for member in members):
        return None
    numbers = [(Fraction(member.value or 0), member.sure, member.size) for member in members]
    if measured in _OF_SOME:
        found = _of_sure(measured, numbers) if all(sure for _, sure, _ in numbers) else None
        return None if found is None else (found, found)
    divisor = TICKS_PER_SECOND if measured is rv.Measured.INTEGRAL else 1
    least, most = (
        sum(size * (value if sure else end(value, Fraction(0))) for value, sure, size in numbers)
        for end in (min, max)
    )
    return Fraction(least) / divisor, Fraction(most) / divisor


def _of_sure(
    measured: rv.Measured, numbers: Sequence[tuple[Fraction, bool, int]]
) -> Fraction | None:
    """A measure of certain members with known numbers; `None` if there are none."""
    count = sum(size for _, _, size in numbers)
    if count == 0:
        return None
    values = [value for value, _, _ in numbers]
    match measured:
        case rv.Measured.MIN:
            return min(values)
        case rv.Measured.MAX:
            return max(values)
        case rv.Measured.DELTA:
            return values[-1] - values[0]
    mean = Fraction(sum(value * size for value, _, size in numbers), count)
    if measured is rv.Measured.MEAN:
        return mean
    squares = sum((value - mean) * (value - mean) * size for value, _, size in numbers)
    return Fraction(squares, count)


def _size(letters: Sequence[Letter], k: int, i: int, formula: rv.WindowValue) -> int:
    """The number of positions, or of ticks, that position `k` contributes to the window at `i`."""
    start = letters[k].instant
    first = start if formula.window is None else max(start, letters[i].instant - formula.window)
    if not formula.measured.of_time:
        return int(start == first)
    return max(0, letters[k + 1].instant - first) if k < i else 0
