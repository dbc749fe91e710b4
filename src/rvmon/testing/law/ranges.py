"""The robustness of formulas of the present and past as intervals, from its definition."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.language.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    Formula,
    Interval,
    Unary,
    UnaryOp,
    windows_in,
)
from rvmon.testing.law.numbers import events_of, number
from rvmon.testing.law.past import is_within, lasted
from rvmon.testing.law.truths import EVER, Truths
from rvmon.testing.law.word import Letter, Truth, Word, conjunction, negation
from rvmon.trace.sample import Payload, Scalar

Range = tuple[float, float]
"""Least and greatest value."""

TOP: Range = (math.inf, math.inf)
BOTTOM: Range = (-math.inf, -math.inf)
ANY: Range = (-math.inf, math.inf)
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
class Operand:
    """A formula at a position.

    Attributes:
        state: its truth, UNBORN included.
        read: gives its robustness; the argument is the truth that UNBORN is read as.
    """

    state: Truth
    read: Callable[[Truth], Range]


class Past:
    """The robustness of formulas of the present and past at the positions of a word.

    Args:
        word: the trace.
        captured: values of `let` and `for each`.
        first: the first sure position; before it, letters may be anything; 0: nothing is before it.
        held: whether time is held: then measures that change between samples have no distance.

    Source: SEMANTICS, sections 1 (Birth), 2 and 5; decision record 4.
    """

    def __init__(
        self, word: Word, captured: Mapping[str, Scalar], first: int, *, held: bool
    ) -> None:
        self._letters = word.letters
        self._held_time = held
        self._first = first
        self._captured = captured
        self._truths = Truths(word, captured)
        self._known: dict[tuple[int, int, Truth], Range] = {}

    def range(self, formula: Formula, i: int, unborn: Truth) -> Range:
        """The robustness at a position; UNBORN is read as `unborn`."""
        key = (id(formula), i, unborn)
        if key not in self._known:
            self._known[key] = self._range(formula, i, unborn)
        return self._known[key]

    def _operand(self, formula: Formula, i: int) -> Operand:
        return Operand(
            self._truths.state(formula, i), lambda unborn: self.range(formula, i, unborn)
        )

    def _range(self, formula: Formula, i: int, unborn: Truth) -> Range:
        state = self._truths.state(formula, i)
        match formula:
            case Unary():
                return self._unary(formula, i, unborn)
            case Binary():
                return self._binary(formula, i, unborn)
            case _ if state is Truth.UNBORN:
                return OF_TRUTH[unborn]
            case Amount() if formula.has_distance(held=self._held_time):
                return self._of_windows(formula.comparison, i)
            case Compare(left=left, right=right) if windows_in(left, right):
                return self._of_windows(formula, i)
            case Compare():
                return _compared(formula, self._letters[i], self._captured)
            case _:
                return OF_TRUTH[state]

    def _of_windows(self, formula: Compare, i: int) -> Range:
        left, right = (self._truths.settled(side, i) for side in (formula.left, formula.right))
        settled = Compare(formula.op, left, right)
        return _compared(settled, self._letters[i], self._captured)

    def _unary(self, formula: Unary, i: int, unborn: Truth) -> Range:
        operand, window = formula.operand, formula.interval or EVER
        here = self._operand(operand, i)
        is_unborn = self._truths.state(formula, i) is Truth.UNBORN
        match formula.op:
            case UnaryOp.NOT:
                return _not(here).read(unborn)
            case UnaryOp.PREVIOUS:
                return self._before(operand, i).read(unborn)
            case UnaryOp.RISE:
                return _all([here, _not(_settled(self._before(operand, i)))]).read(unborn)
            case UnaryOp.FALL:
                return _all([_not(here), _settled(self._before(operand, i))]).read(unborn)
            case UnaryOp.ONCE:
                value = self._since(None, self._candidate(operand), i, window)
                return _or_unborn(value, is_unborn, unborn)
            case UnaryOp.HISTORICALLY:
                value = self._since(None, self._candidate(operand, positive=False), i, window)
                return negated(_or_unborn(value, is_unborn, negation(unborn)))
            case UnaryOp.HELD:
                return self._held(operand, i, window, unborn)
            case _:
                raise AssertionError("a future operator is no proposition")

    def _binary(self, formula: Binary, i: int, unborn: Truth) -> Range:
        left, right = self._operand(formula.left, i), self._operand(formula.right, i)
        match formula.op:
            case BinaryOp.AND:
                return _all([left, right]).read(unborn)
            case BinaryOp.OR:
                return _any([left, right]).read(unborn)
            case BinaryOp.IMPLIES:
                return _any([_not(left), right]).read(unborn)
            case BinaryOp.IFF:
                same = [_all([left, right]), _all([_not(left), _not(right)])]
                return _any(same).read(unborn)
            case BinaryOp.XOR:
                other = [_all([left, _not(right)]), _all([_not(left), right])]
                return _any(other).read(unborn)
            case BinaryOp.SINCE:
                window = formula.interval or EVER
                value = self._since(formula.left, self._candidate(formula.right), i, window)
                return self._unless_unborn(value, formula.right, i, window, unborn)
            case _:
                raise AssertionError("a future operator is no proposition")

    def _candidate(self, formula: Formula, *, positive: bool = True) -> Callable[[int], Range]:
        """The robustness of the operand sought in a window, which UNBORN does not satisfy."""
        if positive:
            return lambda k: self.range(formula, k, Truth.FALSE)
        return lambda k: negated(self.range(formula, k, Truth.TRUE))

    def _since(
        self, left: Formula | None, right: Callable[[int], Range], i: int, window: Interval
    ) -> Range:
        """The robustness of `since`; positions at which `left` is unborn are skipped."""
        now = self._letters[i].instant
        own = range(self._first, i + 1)
        kept = [TOP if left is None else self.range(left, k, Truth.TRUE) for k in own]
        ways = [
            least([right(j), *kept[j + 1 - self._first :]])
            for j in own
            if is_within(now - self._letters[j].instant, window)
        ]
        if self.reaches_out(i, window):
            ways.append(least([ANY, *kept]))
        return most(ways)

    def reaches_out(self, i: int, window: Interval) -> bool:
        """Whether a window of the past extends before the first sure position."""
        if self._first == 0:
            return False
        outside = self._letters[i].instant - self._letters[self._first - 1].instant
        return window.high is None or outside <= window.high

    def _before(self, operand: Formula, i: int) -> Operand:
        if i == 0:
            return Operand(Truth.FALSE, lambda _: BOTTOM)
        state = self._truths.state(operand, i - 1)
        value = ANY if i == self._first else self.range(operand, i - 1, Truth.FALSE)
        return Operand(state, lambda unborn: _or_unborn(value, state is Truth.UNBORN, unborn))

    def _held(self, operand: Formula, i: int, window: Interval, unborn: Truth) -> Range:
        now = self._letters[i].instant
        own = range(self._first, i + 1)
        inside = [k for k in own if is_within(now - self._letters[k].instant, window)]
        begun = OF_TRUTH[lasted(self._letters, i, window.high or 0)]
        rest = ANY if self.reaches_out(i, window) else TOP
        value = least([begun, rest, *(self.range(operand, k, Truth.FALSE) for k in inside)])
        return self._unless_unborn(value, operand, i, window, unborn)

    def _unless_unborn(
        self, value: Range, sought: Formula, i: int, window: Interval, unborn: Truth
    ) -> Range:
        """`value`, or that of UNBORN if the sought operand may be unborn throughout the window."""
        now = self._letters[i].instant
        states = {
            self._truths.state(sought, k)
            for k in range(i + 1)
            if is_within(now - self._letters[k].instant, window)
        }
        if Truth.UNKNOWN in states and not states & {Truth.TRUE, Truth.FALSE}:
            return most([value, ANY])
        return _or_unborn(value, states == {Truth.UNBORN}, unborn)


def _or_unborn(value: Range, is_unborn: bool, unborn: Truth) -> Range:
    """A range, raised to that of `unborn` if the formula is unborn."""
    return most([value, OF_TRUTH[unborn]]) if is_unborn else value


def _settled(operand: Operand) -> Operand:
    """The operand with UNBORN read as FALSE, as before the beginning of the trace."""
    state = Truth.FALSE if operand.state is Truth.UNBORN else operand.state
    return Operand(state, lambda _: operand.read(Truth.FALSE))


def _not(operand: Operand) -> Operand:
    return Operand(negation(operand.state), lambda unborn: negated(operand.read(negation(unborn))))


def _any(parts: Sequence[Operand]) -> Operand:
    return _not(_all([_not(part) for part in parts]))


def _all(parts: Sequence[Operand]) -> Operand:
    """The conjunction of parts; next to an UNKNOWN part, unborn ones do not make it FALSE."""
    states = {part.state for part in parts}

    def read(unborn: Truth) -> Range:
        if unborn is not Truth.FALSE:
            return least(part.read(unborn) for part in parts)
        if Truth.UNBORN in states and Truth.UNKNOWN not in states:
            return BOTTOM
        return least(part.read(Truth.UNKNOWN) for part in parts)

    return Operand(conjunction(states), read)


def _compared(comparison: Compare, letter: Letter, captured: Mapping[str, Scalar]) -> Range:
    events = sorted({*events_of(comparison.left), *events_of(comparison.right)})
    ways = []
    for choice in product(*(letter.events[event].occurrences for event in events)):
        payloads = {e: o.payload for e, o in zip(events, choice, strict=True)}
        occur = [OF_TRUTH[occurrence.truth] for occurrence in choice]
        ways.append(least([*occur, _distance(comparison, letter, payloads, captured)]))
    return most(ways)


def _distance(
    comparison: Compare,
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
        return TOP if (left == right) is (op is CompareOp.EQ) else BOTTOM
    apart = 0.0 if left == right else float(left - right)
    value = {
        CompareOp.LT: 0.0 - apart,  # avoids -0.0
        CompareOp.LE: 0.0 - apart,
        CompareOp.GT: apart,
        CompareOp.GE: apart,
        CompareOp.EQ: 0.0 - abs(apart),
        CompareOp.NE: abs(apart),
    }[op]
    return value, value
