"""Random formulas over a small vocabulary."""

from __future__ import annotations

from dataclasses import replace

from rvmon.language.checked import formula as rv
from rvmon.language.checked.operators import Tense, Window
from rvmon.testing import generate as draw
from rvmon.testing.generate import numbers


def interval(rng: draw.Rng, shape: numbers.Shape, *, from_zero: bool = False) -> rv.Interval:
    """A random interval: bounded or unbounded, from zero or later, a single tick or longer."""
    low = 0 if from_zero or draw.chance(rng, 55) else rng.randint(1, shape.longest // 2)
    if draw.chance(rng, 25):
        return rv.Interval(low, None)
    if draw.chance(rng, 20):
        return rv.Interval(low, low)
    return rv.Interval(low, rng.randint(max(low, 1), shape.longest))


def atom(rng: draw.Rng, shape: numbers.Shape) -> rv.Formula:
    """A random proposition."""
    compares = (60 if shape.wide else 18) if shape.numbers else 0
    return draw.drawn(
        rng,
        (50, lambda: rv.SignalAtom(draw.pick(rng, draw.BOOLS))),
        (
            22 if shape.events else 0,
            lambda: rv.EventAtom(draw.pick(rng, (*draw.EVENTS, draw.CARRIER, draw.FURTHER))),
        ),
        (compares, lambda: numbers.comparison(rng, shape)),
        (6 if shape.numbers else 0, lambda: numbers.probe(rng, shape)),
        (shape.constants, lambda: rv.Constant(draw.chance(rng, 50))),
        (2, lambda: rv.BoundAtom(rv.Bound.START)),
    )


_LIKELY: dict[rv.UnaryOp | rv.BinaryOp, int] = {
    rv.BinaryOp.AND: 6, rv.BinaryOp.OR: 6, rv.BinaryOp.IFF: 1, rv.BinaryOp.XOR: 1,
    rv.BinaryOp.UNTIL: 4, rv.BinaryOp.IMPLIES: 3, rv.UnaryOp.EVENTUALLY: 3, rv.UnaryOp.ALWAYS: 3,
    rv.UnaryOp.ONCE: 3, rv.UnaryOp.HISTORICALLY: 3,
}  # fmt: skip
"""The weights of operators among those of their kind; default 2."""

_STEPS = (rv.UnaryOp.NOT, rv.UnaryOp.NEXT, rv.UnaryOp.PREVIOUS)


def _unary_of(tense: Tense) -> tuple[tuple[int, rv.UnaryOp], ...]:
    found = (op for op in rv.UnaryOp if op.entry.tense is tense and op not in _STEPS)
    return tuple((_LIKELY.get(op, 2), op) for op in found)


def consequent(rng: draw.Rng, shape: numbers.Shape, depth: int) -> rv.Formula:
    """A random formula, usually with a future operator at its top."""
    if shape.future and draw.chance(rng, 50):
        if draw.chance(rng, 50):
            return _future_unary(rng, shape, depth)
        return _binary(rng, shape, depth, Tense.FUTURE)
    return formula(rng, shape, depth)


def formula(rng: draw.Rng, shape: numbers.Shape, depth: int) -> rv.Formula:
    """A random formula whose operators nest at most `depth` deep."""
    if depth == 0:
        return atom(rng, shape)
    below = shape if shape.mixed else replace(shape, future=False)
    future, past, step = int(shape.future), int(shape.past), int(shape.step)
    return draw.drawn(
        rng,
        (8, lambda: atom(rng, shape)),
        (12, lambda: rv.Unary(rv.UnaryOp.NOT, formula(rng, shape, depth - 1))),
        (26, lambda: _binary(rng, shape, depth, Tense.PRESENT)),
        (24 * future, lambda: _future_unary(rng, shape, depth)),
        (18 * future, lambda: _binary(rng, shape, depth, Tense.FUTURE)),
        (8 * future * step, lambda: rv.Unary(rv.UnaryOp.NEXT, formula(rng, shape, depth - 1))),
        (17 * past, lambda: past_unary(rng, below, depth)),
        (6 * past, lambda: _binary(rng, below, depth, Tense.PAST)),
        (4 * past * step, lambda: rv.Unary(rv.UnaryOp.PREVIOUS, formula(rng, below, depth - 1))),
        (shape.amounts * past, lambda: _measured(rng, shape, depth)),
    )


def _measured(rng: draw.Rng, shape: numbers.Shape, depth: int) -> rv.Formula:
    """A measure of a window, or of the time since an instant."""
    if shape.numbers and not shape.wide and not shape.form and draw.chance(rng, 20):
        return numbers.late(rng, shape)
    return numbers.amount(rng, shape, lambda rng, below: formula(rng, below, depth - 1))


def _future_unary(rng: draw.Rng, shape: numbers.Shape, depth: int) -> rv.Formula:
    op = draw.weighted(rng, _unary_of(Tense.FUTURE))
    window = interval(rng, shape)
    return rv.Unary(op, formula(rng, shape, depth - 1), window)


def _binary(rng: draw.Rng, shape: numbers.Shape, depth: int, tense: Tense) -> rv.Formula:
    ops = tuple((_LIKELY.get(op, 2), op) for op in rv.BinaryOp if op.entry.tense is tense)
    op = draw.weighted(rng, ops) if len(ops) > 1 else ops[0][1]
    window = None
    if op.entry.window is not Window.NONE:
        window = interval(rng, shape, from_zero=op.entry.window is Window.FROM_NOW)
    left = formula(rng, shape, rng.randint(0, depth - 1))
    return rv.Binary(op, left, formula(rng, shape, depth - 1), window)


def past_unary(rng: draw.Rng, shape: numbers.Shape, depth: int) -> rv.Formula:
    """A random unary past operator over a formula of depth `depth - 1`."""
    op = draw.weighted(rng, _unary_of(Tense.PAST))
    operand = formula(rng, shape, depth - 1)
    match op.entry.window:
        case Window.LENGTH:
            return rv.Unary(op, operand, rv.Interval(0, rng.randint(0, shape.longest)))
        case Window.NONE:
            return rv.Unary(op, operand)
        case _:
            return rv.Unary(op, operand, interval(rng, shape))
