"""The robustness of formulas as intervals, from its definition."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from itertools import product

from rvmon.language.checked import formula as rv
from rvmon.testing.law.numbers import events_of, number
from rvmon.testing.law.operators import At, Operators
from rvmon.testing.law.syntax import is_composed
from rvmon.testing.law.truths import Truths
from rvmon.testing.law.word import (
    Letter,
    Rest,
    Truth,
    Word,
    conjunction,
    disjunction,
    negation,
    truth_of,
)
from rvmon.trace.sample import Payload, Scalar

Range = tuple[float, float]
"""The least and greatest value."""

TOP: Range = (math.inf, math.inf)
BOTTOM: Range = (-math.inf, -math.inf)
ANY: Range = (-math.inf, math.inf)
AS_UNBORN = (BOTTOM, ANY, TOP)
"""The ranges of an UNBORN formula, read as FALSE, as UNKNOWN, and as TRUE."""
OF_TRUTH = {Truth.FALSE: BOTTOM, Truth.UNKNOWN: ANY, Truth.TRUE: TOP}


def negated(value: Range) -> Range:
    """The robustness of a negation."""
    return -value[1], -value[0]


def least(values: Iterable[Range]) -> Range:
    """The range of a conjunction; `TOP` if it is empty."""
    lows, highs = zip(TOP, *values, strict=True)
    return min(lows), min(highs)


def most(values: Iterable[Range]) -> Range:
    """The range of a disjunction; `BOTTOM` if it is empty."""
    lows, highs = zip(BOTTOM, *values, strict=True)
    return max(lows), max(highs)


@dataclass(frozen=True, slots=True)
class Margin:
    """The robustness of a formula at a position."""

    state: Truth  # its truth, UNBORN included
    # its range if UNBORN is read as FALSE, as UNKNOWN, and as TRUE
    ranges: tuple[Range, Range, Range]


class Margins(Operators[Margin]):
    """The robustness of formulas at the positions of a word.

    Args:
        word: the trace.
        captured: the values of `let` and `for each`.
        first: the first certain position, before which letters may be anything; 0 if there is no
            position before it.
        rest: the assumption about pending operators.
        held: whether time is held; then measures that change between samples have no distance.
        favour: whether an unborn proposition counts as met; otherwise it is UNKNOWN.

    Source: SEMANTICS, sections 1 (Birth), 2 and 5; decision record 4.
    """

    def __init__(
        self,
        word: Word,
        captured: Mapping[str, Scalar],
        first: int,
        rest: Rest,
        *,
        held: bool,
        favour: bool,
    ) -> None:
        super().__init__(word, rest)
        self._captured = captured
        self._first = first
        self._held_time = held
        self._favour = favour
        self._truths = Truths(word, captured)
        self._margins: dict[tuple[int, int, bool], Margin] = {}
        self._states: dict[tuple[int, int], Margin] = {}

    def required(self, formula: rv.Formula, i: int) -> Range:
        """The robustness of a formula that is required at a position."""
        return self._required(formula, i, True).ranges[Truth.UNKNOWN]

    def _required(self, formula: rv.Formula, i: int, positive: bool) -> Margin:
        key = (id(formula), i, positive)
        if key not in self._margins:
            inside = i >= self._first
            self._margins[key] = self._margin(formula, i, positive) if inside else _always(ANY)
        return self._margins[key]

    def _margin(self, formula: rv.Formula, i: int, positive: bool) -> Margin:
        if is_composed(formula):

            def sub(part: rv.Formula, k: int, same: bool = True) -> Margin:
                return self._required(part, k, positive is same)

            return self.operator(formula, i, sub, positive=positive)
        unborn = truth_of(positive) if self._favour else Truth.UNKNOWN
        return _always(self.state(formula, i).ranges[unborn])

    def state(self, formula: rv.Formula, i: int) -> Margin:
        """The robustness of a formula of the present and past; it may be UNBORN."""
        key = (id(formula), i)
        if key not in self._states:
            truth = self._truths.state(formula, i)
            found = self._state(formula, i, truth) if i >= self._first else _always(ANY)
            self._states[key] = Margin(truth, found.ranges)
        return self._states[key]

    def _state(self, formula: rv.Formula, i: int, truth: Truth) -> Margin:
        match formula:
            case rv.Unary() | rv.Binary():
                return self.operator(formula, i, lambda part, k, _=True: self.state(part, k))
            case _ if truth is Truth.UNBORN:
                return self.of_truth(truth)
            case rv.Amount() if formula.has_distance(held=self._held_time):
                return self._of_windows(formula.comparison, i)
            case rv.Compare(left=left, right=right) if rv.windows_in(left, right):
                return self._of_windows(formula, i)
            case rv.Compare():
                return _always(_compared(formula, self._letters[i], self._captured))
            case _:
                return self.of_truth(truth)

    def _of_windows(self, formula: rv.Compare, i: int) -> Margin:
        left, right = (self._truths.settled(side, i) for side in (formula.left, formula.right))
        settled = rv.Compare(formula.op, left, right)
        return _always(_compared(settled, self._letters[i], self._captured))

    def of_truth(self, truth: Truth) -> Margin:
        """See `Operators`."""
        ranges = AS_UNBORN if truth is Truth.UNBORN else (OF_TRUTH[truth],) * 3
        return Margin(truth, ranges)

    def negation(self, value: Margin) -> Margin:
        """See `Operators`."""
        of_false, unknown, of_true = map(negated, value.ranges)
        return Margin(negation(value.state), (of_true, unknown, of_false))

    def both(self, left: Margin, right: Margin) -> Margin:
        """See `Operators`; next to an UNKNOWN operand, an unborn one does not make it FALSE."""
        _, unknown, of_true = map(least, zip(left.ranges, right.ranges, strict=True))
        truth = conjunction([left.state, right.state])
        of_false = BOTTOM if _is_unborn(left, right) else unknown
        return Margin(truth, (of_false, unknown, of_true))

    def either(self, left: Margin, right: Margin) -> Margin:
        """See `Operators`; next to an UNKNOWN operand, an unborn one does not make it TRUE."""
        of_false, unknown, _ = map(most, zip(left.ranges, right.ranges, strict=True))
        truth = disjunction([left.state, right.state])
        of_true = TOP if _is_unborn(left, right) else unknown
        return Margin(truth, (of_false, unknown, of_true))

    def born_or_false(self, value: Margin) -> Margin:
        """See `Operators`."""
        state = Truth.FALSE if value.state is Truth.UNBORN else value.state
        return _always(value.ranges[Truth.FALSE], state)

    def previous(self, operand: At[Margin], i: int) -> Margin:
        """See `Operators`."""
        if i == 0:
            return self.of_truth(Truth.FALSE)
        before = operand(i - 1)
        return _unless_unborn(before.ranges[Truth.FALSE], before.state)

    def since(
        self,
        left: At[Margin],
        right: At[Margin],
        i: int,
        interval: rv.Interval,
        *,
        can_be_unborn: bool,
    ) -> Margin:
        """See `Operators`."""
        kept = [left(k).ranges[Truth.TRUE] for k in range(i + 1)]
        ways = [
            least([right(j).ranges[Truth.FALSE], *kept[j + 1 :]]) for j in self._window(i, interval)
        ]
        if self._reaches_out(i, interval):
            ways.append(least([ANY, *kept]))
        states = {right(k).state for k in self._window(i, interval)}
        return _of_window(most(ways), states, can_be_unborn)

    def held(
        self, operand: At[Margin], i: int, interval: rv.Interval, *, can_be_unborn: bool
    ) -> Margin:
        """See `Operators`."""
        lasted = OF_TRUTH[self._lasted(i, interval.high or 0)]
        rest = ANY if self._reaches_out(i, interval) else TOP
        values = [operand(k) for k in self._window(i, interval)]
        value = least([lasted, rest, *(value.ranges[Truth.FALSE] for value in values)])
        return _of_window(value, {value.state for value in values}, can_be_unborn)

    def _reaches_out(self, i: int, window: rv.Interval) -> bool:
        """Whether a window of the past extends before the first certain position."""
        if self._first == 0:
            return False
        outside = self._letters[i].instant - self._letters[self._first - 1].instant
        return window.high is None or outside <= window.high


def _always(value: Range, state: Truth = Truth.UNKNOWN) -> Margin:
    """A range that is the same however UNBORN is read."""
    return Margin(state, (value, value, value))


def _is_unborn(left: Margin, right: Margin) -> bool:
    """Whether one of two operands is unborn, and neither is UNKNOWN."""
    states = left.state, right.state
    return Truth.UNBORN in states and Truth.UNKNOWN not in states


def _unless_unborn(value: Range, state: Truth) -> Margin:
    """A range, raised to the ranges of UNBORN if the state is UNBORN."""
    if state is not Truth.UNBORN:
        return _always(value, state)
    of_false, unknown, of_true = (most([value, unborn]) for unborn in AS_UNBORN)
    return Margin(state, (of_false, unknown, of_true))


def _of_window(value: Range, states: Set[Truth], can_be_unborn: bool) -> Margin:
    """A range, raised if the sought operand is or may be unborn throughout the window."""
    if can_be_unborn and Truth.UNKNOWN in states and not states & {Truth.TRUE, Truth.FALSE}:
        return _always(most([value, ANY]))
    return _unless_unborn(value, Truth.UNBORN if states == {Truth.UNBORN} else Truth.UNKNOWN)


def _compared(comparison: rv.Compare, letter: Letter, captured: Mapping[str, Scalar]) -> Range:
    events = events_of(comparison.left, comparison.right)
    ways = []
    for choice in product(*(letter.events[event].occurrences for event in events)):
        payloads = {e: o.payload for e, o in zip(events, choice, strict=True)}
        occur = [OF_TRUTH[occurrence.truth] for occurrence in choice]
        ways.append(least([*occur, _distance(comparison, letter, payloads, captured)]))
    return most(ways)


def _distance(
    comparison: rv.Compare,
    letter: Letter,
    payloads: Mapping[str, Payload],
    captured: Mapping[str, Scalar],
) -> Range:
    left = number(comparison.left, letter, payloads, captured)
    right = number(comparison.right, letter, payloads, captured)
    if left is None or right is None:
        return ANY
    op = comparison.op
    if isinstance(left, str) or isinstance(right, str):
        return TOP if (left == right) is (op is rv.CompareOp.EQ) else BOTTOM
    apart = 0.0 if left == right else float(left - right)
    value = {
        rv.CompareOp.LT: 0.0 - apart,  # avoids -0.0
        rv.CompareOp.LE: 0.0 - apart,
        rv.CompareOp.GT: apart,
        rv.CompareOp.GE: apart,
        rv.CompareOp.EQ: 0.0 - abs(apart),
        rv.CompareOp.NE: abs(apart),
    }[op]
    return value, value
