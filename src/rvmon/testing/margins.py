"""The robustness of attempts, straight from its definition: the oracle of the quantitative engine.

Every position is explicit and every operator a minimum of maxima over positions. Unknown input and
what lies behind the end may be anything: each figure is an interval.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from itertools import product
from typing import assert_never

from rvmon.spec.checked import (
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    Formula,
    Interval,
    Mode,
    Requirement,
    Unary,
    UnaryOp,
)
from rvmon.testing.attempts import Start, is_upon_end, starts
from rvmon.testing.case import Case
from rvmon.testing.kleene import Truth
from rvmon.testing.numbers import events_of, number
from rvmon.testing.truths import EVER, Truths
from rvmon.testing.word import Letter, Word
from rvmon.testing.wording import word_of
from rvmon.trace.sample import Payload, Scalar

Range = tuple[float, float]
"""Least and greatest value."""

TOP: Range = (math.inf, math.inf)
BOTTOM: Range = (-math.inf, -math.inf)
ANY: Range = (-math.inf, math.inf)
OF_TRUTH = {Truth.FALSE: BOTTOM, Truth.UNKNOWN: ANY, Truth.TRUE: TOP}


def margins(case: Case) -> dict[tuple[str, int], tuple[float, float, float]]:
    """The robustness of each attempt, by requirement and number.

    Returns:
        The least it can be, the greatest, and the least if all is well behind the end that has
        begun and only has to be kept up.

    Source: SEMANTICS, sections 2, 3 and 5.
    """
    spec = case.spec
    word = word_of(spec, case.samples, end=case.end, advances=case.advances, names=case.names)
    found = {}
    for requirement in spec.requirements.values():
        for count, start in enumerate(starts(requirement, word), start=1):
            low, high = _owed(requirement, start, _Ranges(start.word, start.captured, kept=False))
            kept, _ = _owed(requirement, start, _Ranges(start.word, start.captured, kept=True))
            found[requirement.id, count] = (low, high, kept)
    return found


def _owed(requirement: Requirement, start: Start, ranges: _Ranges) -> Range:
    consequent = requirement.consequent
    if requirement.mode is Mode.UPON or is_upon_end(requirement):
        return ranges.range(consequent, start.position)
    last = len(start.word.letters) if start.stop is None else start.stop
    owed = [
        _most(
            [
                _negated(ranges.range(requirement.trigger, k, positive=False)),
                ranges.range(consequent, k),
            ]
        )
        for k in range(start.position, last)
    ]
    return _least([*owed, TOP if start.stop is not None else ranges.rest_of_release(True)])


class _Ranges:
    def __init__(self, word: Word, captured: Mapping[str, Scalar], *, kept: bool) -> None:
        self.letters = word.letters
        self.end = word.end
        self.reached = word.reached
        self.captured = captured
        self.kept = kept
        self.truths = Truths(word, captured)
        self.known: dict[tuple[int, int, bool], Range] = {}

    def range(self, formula: Formula, i: int, *, positive: bool = True) -> Range:
        key = (id(formula), i, positive)
        if key not in self.known:
            self.known[key] = self._range(formula, i, positive)
        return self.known[key]

    def rest_of_release(self, opened: bool) -> Range:
        """Behind the end, of an unbounded `R`."""
        return TOP if self.kept and opened else ANY

    def _range(self, formula: Formula, i: int, positive: bool) -> Range:
        match formula:
            case Unary():
                return self._unary(formula, i, positive)
            case Binary():
                return self._binary(formula, i, positive)
            case Compare():
                return self._compare(formula, self.letters[i])
            case _:
                return OF_TRUTH[self.truths.truth(formula, i)]

    def _unary(self, formula: Unary, i: int, positive: bool) -> Range:
        window = formula.interval or EVER

        def operand(k: int) -> Range:
            return self.range(formula.operand, k, positive=positive)

        def opposite(k: int) -> Range:
            return _negated(self.range(formula.operand, k, positive=not positive))

        match formula.op:
            case UnaryOp.NOT:
                return opposite(i)
            case UnaryOp.NEXT:
                return operand(i + 1) if i + 1 < len(self.letters) else ANY
            case UnaryOp.EVENTUALLY:
                return self._until(_always(TOP), operand, i, window, positive)
            case UnaryOp.ALWAYS:
                return self._release(_always(BOTTOM), operand, i, window, positive)
            case UnaryOp.PREVIOUS:
                return operand(i - 1) if i else BOTTOM
            case UnaryOp.ONCE:
                return self._since(_always(TOP), operand, i, window)
            case UnaryOp.HISTORICALLY:
                return _negated(self._since(_always(TOP), _not(operand), i, window))
            case UnaryOp.HELD:
                begun = self.letters[i].instant - self.letters[0].instant >= (window.high or 0)
                whole = _negated(self._since(_always(TOP), _not(operand), i, window))
                return _least([TOP if begun else BOTTOM, whole])
            case UnaryOp.RISE:
                return _least([operand(i), opposite(i - 1) if i else TOP])
            case UnaryOp.FALL:
                return _least([opposite(i), operand(i - 1) if i else BOTTOM])
            case _:
                assert_never(formula.op)

    def _binary(self, formula: Binary, i: int, positive: bool) -> Range:
        window = formula.interval or EVER

        def left(k: int) -> Range:
            return self.range(formula.left, k, positive=positive)

        def right(k: int) -> Range:
            return self.range(formula.right, k, positive=positive)

        def not_left(k: int) -> Range:
            return _negated(self.range(formula.left, k, positive=not positive))

        def not_right(k: int) -> Range:
            return _negated(self.range(formula.right, k, positive=not positive))

        def either(k: int) -> Range:
            return _most([left(k), right(k)])

        def both(k: int) -> Range:
            return _least([left(k), right(k)])

        match formula.op:
            case BinaryOp.AND:
                return both(i)
            case BinaryOp.OR:
                return either(i)
            case BinaryOp.IMPLIES:
                return _most([not_left(i), right(i)])
            case BinaryOp.IFF if positive:
                return _most([both(i), _least([not_left(i), not_right(i)])])
            case BinaryOp.XOR if positive:
                return _most([_least([left(i), not_right(i)]), _least([not_left(i), right(i)])])
            case BinaryOp.IFF:
                return _least([_most([not_left(i), right(i)]), _most([left(i), not_right(i)])])
            case BinaryOp.XOR:
                return _least([either(i), _most([not_left(i), not_right(i)])])
            case BinaryOp.UNTIL:
                return self._until(left, right, i, window, positive)
            case BinaryOp.RELEASE:
                return self._release(left, right, i, window, positive)
            case BinaryOp.WEAK_UNTIL:
                return self._release(right, either, i, window, positive)
            case BinaryOp.STRONG_RELEASE:
                return self._until(right, both, i, window, positive)
            case BinaryOp.SINCE:
                return self._since(left, right, i, window)
            case _:
                assert_never(formula.op)

    def _until(
        self, left: Operand, right: Operand, i: int, window: Interval, positive: bool
    ) -> Range:
        rest = ANY if positive else _negated(self._rest(i, window))
        return self._some(left, right, i, window, rest)

    def _release(
        self, left: Operand, right: Operand, i: int, window: Interval, positive: bool
    ) -> Range:
        rest = _negated(self._rest(i, window)) if positive else ANY
        return _negated(self._some(_not(left), _not(right), i, window, rest))

    def _rest(self, i: int, window: Interval) -> Range:
        opens = self.letters[i].instant + window.low
        return self.rest_of_release(
            window.high is None and self.end is not None and opens <= self.end
        )

    def _some(self, left: Operand, right: Operand, i: int, window: Interval, rest: Range) -> Range:
        now = self.letters[i].instant
        ways = [
            _least([right(j), *(left(k) for k in range(i, j))])
            for j in range(i, len(self.letters))
            if _within(self.letters[j].instant - now, window)
        ]
        if window.high is None or self.reached <= now + window.high:
            ways.append(_least([rest, *(left(k) for k in range(i, len(self.letters)))]))
        return _most(ways)

    def _since(self, left: Operand, right: Operand, i: int, window: Interval) -> Range:
        now = self.letters[i].instant
        return _most(
            _least([right(j), *(left(k) for k in range(j + 1, i + 1))])
            for j in range(i + 1)
            if _within(now - self.letters[j].instant, window)
        )

    def _compare(self, comparison: Compare, letter: Letter) -> Range:
        events = sorted({*events_of(comparison.left), *events_of(comparison.right)})
        ways = []
        for choice in product(*(letter.events[event].occurrences for event in events)):
            payloads = {e: o.payload for e, o in zip(events, choice, strict=True)}
            occur = [OF_TRUTH[occurrence.truth] for occurrence in choice]
            ways.append(_least([*occur, self._distance(comparison, letter, payloads)]))
        return _most(ways)

    def _distance(
        self, comparison: Compare, letter: Letter, payloads: Mapping[str, Payload]
    ) -> Range:
        left = number(comparison.left, letter, payloads, self.captured)
        right = number(comparison.right, letter, payloads, self.captured)
        if left is None or right is None:
            return ANY
        op = comparison.op
        if isinstance(left, str) or isinstance(right, str):
            return TOP if (left == right) is (op is CompareOp.EQ) else BOTTOM
        apart = 0.0 if left == right else float(left - right)
        value = {
            CompareOp.LT: -apart,
            CompareOp.LE: -apart,
            CompareOp.GT: apart,
            CompareOp.GE: apart,
            CompareOp.EQ: -abs(apart),
            CompareOp.NE: abs(apart),
        }[op]
        return value, value


Operand = Callable[[int], Range]


def _always(value: Range) -> Operand:
    return lambda _: value


def _not(operand: Operand) -> Operand:
    return lambda k: _negated(operand(k))


def _negated(value: Range) -> Range:
    return -value[1], -value[0]


def _least(values: Iterable[Range]) -> Range:
    lows, highs = zip(TOP, *values, strict=True)
    return min(lows), min(highs)


def _most(values: Iterable[Range]) -> Range:
    lows, highs = zip(BOTTOM, *values, strict=True)
    return max(lows), max(highs)


def _within(distance: int, window: Interval) -> bool:
    return window.low <= distance and (window.high is None or distance <= window.high)
