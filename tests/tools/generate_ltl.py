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
from rvmon.testing.generate import BOOLS, Rng, chance, pick

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


def random_ltl(rng: Rng, depth: int) -> Formula:
    """A random untimed formula of future operators, at most `depth` of them nested."""
    if depth == 0 or chance(rng, 8):
        return SignalAtom(pick(rng, BOOLS))
    if chance(rng, 45):
        unary = pick(rng, _UNARY)
        window = _EVER if unary in _TIMED else None
        return Unary(unary, random_ltl(rng, depth - 1), window)
    binary = pick(rng, _BINARY)
    window = _EVER if binary in _TIMED else None
    left = random_ltl(rng, rng.randint(0, depth - 1))
    return Binary(binary, left, random_ltl(rng, depth - 1), window)


def random_mtl(rng: Rng, depth: int) -> Formula:
    """A random formula of future operators with windows of a few ticks, without `X`."""
    if depth == 0 or chance(rng, 8):
        return SignalAtom(pick(rng, BOOLS))
    if chance(rng, 45):
        unary = pick(rng, (UnaryOp.NOT, UnaryOp.EVENTUALLY, UnaryOp.ALWAYS))
        window = _window(rng) if unary in _TIMED else None
        return Unary(unary, random_mtl(rng, depth - 1), window)
    binary = pick(rng, _BINARY)
    window = _window(rng, from_zero=binary in _FROM_ZERO) if binary in _TIMED else None
    left = random_mtl(rng, rng.randint(0, depth - 1))
    return Binary(binary, left, random_mtl(rng, depth - 1), window)


def _window(rng: Rng, *, from_zero: bool = False) -> Interval:
    low = 0 if from_zero or chance(rng, 60) else rng.randint(1, _LONGEST)
    if chance(rng, 20):
        return Interval(low, None)
    return Interval(low, rng.randint(max(low, 1), _LONGEST))
