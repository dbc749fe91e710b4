"""Random formulas over a small vocabulary."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rvmon.spec.checked.arithmetic import NumericOp, UnitRule
from rvmon.spec.checked.formula import (
    Amount,
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
    Measured,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UnaryOp,
    UpdateFunction,
    UpdateValue,
    itself,
    passed,
)
from rvmon.spec.checked.operators import Tense, Window
from rvmon.testing.generate import (
    BOOLS,
    CARRIER,
    EVENTS,
    FIELD,
    FURTHER,
    LABEL,
    LABELS,
    NUMBERS,
    SIZE,
    WIDE,
    Rng,
    chance,
    pick,
    weighted,
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
        wide: whether whole numbers lie at the ends of 64 bits; nothing is computed with them then.
        longest: the greatest bound of an interval, ticks.
        amounts: how often counts and durations come, beside about 120 of all others.
        instants: names of captured instants.
    """

    step: bool = False
    past: bool = True
    future: bool = True
    mixed: bool = True
    numbers: bool = True
    events: bool = True
    captured: tuple[str, ...] = ()
    wide: bool = False
    longest: int = 6
    amounts: int = 0
    instants: tuple[str, ...] = ()


_RADIAN = Literal(1, "rad")
_UNITS = {
    **dict.fromkeys((UnitRule.TO_ANGLE, UnitRule.DIRECTION, UnitRule.TURN), _RADIAN),
    UnitRule.PLACES: Literal(1, "m"),
}
"""Of the results that have one."""
_CALCULATING = tuple(op for op in NumericOp if op is not NumericOp.BIT)
_CHOOSING = (NumericOp.MIN, NumericOp.MAX)
"""What gives one of its operands, so that no whole number leaves its 64 bits."""


def interval(rng: Rng, shape: Shape, *, from_zero: bool = False) -> Interval:
    """A random interval: bounded or not, from zero or later, a point or more."""
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
            (2, "constant"),
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
            return _probe(rng, shape)
        case "constant":
            return Constant(chance(rng, 50))
        case _:
            return BoundAtom(Bound.START)


def comparison(rng: Rng, shape: Shape) -> Formula:
    """A random comparison: of numbers, of a payload field, of a label."""
    if chance(rng, 12):
        op = pick(rng, (CompareOp.EQ, CompareOp.NE))
        return Compare(op, SignalValue(LABEL), Literal(pick(rng, LABELS)))
    if chance(rng, 4) and not shape.wide:
        bit = Arithmetic(NumericOp.BIT, (SignalValue(NUMBERS[1]), Literal(rng.randint(0, 2))))
        return Compare(CompareOp.EQ, bit, Literal(True))
    op = pick(rng, tuple(CompareOp))
    left: Numeric = SignalValue(pick(rng, NUMBERS))
    if shape.events and chance(rng, 30):
        left = field_value(rng)
    elif chance(rng, 40):
        left = arithmetic(rng, shape)
    right: Numeric = Literal(pick(rng, WIDE) if shape.wide else rng.randint(-1, 2))
    if shape.captured and chance(rng, 60):
        right = Captured(pick(rng, shape.captured))
    elif chance(rng, 20):
        right = _input(rng, shape)
    return Compare(op, right, left) if chance(rng, 10) else Compare(op, left, right)


def arithmetic(rng: Rng, shape: Shape) -> Numeric:
    """A random expression: of the last two updates, or an operation on a few numbers."""
    if chance(rng, 40):
        functions = (UpdateFunction.PREV,) if shape.wide else tuple(UpdateFunction)
        return UpdateValue(pick(rng, functions), pick(rng, NUMBERS))
    op = pick(rng, _CHOOSING if shape.wide else _CALCULATING)
    args = [_input(rng, shape)]
    while len(args) < op.entry.least:
        further = Literal(rng.randint(0, 2)) if chance(rng, 40) else _input(rng, shape)
        args.insert(rng.randint(0, len(args)), further)
    return _with_units(op, args)


def _with_units(op: NumericOp, args: list[Numeric]) -> Numeric:
    """An operation on plain numbers that yields one, with the units that it asks for between."""
    rule = op.entry.unit
    if rule is UnitRule.BITS:
        args = [arg if isinstance(arg, Literal) else SignalValue(NUMBERS[1]) for arg in args]
    if rule in (UnitRule.OF_ANGLE, UnitRule.TURN, UnitRule.PLACES):
        args = [Arithmetic(NumericOp.MUL, (arg, _RADIAN)) for arg in args]
    if rule is UnitRule.TURN:
        args.append(Literal(math.tau, "rad"))
    found = Arithmetic(op, tuple(args))
    unit = _UNITS.get(rule)
    return found if unit is None else Arithmetic(NumericOp.DIV, (found, unit))


