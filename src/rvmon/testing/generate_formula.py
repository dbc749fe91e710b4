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


_CONNECTIVES = (
    (6, BinaryOp.AND),
    (6, BinaryOp.OR),
    (3, BinaryOp.IMPLIES),
    (1, BinaryOp.IFF),
    (1, BinaryOp.XOR),
)
_FUTURE_UNARY = ((3, UnaryOp.EVENTUALLY), (3, UnaryOp.ALWAYS))
_FUTURE_BINARY = (
    (4, BinaryOp.UNTIL),
    (2, BinaryOp.RELEASE),
    (2, BinaryOp.WEAK_UNTIL),
    (2, BinaryOp.STRONG_RELEASE),
)
_PAST_UNARY = (
    (3, UnaryOp.ONCE),
    (3, UnaryOp.HISTORICALLY),
    (2, UnaryOp.RISE),
    (2, UnaryOp.FALL),
    (2, UnaryOp.HELD),
)


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
            return _two(dice, shape, depth, weighted(dice, _CONNECTIVES), None)
        case "future unary":
            return _future_unary(dice, shape, depth)
        case "future binary":
            return _future_binary(dice, shape, depth)
        case "next":
            return Unary(UnaryOp.NEXT, formula(dice, shape, depth - 1))
        case "past unary":
            return past_unary(dice, below, depth)
        case "since":
            return _two(dice, below, depth, BinaryOp.SINCE, interval(dice, shape))
        case _:
            return Unary(UnaryOp.PREVIOUS, formula(dice, below, depth - 1))


def _two(dice: Dice, shape: Shape, depth: int, op: BinaryOp, window: Interval | None) -> Formula:
    left = formula(dice, shape, dice.randint(0, depth - 1))
    return Binary(op, left, formula(dice, shape, depth - 1), window)


def _future_unary(dice: Dice, shape: Shape, depth: int) -> Formula:
    op = weighted(dice, _FUTURE_UNARY)
    window = interval(dice, shape)
    return Unary(op, formula(dice, shape, depth - 1), window)


def _future_binary(dice: Dice, shape: Shape, depth: int) -> Formula:
    op = weighted(dice, _FUTURE_BINARY)
    from_zero = op in (BinaryOp.WEAK_UNTIL, BinaryOp.STRONG_RELEASE)
    return _two(dice, shape, depth, op, interval(dice, shape, from_zero=from_zero))


def past_unary(dice: Dice, shape: Shape, depth: int) -> Formula:
    """A random unary past operator over a formula one less deep."""
    op = weighted(dice, _PAST_UNARY)
    operand = formula(dice, shape, depth - 1)
    if op is UnaryOp.HELD:
        return Unary(op, operand, Interval(0, dice.randint(0, shape.longest)))
    if op in (UnaryOp.RISE, UnaryOp.FALL):
        return Unary(op, operand)
    return Unary(op, operand, interval(dice, shape))
