"""Random formulas over a small vocabulary."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Captured,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    FieldValue,
    Formula,
    Interval,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UnaryOp,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.operators import Tense, Window
from rvmon.testing.dice import Dice, chance, pick, weighted
from rvmon.testing.vocabulary import (
    BOOLS,
    CARRIER,
    EVENTS,
    FIELD,
    FURTHER,
    LABEL,
    LABELS,
    NUMBERS,
    SIZE,
)


@dataclass(frozen=True, slots=True)
class Shape:
    """What random formulas may hold.

    Attributes:
        step: whether `X` and `Y` may occur (outside held time).
        past: whether past operators may occur.
        future: whether future operators may occur.
        mixed: whether future operators may stand below past ones.
        numbers: whether comparisons and probes may occur.
        events: whether events may be read.
        captured: names of captured numbers that may be read.
        longest: the greatest bound of an interval, ticks.
    """

    step: bool = False
    past: bool = True
    future: bool = True
    mixed: bool = True
    numbers: bool = True
    events: bool = True
    captured: tuple[str, ...] = ()
    longest: int = 6


def interval(dice: Dice, shape: Shape, *, from_zero: bool = False) -> Interval:
    """A random interval: bounded or not, from zero or later, a point or more."""
    low = 0 if from_zero or chance(dice, 55) else dice.randint(1, shape.longest // 2)
    if chance(dice, 25):
        return Interval(low, None)
    if chance(dice, 20):
        return Interval(low, low)
    return Interval(low, dice.randint(max(low, 1), shape.longest))


def atom(dice: Dice, shape: Shape) -> Formula:
    """A random proposition."""
    kind = weighted(
        dice,
        (
            (50, "signal"),
            (22 if shape.events else 0, "event"),
            (18 if shape.numbers else 0, "compare"),
            (6 if shape.numbers else 0, "probe"),
            (2, "constant"),
            (2, "start"),
        ),
    )
    match kind:
        case "signal":
            return SignalAtom(pick(dice, BOOLS))
        case "event":
            return EventAtom(pick(dice, (*EVENTS, CARRIER, FURTHER)))
        case "compare":
            return comparison(dice, shape)
        case "probe":
            return _probe(dice, shape)
        case "constant":
            return Constant(chance(dice, 50))
        case _:
            return BoundAtom(Bound.START)


def comparison(dice: Dice, shape: Shape) -> Formula:
    """A random comparison: of numbers, of a payload field, of a label."""
    if chance(dice, 12):
        op = pick(dice, (CompareOp.EQ, CompareOp.NE))
        return Compare(op, SignalValue(LABEL), Literal(pick(dice, LABELS)))
    op = pick(dice, tuple(CompareOp))
    left: Numeric = SignalValue(pick(dice, NUMBERS))
    if shape.events and chance(dice, 30):
        left = field_value(dice)
    elif chance(dice, 40):
        left = arithmetic(dice, shape)
    right: Numeric = Literal(dice.randint(-1, 2))
    if shape.captured and chance(dice, 60):
        right = Captured(pick(dice, shape.captured))
    elif chance(dice, 20):
        right = _input(dice, shape)
    return Compare(op, right, left) if chance(dice, 10) else Compare(op, left, right)


def arithmetic(dice: Dice, shape: Shape) -> Numeric:
    """A random expression: of the last two updates, or an operation on a few numbers."""
    if chance(dice, 40):
        return UpdateValue(pick(dice, tuple(UpdateFunction)), pick(dice, NUMBERS))
    op = pick(dice, tuple(NumericOp))
    first = _input(dice, shape)
    if op.entry.most == 1:
        return Arithmetic(op, (first,))
    second = Literal(dice.randint(0, 2)) if chance(dice, 40) else _input(dice, shape)
    return Arithmetic(op, (second, first) if chance(dice, 40) else (first, second))


def field_value(dice: Dice) -> Numeric:
    """A field of one of the events that carry some."""
    return FieldValue(FURTHER, SIZE) if chance(dice, 35) else FieldValue(CARRIER, FIELD)


def _input(dice: Dice, shape: Shape) -> Numeric:
    if shape.events and chance(dice, 15):
        return field_value(dice)
    if shape.captured and chance(dice, 20):
        return Captured(pick(dice, shape.captured))
    return SignalValue(pick(dice, NUMBERS))


def _probe(dice: Dice, shape: Shape) -> Formula:
    probe = pick(dice, tuple(Probe))
    events = (*EVENTS, CARRIER, FURTHER) if shape.events and probe is Probe.UPDATED else ()
    names = (*BOOLS, *NUMBERS, *events)
    return ProbeAtom(probe, pick(dice, names))


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
"""How often an operator comes among those of its kind, if not 2 times."""

_STEPS = (UnaryOp.NOT, UnaryOp.NEXT, UnaryOp.PREVIOUS)


def _unary_of(tense: Tense) -> tuple[tuple[int, UnaryOp], ...]:
    found = (op for op in UnaryOp if op.entry.tense is tense and op not in _STEPS)
    return tuple((_LIKELY.get(op, 2), op) for op in found)


def _binary_of(tense: Tense) -> tuple[tuple[int, BinaryOp], ...]:
    return tuple((_LIKELY.get(op, 2), op) for op in BinaryOp if op.entry.tense is tense)


def consequent(dice: Dice, shape: Shape, depth: int) -> Formula:
    """A random formula that mostly speaks of the future at its top."""
    if shape.future and chance(dice, 50):
        return (_future_unary if chance(dice, 50) else _future_binary)(dice, shape, depth)
    return formula(dice, shape, depth)


def formula(dice: Dice, shape: Shape, depth: int) -> Formula:
    """A random formula whose operators nest at most `depth` deep."""
    if depth == 0:
        return atom(dice, shape)
    kind = weighted(
        dice,
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
        ),
    )
    below = shape if shape.mixed else replace(shape, future=False)
    match kind:
        case "atom":
            return atom(dice, shape)
        case "not":
            return Unary(UnaryOp.NOT, formula(dice, shape, depth - 1))
        case "connective":
            return _binary(dice, shape, depth, Tense.PRESENT)
        case "future unary":
            return _future_unary(dice, shape, depth)
        case "future binary":
            return _future_binary(dice, shape, depth)
        case "next":
            return Unary(UnaryOp.NEXT, formula(dice, shape, depth - 1))
        case "past unary":
            return past_unary(dice, below, depth)
        case "since":
            return _binary(dice, below, depth, Tense.PAST)
        case _:
            return Unary(UnaryOp.PREVIOUS, formula(dice, below, depth - 1))


def _future_unary(dice: Dice, shape: Shape, depth: int) -> Formula:
    op = weighted(dice, _unary_of(Tense.FUTURE))
    window = interval(dice, shape)
    return Unary(op, formula(dice, shape, depth - 1), window)


def _future_binary(dice: Dice, shape: Shape, depth: int) -> Formula:
    return _binary(dice, shape, depth, Tense.FUTURE)


def _binary(dice: Dice, shape: Shape, depth: int, tense: Tense) -> Formula:
    ops = _binary_of(tense)
    op = weighted(dice, ops) if len(ops) > 1 else ops[0][1]
    window = None
    if op.entry.window is not Window.NONE:
        window = interval(dice, shape, from_zero=op.entry.window is Window.FROM_NOW)
    left = formula(dice, shape, dice.randint(0, depth - 1))
    return Binary(op, left, formula(dice, shape, depth - 1), window)


def past_unary(dice: Dice, shape: Shape, depth: int) -> Formula:
    """A random unary past operator over a formula one less deep."""
    op = weighted(dice, _unary_of(Tense.PAST))
    operand = formula(dice, shape, depth - 1)
    match op.entry.window:
        case Window.LENGTH:
            return Unary(op, operand, Interval(0, dice.randint(0, shape.longest)))
        case Window.NONE:
            return Unary(op, operand)
        case _:
            return Unary(op, operand, interval(dice, shape))