def field_value(rng: Rng) -> Numeric:
    """A field of one of the events that carry some."""
    return FieldValue(FURTHER, SIZE) if chance(rng, 35) else FieldValue(CARRIER, FIELD)


def _input(rng: Rng, shape: Shape) -> Numeric:
    if shape.events and chance(rng, 15):
        return field_value(rng)
    if shape.captured and chance(rng, 20):
        return Captured(pick(rng, shape.captured))
    return SignalValue(pick(rng, NUMBERS))


def _probe(rng: Rng, shape: Shape) -> Formula:
    probe = pick(rng, tuple(Probe))
    events = (*EVENTS, CARRIER, FURTHER) if shape.events and probe is Probe.UPDATED else ()
    names = (*BOOLS, *NUMBERS, *events)
    return ProbeAtom(probe, pick(rng, names))


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


def consequent(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random formula that mostly speaks of the future at its top."""
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
        case "amount" if shape.numbers and not shape.wide and chance(rng, 20):
            return _passed(rng, shape)
        case "amount":
            return _amount(rng, shape, depth)
        case "since":
            return _binary(rng, below, depth, Tense.PAST)
        case _:
            return Unary(UnaryOp.PREVIOUS, formula(rng, below, depth - 1))


def _passed(rng: Rng, shape: Shape) -> Formula:
    """So long since an instant, with or without data in the duration."""
    after: Numeric = Literal(pick(rng, (1e-9, 2e-9, 3e-9, 5e-9, 0)))
    if chance(rng, 60):
        after = Arithmetic(
            NumericOp.MUL, (_input(rng, replace(shape, events=False)), Literal(1e-9))
        )
    since = pick(rng, shape.instants) if shape.instants and chance(rng, 85) else None
    return passed(since, after, chance(rng, 50))


def _amount(rng: Rng, shape: Shape, depth: int) -> Formula:
    """So much of a formula, or of a number, in a window, or since the first instant."""
    measured = pick(rng, tuple(Measured))
    window = None if chance(rng, 15) else rng.randint(1, shape.longest)
    below = replace(shape, future=False)
    if not measured.of_numbers or not shape.numbers or shape.wide:
        counted = formula(rng, below, depth - 1)
        if measured.of_numbers:
            measured = Measured.COUNT
        return Amount(measured, counted, window, rng.randint(1, 4))
    fields = shape.events and "each" not in shape.captured and measured is not Measured.INTEGRAL
    plain = replace(shape, events=False)
    value = arithmetic(rng, plain) if chance(rng, 30) else _input(rng, plain)
    if fields and chance(rng, 40):
        value = field_value(rng)
    member: Formula = itself(value)
    if measured is not Measured.MEAN and chance(rng, 40):
        member = Binary(BinaryOp.AND, formula(rng, below, depth - 1), member)
    limit: Numeric = Literal(pick(rng, (-1, 0, 1, 2, 3, 0.5, 2.5)))
    if measured is Measured.INTEGRAL:
        limit = Literal(pick(rng, (-3e-9, 0, 1e-9, 2e-9, 3e-9, 5e-9, 1.5e-9)))
    if chance(rng, 20):
        limit = _input(rng, plain)
    known = None if isinstance(limit, Literal) else itself(limit)
    strict = chance(rng, 50)
    return Amount(measured, member, window, 1, None, value, limit, strict, known)


def _future_unary(rng: Rng, shape: Shape, depth: int) -> Formula:
    op = weighted(rng, _unary_of(Tense.FUTURE))
    window = interval(rng, shape)
    return Unary(op, formula(rng, shape, depth - 1), window)


def _future_binary(rng: Rng, shape: Shape, depth: int) -> Formula:
    return _binary(rng, shape, depth, Tense.FUTURE)


def _binary(rng: Rng, shape: Shape, depth: int, tense: Tense) -> Formula:
    ops = _binary_of(tense)
    op = weighted(rng, ops) if len(ops) > 1 else ops[0][1]
    window = None
    if op.entry.window is not Window.NONE:
        window = interval(rng, shape, from_zero=op.entry.window is Window.FROM_NOW)
    left = formula(rng, shape, rng.randint(0, depth - 1))
    return Binary(op, left, formula(rng, shape, depth - 1), window)


def past_unary(rng: Rng, shape: Shape, depth: int) -> Formula:
    """A random unary past operator over a formula one less deep."""
    op = weighted(rng, _unary_of(Tense.PAST))
    operand = formula(rng, shape, depth - 1)
    match op.entry.window:
        case Window.LENGTH:
            return Unary(op, operand, Interval(0, rng.randint(0, shape.longest)))
        case Window.NONE:
            return Unary(op, operand)
        case _:
            return Unary(op, operand, interval(rng, shape))
