"""Random formulas over a small vocabulary."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from rvmon.language.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Constant,
    EventAtom,
    Formula,
    Interval,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.operators import Tense, Window
from rvmon.testing.generate import (
    BOOLS,
    CARRIER,
    EVENTS,
    FURTHER,
    Rng,
    chance,
    drawn,
    pick,
    weighted,
)
from rvmon.testing.generate.numbers import (
    Shape,
    amount,
    comparison,
    late,
    probe,
)


def interval(rng: Rng, shape: Shape, *, from_zero: bool = False) -> Interval:
    """A random interval: bounded or unbounded, from zero or later, a single tick or longer."""
    low = 0 if from_zero or chance(rng, 55) else rng.randint(1, shape.longest // 2)
    if chance(rng, 25):
        return Interval(low, None)
    if chance(rng, 20):
        return Interval(low, low)
    return Interval(low, rng.randint(max(low, 1), shape.longest))


def atom(rng: Rng, shape: Shape) -> Formula:
    """A random proposition."""
    compares = (60 if shape.wide else 18) if shape.numbers else 0
    return drawn(
        rng,
        (50, lambda: SignalAtom(pick(rng, BOOLS))),
        (22 if shape.events else 0, lambda: EventAtom(pick(rng, (*EVENTS, CARRIER, FURTHER)))),
        (compares, lambda: comparison(rng, shape)),
        (6 if shape.numbers else 0, lambda: probe(rng, shape)),
        (shape.constants, lambda: Constant(chance(rng, 50))),
        (2, lambda: BoundAtom(Bound.START)),
    )


_LIKELY: dict[UnaryOp | BinaryOp, int] = {
    BinaryOp.AND: 6,
    BinaryOp.OR: 6,
    BinaryOp.IFF: 1,
    BinaryOp.XOR: 1,
    BinaryOp.UNTIL: 4,
    BinaryOp.IMPLIES: 3,
    UnaryOp.EVENTUALLY: 3,
    UnaryOp.ALWAYS: 3,
    UnaryOp.ONCE: 3,
    UnaryOp.HISTORICALLY: 3,
}
"""The weight of an operator among those of its kind; default 2."""

_STEPS = (UnaryOp.NOT, UnaryOp.NEXT, UnaryOp.PREVIOUS)


def _unary_of(tense: Tense) -> tuple[tuple[int, UnaryOp], ...]:
    found = (op for op in UnaryOp if op.entry.tense is tense and op not in _STEPS)
    return tuple((_LIKELY.get(op, 2), op) for op in found)


def consequent(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random formula, mostly with a future operator at its top."""
    if shape.future and chance(rng, 50):
        if chance(rng, 50):
            return _future_unary(rng, shape, depth)
        return _binary(rng, shape, depth, Tense.FUTURE)
    return formula(rng, shape, depth)


def formula(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random formula whose operators nest at most `depth` deep."""
    if depth == 0:
        return atom(rng, shape)
    below = shape if shape.mixed else replace(shape, future=False)
    future, past, step = int(shape.future), int(shape.past), int(shape.step)
    return drawn(
        rng,
        (8, lambda: atom(rng, shape)),
        (12, lambda: Unary(UnaryOp.NOT, formula(rng, shape, depth - 1))),
        (26, lambda: _binary(rng, shape, depth, Tense.PRESENT)),
        (24 * future, lambda: _future_unary(rng, shape, depth)),
        (18 * future, lambda: _binary(rng, shape, depth, Tense.FUTURE)),
        (8 * future * step, lambda: Unary(UnaryOp.NEXT, formula(rng, shape, depth - 1))),
        (17 * past, lambda: past_unary(rng, below, depth)),
        (6 * past, lambda: _binary(rng, below, depth, Tense.PAST)),
        (4 * past * step, lambda: Unary(UnaryOp.PREVIOUS, formula(rng, below, depth - 1))),
        (shape.amounts * past, lambda: _measured(rng, shape, depth)),
    )


def _measured(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A measure of a window, or of the time since an instant."""
    if shape.numbers and not shape.wide and not shape.form and chance(rng, 20):
        return late(rng, shape)
    return amount(rng, shape, partial(_below, depth - 1))


def _below(depth: int, rng: Rng, shape: Shape) -> Formula:
    return formula(rng, shape, depth)


def _future_unary(rng: Rng, shape: Shape, depth: int) -> Formula:
    op = weighted(rng, _unary_of(Tense.FUTURE))
    window = interval(rng, shape)
    return Unary(op, formula(rng, shape, depth - 1), window)


def _binary(rng: Rng, shape: Shape, depth: int, tense: Tense) -> Formula:
    ops = tuple((_LIKELY.get(op, 2), op) for op in BinaryOp if op.entry.tense is tense)
    op = weighted(rng, ops) if len(ops) > 1 else ops[0][1]
    window = None
    if op.entry.window is not Window.NONE:
        window = interval(rng, shape, from_zero=op.entry.window is Window.FROM_NOW)
    left = formula(rng, shape, rng.randint(0, depth - 1))
    return Binary(op, left, formula(rng, shape, depth - 1), window)


def past_unary(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random unary past operator over a formula of depth `depth - 1`."""
    op = weighted(rng, _unary_of(Tense.PAST))
    operand = formula(rng, shape, depth - 1)
    match op.entry.window:
        case Window.LENGTH:
            return Unary(op, operand, Interval(0, rng.randint(0, shape.longest)))
        case Window.NONE:
            return Unary(op, operand)
        case _:
            return Unary(op, operand, interval(rng, shape))
