"""The operators of the past, from the truth of their operands at the positions so far."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction

from rvmon.spec.checked.formula import Amount, Formula, Interval, Measured
from rvmon.testing.law.syntax import constant_value
from rvmon.testing.law.word import (
    Letter,
    Truth,
    born_or_false,
    born_or_true,
    both,
    conjunction,
    disjunction,
    either,
    negation,
    truth_of,
)
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TICKS_PER_SECOND

Operand = Callable[[int], Truth]
"""The truth of an operand at a position."""


def always_true(_: int) -> Truth:
    """TRUE at each position."""
    return Truth.TRUE


def always_false(_: int) -> Truth:
    """FALSE at each position."""
    return Truth.FALSE


def unless_constant(part: Formula, operand: Operand, value: Truth) -> Operand:
    """What has to last up to some position; if it is sure anyway, it asks for no position.

    So `true U φ` is `F φ` where there may be positions, too: where every formula is unknown.
    """
    return (lambda _: value) if constant_value(part) is value else operand


def inverted(operand: Operand) -> Operand:
    """The negation of an operand."""
    return lambda k: negation(operand(k))


def is_within(distance: int, interval: Interval) -> bool:
    """Whether a distance in ticks lies in an interval."""
    return interval.low <= distance and (interval.high is None or distance <= interval.high)


def since(
    letters: Sequence[Letter],
    left: Operand,
    right: Operand,
    i: int,
    interval: Interval,
    *,
    mortal: bool = False,
) -> Truth:
    """Some position of the window had `right`, and all after it, up to `i`, have `left`.

    Positions at which an operand is not born are passed over; if `right` is at none of the
    window, the whole is not. If `mortal`, and it is nowhere TRUE or FALSE there, the whole
    is unknown, though `left` be FALSE: what an outage swallowed may not be born either.
    """
    shows_birth = {Truth.TRUE, Truth.FALSE} if mortal else {*Truth} - {Truth.UNBORN}
    now = letters[i].instant
    value, so_far = Truth.FALSE, Truth.TRUE
    seen: set[Truth] = set()
    for j in range(i, -1, -1):
        if is_within(now - letters[j].instant, interval):
            there = right(j)
            seen.add(there)
            if there is not Truth.UNBORN:
                value = either(value, both(so_far, there))
        so_far = both(so_far, born_or_true(left(j)))
        if value is Truth.TRUE or (so_far is Truth.FALSE and seen & shows_birth):
            return value
    return disjunction(seen) if seen and not seen & shows_birth else value


def historically(letters: Sequence[Letter], operand: Operand, i: int, interval: Interval) -> Truth:
    """All positions of the window had it."""
    return negation(since(letters, always_true, inverted(operand), i, interval))


def held(
    letters: Sequence[Letter], operand: Operand, i: int, interval: Interval, *, mortal: bool
) -> Truth:
    """All positions of the window had it, which has to lie behind its birth whole.

    What is unknown may not be born either: it shows nothing of where the birth was.
    """
    now = letters[i].instant
    window = [k for k in range(i + 1) if is_within(now - letters[k].instant, interval)]
    values = [operand(k) for k in window]
    if mortal and not {Truth.TRUE, Truth.FALSE}.intersection(values):
        return disjunction(values)
    long_enough = _lasted(letters, i, interval.high or 0)
    return conjunction([long_enough, *(born_or_false(value) for value in values)])


def amount(letters: Sequence[Letter], operand: Operand, i: int, formula: Amount) -> Truth:
    """So many positions of the window, or ticks between them, had it.

    A position lasts up to the next. What is not known may count, or not.
    """
    sure = possible = 0
    for k in range(i + 1):
        size = _size(letters, k, i, formula)
        there = operand(k)
        sure += size * (there is Truth.TRUE)
        possible += size * (there in (Truth.TRUE, Truth.UNKNOWN))
    if sure >= formula.least:
        return Truth.TRUE
    return Truth.UNKNOWN if possible >= formula.least else Truth.FALSE


def total(
    letters: Sequence[Letter],
    operand: Operand,
    value: Callable[[int], Scalar],
    limit: Scalar,
    i: int,
    formula: Amount,
) -> Truth:
    """The numbers of the window, added up exactly, beside a limit; unknown if one is.

    Args:
        letters: of the word.
        operand: where there is a number.
        value: it, at a position where there is.
        limit: of now.
        i: the position.
        formula: says what is measured.
    """
    if isinstance(limit, str) or limit is None or not math.isfinite(limit):
        return Truth.UNKNOWN
    found, count = Fraction(0), 0
    for k in range(i + 1):
        size = _size(letters, k, i, formula)
        there = operand(k) if size else Truth.FALSE
        if there in (Truth.FALSE, Truth.UNBORN):
            continue
        number = value(k) if there is Truth.TRUE else None
        if number is None or isinstance(number, str) or not math.isfinite(number):
            return Truth.UNKNOWN
        found += Fraction(number) * size
        count += size
    if formula.measured is Measured.MEAN and count == 0:
        return Truth.UNKNOWN
    times = {Measured.MEAN: count, Measured.INTEGRAL: TICKS_PER_SECOND}
    rest = found - Fraction(limit) * times.get(formula.measured, 1)
    return truth_of(rest > 0 if formula.strict else rest >= 0)


def _size(letters: Sequence[Letter], k: int, i: int, formula: Amount) -> int:
    """How many positions, or ticks, of the window of `i` a position stands for."""
    begin = letters[k].instant
    first = begin if formula.window is None else max(begin, letters[i].instant - formula.window)
    if formula.measured not in (Measured.DURATION, Measured.INTEGRAL):
        return int(begin == first)
    return max(0, letters[k + 1].instant - first) if k < i else 0


def _lasted(letters: Sequence[Letter], i: int, duration: int) -> Truth:
    """Whether the trace began so long before a position; it may have at any that may be there."""
    starts = [k for k in range(i + 1) if letters[i].instant - letters[k].instant >= duration]
    if any(letters[k].sure for k in starts):
        return Truth.TRUE
    return Truth.UNKNOWN if starts else Truth.FALSE
