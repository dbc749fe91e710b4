"""Random formulas of future operators over the Boolean signals of the test vocabulary."""

from __future__ import annotations

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Formula,
    Interval,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.testing.dice import Dice, chance, pick
from rvmon.testing.vocabulary import BOOLS

_EVER = Interval(0, None)
_UNARY = (UnaryOp.NOT, UnaryOp.NEXT, UnaryOp.EVENTUALLY, UnaryOp.ALWAYS)
_BINARY = (
    BinaryOp.AND,
    BinaryOp.OR,
    BinaryOp.IMPLIES,
    BinaryOp.IFF,
    BinaryOp.XOR,
    BinaryOp.UNTIL,
    BinaryOp.RELEASE,
    BinaryOp.WEAK_UNTIL,
    BinaryOp.STRONG_RELEASE,
)
_TIMED = (*_BINARY[5:], UnaryOp.EVENTUALLY, UnaryOp.ALWAYS)


_FROM_ZERO = (BinaryOp.WEAK_UNTIL, BinaryOp.STRONG_RELEASE)
_LONGEST = 3


def random_ltl(dice: Dice, depth: int) -> Formula:
    """A random untimed formula of future operators, at most `depth` of them nested."""
    if depth == 0 or chance(dice, 8):
        return SignalAtom(pick(dice, BOOLS))
    if chance(dice, 45):
        unary = pick(dice, _UNARY)
        window = _EVER if unary in _TIMED else None
        return Unary(unary, random_ltl(dice, depth - 1), window)
    binary = pick(dice, _BINARY)
    window = _EVER if binary in _TIMED else None
    left = random_ltl(dice, dice.randint(0, depth - 1))
    return Binary(binary, left, random_ltl(dice, depth - 1), window)


def random_mtl(dice: Dice, depth: int) -> Formula:
    """A random formula of future operators with windows of a few ticks, without `X`."""
    if depth == 0 or chance(dice, 8):
        return SignalAtom(pick(dice, BOOLS))
    if chance(dice, 45):
        unary = pick(dice, (UnaryOp.NOT, UnaryOp.EVENTUALLY, UnaryOp.ALWAYS))
        window = _window(dice) if unary in _TIMED else None
        return Unary(unary, random_mtl(dice, depth - 1), window)
    binary = pick(dice, _BINARY)
    window = _window(dice, from_zero=binary in _FROM_ZERO) if binary in _TIMED else None
    left = random_mtl(dice, dice.randint(0, depth - 1))
    return Binary(binary, left, random_mtl(dice, depth - 1), window)


def _window(dice: Dice, *, from_zero: bool = False) -> Interval:
    low = 0 if from_zero or chance(dice, 60) else dice.randint(1, _LONGEST)
    if chance(dice, 20):
        return Interval(low, None)
    return Interval(low, dice.randint(max(low, 1), _LONGEST))
