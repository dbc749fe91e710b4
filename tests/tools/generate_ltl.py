"""Random formulas of future operators over the Boolean signals of the test vocabulary."""

from __future__ import annotations

from collections.abc import Callable, Sequence

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
    return _formula(rng, depth, _UNARY, lambda _: _EVER)


def random_mtl(rng: Rng, depth: int) -> Formula:
    """A random formula of future operators with windows of a few ticks, without `X`."""
    unary = tuple(op for op in _UNARY if op is not UnaryOp.NEXT)
    return _formula(rng, depth, unary, lambda op: _window(rng, from_zero=op in _FROM_ZERO))


def _formula(
    rng: Rng, depth: int, unary: Sequence[UnaryOp], window: Callable[[UnaryOp | BinaryOp], Interval]
) -> Formula:
    if depth == 0 or chance(rng, 8):
        return SignalAtom(pick(rng, BOOLS))
    if chance(rng, 45):
        op = pick(rng, unary)
        interval = window(op) if op in _TIMED else None
        return Unary(op, _formula(rng, depth - 1, unary, window), interval)
    binary = pick(rng, _BINARY)
    interval = window(binary) if binary in _TIMED else None
    left = _formula(rng, rng.randint(0, depth - 1), unary, window)
    return Binary(binary, left, _formula(rng, depth - 1, unary, window), interval)


def _window(rng: Rng, *, from_zero: bool) -> Interval:
    low = 0 if from_zero or chance(rng, 60) else rng.randint(1, _LONGEST)
    if chance(rng, 20):
        return Interval(low, None)
    return Interval(low, rng.randint(max(low, 1), _LONGEST))
