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
    kind = weighted(
        rng,
        (
            (50, "signal"),
            (22 if shape.events else 0, "event"),
            ((60 if shape.wide else 18) if shape.numbers else 0, "compare"),
            (6 if shape.numbers else 0, "probe"),
            (shape.constants, "constant"),
            (2, "start"),
        ),
    )
    match kind:
        case "signal":
            return SignalAtom(pick(rng, BOOLS))
        case "event":
            return EventAtom(pick(rng, (*EVENTS, CARRIER, FURTHER)))
        case "compare":
            return comparison(rng, shape)
        case "probe":
            return probe(rng, shape)
        case "constant":
            return Constant(chance(rng, 50))
        case _:
            return BoundAtom(Bound.START)


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
        return (_future_unary if chance(rng, 50) else _future_binary)(rng, shape, depth)
    return formula(rng, shape, depth)


def formula(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random formula whose operators nest at most `depth` deep."""
    if depth == 0:
        return atom(rng, shape)
    kind = weighted(
        rng,
        (
            (8, "atom"),
            (12, "not"),
            (26, "connective"),
            (24 if shape.future else 0, "future unary"),
            (18 if shape.future else 0, "future binary"),
            (8 if shape.future and shape.step else 0, "next"),
            (17 if shape.past else 0, "past unary"),
            (6 if shape.past else 0, "since"),
            (4 if shape.past and shape.step else 0, "previous"),
            (shape.amounts if shape.past else 0, "amount"),
        ),
    )
    below = shape if shape.mixed else replace(shape, future=False)
    match kind:
        case "atom":
            return atom(rng, shape)
        case "not":
            return Unary(UnaryOp.NOT, formula(rng, shape, depth - 1))
        case "connective":
            return _binary(rng, shape, depth, Tense.PRESENT)
        case "future unary":
            return _future_unary(rng, shape, depth)
        case "future binary":
            return _future_binary(rng, shape, depth)
        case "next":
            return Unary(UnaryOp.NEXT, formula(rng, shape, depth - 1))
        case "past unary":
            return past_unary(rng, below, depth)
        case "amount" if shape.numbers and not shape.wide and not shape.form and chance(rng, 20):
            return late(rng, shape)
        case "amount":
            return amount(rng, shape, partial(_below, depth - 1))
        case "since":
            return _binary(rng, below, depth, Tense.PAST)
        case _:
            return Unary(UnaryOp.PREVIOUS, formula(rng, below, depth - 1))


def _below(depth: int, rng: Rng, shape: Shape) -> Formula:
    return formula(rng, shape, depth)


def _future_unary(rng: Rng, shape: Shape, depth: int) -> Formula:
    op = weighted(rng, _unary_of(Tense.FUTURE))
    window = interval(rng, shape)
    return Unary(op, formula(rng, shape, depth - 1), window)


def _future_binary(rng: Rng, shape: Shape, depth: int) -> Formula:
    return _binary(rng, shape, depth, Tense.FUTURE)


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
