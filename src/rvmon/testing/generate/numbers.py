"""Random numbers and comparisons over a small vocabulary."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rvmon.language.checked.arithmetic import NumericOp, UnitRule
from rvmon.language.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    CompareOp,
    FieldValue,
    Formula,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
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
)


@dataclass(frozen=True, slots=True)
class Shape:
    """The limits of random formulas.

    Attributes:
        step: whether `X` and `Y` may occur (outside held time).
        past: whether past operators may occur.
        future: whether future operators may occur.
        mixed: whether future operators may stand below past ones.
        numbers: whether comparisons and probes may occur.
        events: whether events may be read.
        captured: names of captured numbers that may be read.
        wide: whether whole numbers lie at the ends of 64 bits; nothing is computed with them then.
        constants: the weight of constants among propositions; all others have about 100.
        longest: the greatest bound of an interval, ticks.
        amounts: the weight of measures of windows; all others have about 120.
        instants: names of captured instants.
        form: the only one that is measured; empty: any.
    """

    step: bool = False
    past: bool = True
    future: bool = True
    mixed: bool = True
    numbers: bool = True
    events: bool = True
    captured: tuple[str, ...] = ()
    wide: bool = False
    constants: int = 2
    longest: int = 6
    amounts: int = 0
    instants: tuple[str, ...] = ()
    form: str = ""


_RADIAN = Literal(1, "rad")
_UNITS = {
    **dict.fromkeys((UnitRule.TO_ANGLE, UnitRule.DIRECTION, UnitRule.TURN), _RADIAN),
    UnitRule.PLACES: Literal(1, "m"),
}
"""The units of the results that have one."""
_CALCULATING = tuple(op for op in NumericOp if op is not NumericOp.BIT)
_CHOOSING = (NumericOp.MIN, NumericOp.MAX)
"""The operations that return one of their operands, so that whole numbers stay within 64 bits."""


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
        right = input_number(rng, shape)
    return Compare(op, right, left) if chance(rng, 10) else Compare(op, left, right)


def arithmetic(rng: Rng, shape: Shape) -> Numeric:
    """A random expression: of the last two updates, or an operation on a few numbers."""
    if chance(rng, 40):
        functions = (UpdateFunction.PREV,) if shape.wide else tuple(UpdateFunction)
        return UpdateValue(pick(rng, functions), pick(rng, NUMBERS))
    op = pick(rng, _CHOOSING if shape.wide else _CALCULATING)
    args = [input_number(rng, shape)]
    while len(args) < op.entry.least:
        further = Literal(rng.randint(0, 2)) if chance(rng, 40) else input_number(rng, shape)
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


def input_number(rng: Rng, shape: Shape) -> Numeric:
    """A random number that is read: of a signal, a field, or captured."""
    if shape.events and chance(rng, 15):
        return field_value(rng)
    if shape.captured and chance(rng, 20):
        return Captured(pick(rng, shape.captured))
    return SignalValue(pick(rng, NUMBERS))


def probe(rng: Rng, shape: Shape) -> Formula:
    """A random proposition about the updates of a name."""
    kind = pick(rng, tuple(Probe))
    events = (*EVENTS, CARRIER, FURTHER) if shape.events and kind is Probe.UPDATED else ()
    names = (*BOOLS, *NUMBERS, *events)
    return ProbeAtom(kind, pick(rng, names))
