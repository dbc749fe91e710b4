"""The past operators, evaluated from the truth of their operands at all positions so far."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.language.checked.formula import Formula, Interval
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
)

Operand = Callable[[int], Truth]
"""The truth of an operand at a position."""


def always_true(_: int) -> Truth:
    """TRUE at each position."""
    return Truth.TRUE


def always_false(_: int) -> Truth:
    """FALSE at each position."""
    return Truth.FALSE


def unless_constant(part: Formula, operand: Operand, value: Truth) -> Operand:
    """An operand that has to last up to some position; a constant lasts without any position.

    So `true U φ` equals `F φ` also across possible positions, at which every formula is unknown.
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
    can_be_unborn: bool = False,
) -> Truth:
    """Some position of the window had `right`, and all after it, up to `i`, have `left`.

    Positions at which an operand is unborn are skipped; if `right` is unborn throughout the window,
    so is the whole. If it can be unborn and is nowhere TRUE or FALSE there, the whole is UNKNOWN
    even where `left` is FALSE: a value lost in an outage may have been unborn, too.
    """
    shows_birth = {Truth.TRUE, Truth.FALSE} if can_be_unborn else {*Truth} - {Truth.UNBORN}
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
    """All positions of the window had the operand."""
    return negation(since(letters, always_true, inverted(operand), i, interval))


def held(
    letters: Sequence[Letter], operand: Operand, i: int, interval: Interval, *, can_be_unborn: bool
) -> Truth:
    """All positions of the window had the operand, and the whole window lies after its birth.

    Where the operand is UNKNOWN it may be unborn, so that shows no birth.
    """
    now = letters[i].instant
    window = [k for k in range(i + 1) if is_within(now - letters[k].instant, interval)]
    values = [operand(k) for k in window]
    if can_be_unborn and not {Truth.TRUE, Truth.FALSE}.intersection(values):
        return disjunction(values)
    long_enough = lasted(letters, i, interval.high or 0)
    return conjunction([long_enough, *(born_or_false(value) for value in values)])


def lasted(letters: Sequence[Letter], i: int, duration: int) -> Truth:
    """Whether the trace began at least so many ticks before a position."""
    starts = [k for k in range(i + 1) if letters[i].instant - letters[k].instant >= duration]
    if any(letters[k].sure for k in starts):
        return Truth.TRUE
    return Truth.UNKNOWN if starts else Truth.FALSE
