"""Random numeric expressions, comparisons and measures of windows, over a small vocabulary."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from msgspec import structs

from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp, UnitRule
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.window_measures import Members
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
        wide: whether whole numbers reach the ends of 64 bits; then no arithmetic is done with them.
        constants: the weight of constants among propositions; the others together have about 100.
        longest: the greatest bound of an interval, ticks.
        amounts: the weight of measures of windows; the other formulas together have about 120.
        instants: names of captured instants.
        form: the only measure; empty: any.
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


_RADIAN = rv.Literal(1, "rad")
_UNITS = {
    **dict.fromkeys((UnitRule.TO_ANGLE, UnitRule.DIRECTION, UnitRule.TURN), _RADIAN),
    UnitRule.PLACES: rv.Literal(1, "m"),
}
"""The unit of the result of operations that have one."""
_CALCULATING = tuple(op for op in NumericOp if op is not NumericOp.BIT)
_CHOOSING = (NumericOp.MIN, NumericOp.MAX)
"""The operations that return one of their operands, so that whole numbers stay within 64 bits."""


def comparison(rng: Rng, shape: Shape) -> rv.Formula:
    """A random comparison of numbers, of a payload field, or of a label."""
    if chance(rng, 12):
        op = pick(rng, (rv.CompareOp.EQ, rv.CompareOp.NE))
        return rv.Compare(op, rv.SignalValue(LABEL), rv.Literal(pick(rng, LABELS)))
    if chance(rng, 4) and not shape.wide:
        bit = rv.Arithmetic(
            NumericOp.BIT, (rv.SignalValue(NUMBERS[1]), rv.Literal(rng.randint(0, 2)))
        )
        return rv.Compare(rv.CompareOp.EQ, bit, rv.Literal(True))
    op = pick(rng, tuple(rv.CompareOp))
    left: rv.Numeric = rv.SignalValue(pick(rng, NUMBERS))
    if shape.events and chance(rng, 30):
        left = field_value(rng)
    elif chance(rng, 40):
        left = arithmetic(rng, shape)
    right: rv.Numeric = rv.Literal(pick(rng, WIDE) if shape.wide else rng.randint(-1, 2))
    if shape.captured and chance(rng, 60):
        right = rv.Captured(pick(rng, shape.captured))
    elif chance(rng, 20):
        right = input_number(rng, shape)
    return rv.Compare(op, right, left) if chance(rng, 10) else rv.Compare(op, left, right)


def arithmetic(rng: Rng, shape: Shape) -> rv.Numeric:
    """A random expression over the last two updates, or an operation on a few numbers."""
    if chance(rng, 40):
        functions = (rv.UpdateFunction.PREV,) if shape.wide else tuple(rv.UpdateFunction)
        return rv.UpdateValue(pick(rng, functions), pick(rng, NUMBERS))
    op = pick(rng, _CHOOSING if shape.wide else _CALCULATING)
    args = [input_number(rng, shape)]
    while len(args) < op.entry.least:
        further = rv.Literal(rng.randint(0, 2)) if chance(rng, 40) else input_number(rng, shape)
        args.insert(rng.randint(0, len(args)), further)
    return _with_units(op, args)


def _with_units(op: NumericOp, args: list[rv.Numeric]) -> rv.Numeric:
    """An operation on numbers without units, whose arguments get the units that it requires."""
    rule = op.entry.unit
    if rule is UnitRule.BITS:
        args = [arg if isinstance(arg, rv.Literal) else rv.SignalValue(NUMBERS[1]) for arg in args]
    if rule in (UnitRule.OF_ANGLE, UnitRule.TURN, UnitRule.PLACES):
        args = [rv.Arithmetic(NumericOp.MUL, (arg, _RADIAN)) for arg in args]
    if rule is UnitRule.TURN:
        args.append(rv.Literal(math.tau, "rad"))
    found = rv.Arithmetic(op, tuple(args))
    unit = _UNITS.get(rule)
    return found if unit is None else rv.Arithmetic(NumericOp.DIV, (found, unit))


def field_value(rng: Rng) -> rv.Numeric:
    """A field of an event with a payload."""
    return rv.FieldValue(FURTHER, SIZE) if chance(rng, 35) else rv.FieldValue(CARRIER, FIELD)


def input_number(rng: Rng, shape: Shape) -> rv.Numeric:
    """A random number to read: a signal, a field, or a captured value."""
    if shape.events and chance(rng, 15):
        return field_value(rng)
    if shape.captured and chance(rng, 20):
        return rv.Captured(pick(rng, shape.captured))
    return rv.SignalValue(pick(rng, NUMBERS))


def probe(rng: Rng, shape: Shape) -> rv.Formula:
    """A random proposition about the updates of a name."""
    kind = pick(rng, tuple(rv.Probe))
    events = (*EVENTS, CARRIER, FURTHER) if shape.events and kind is rv.Probe.UPDATED else ()
    names = (*BOOLS, *NUMBERS, *events)
    return rv.ProbeAtom(kind, pick(rng, names))


Draw = Callable[[Rng, Shape], rv.Formula]
"""A function that draws an operand."""


def late(rng: Rng, shape: Shape) -> rv.Formula:
    """A comparison of the time since an instant with a constant duration or one from data."""
    after: rv.Numeric = rv.Literal(pick(rng, (1e-9, 2e-9, 3e-9, 5e-9, 0)))
    if chance(rng, 60):
        after = rv.Arithmetic(
            NumericOp.MUL, (input_number(rng, replace(shape, events=False)), rv.Literal(1e-9))
        )
    since = pick(rng, shape.instants) if shape.instants and chance(rng, 85) else None
    return rv.passed(since, after, chance(rng, 50))


ALONE = tuple(measured for measured in rv.Measured if not measured.recalls)
"""The measures that can be compared with a limit by themselves."""
EXPRESSION = "expression"
"""The form of windows within numeric expressions."""


def amount(rng: Rng, shape: Shape, draw: Draw) -> rv.Formula:
    """A limit on a measure of a formula or number, in a window or over the whole past."""
    mode, _, form = shape.form.rpartition(" ")
    plain = replace(shape, events=False)
    several = form == EXPRESSION or (not form and chance(rng, 30))
    if several and shape.numbers and not shape.wide:
        return _compared(rng, shape, draw, mode)
    measured = rv.Measured(form) if form and form != EXPRESSION else pick(rng, ALONE)
    if measured.of_numbers and (not shape.numbers or shape.wide):
        measured = rv.Measured.COUNT
    of = _window(rng, shape, draw, measured, mode)
    limit: rv.Numeric = rv.Literal(pick(rng, (-1, 0, 1, 2, 3, 0.5, 2.5)))
    if measured is rv.Measured.INTEGRAL:
        limit = rv.Literal(pick(rng, (-3e-9, 0, 1e-9, 2e-9, 3e-9, 5e-9, 1.5e-9)))
    if not measured.of_numbers:
        limit = rv.Literal(rng.randint(1, 4))
    if (
        chance(rng, 20)
        and measured is not rv.Measured.DURATION
        and shape.numbers
        and not shape.wide
    ):
        limit = input_number(rng, plain)
    return _above(of, limit, chance(rng, 50))


def _above(of: rv.WindowValue, limit: rv.Numeric, strict: bool) -> rv.Amount:
    known = None if isinstance(limit, rv.Literal) else rv.itself(limit)
    return rv.Amount(of, limit, strict, known=known)


def _compared(rng: Rng, shape: Shape, draw: Draw, mode: str) -> rv.Formula:
    """A comparison of expressions with windows; at most one window changes between samples."""

    def side(most: int) -> rv.Numeric:
        return number_of_windows(rng, shape, draw, most, mode)

    if chance(rng, 20):
        alone = _window(rng, shape, draw, pick(rng, ALONE), mode)
        if alone.measured is rv.Measured.DURATION:
            alone = structs.replace(alone, measured=rv.Measured.INTEGRAL, value=rv.Literal(1))
        return _above(alone, side(2), chance(rng, 50))
    while True:
        compared = rv.Compare(pick(rng, tuple(rv.CompareOp)), side(3), side(1))
        if rv.windows_in(compared.left, compared.right):
            return compared


def number_of_windows(
    rng: Rng, shape: Shape, draw: Draw, most: int = 2, mode: str = ""
) -> rv.Numeric:
    """An expression of windows, signals and constants; in held time it changes only at samples.

    Args:
        rng: see `random_spec`.
        shape: its limits; without `step`, time is held.
        draw: draws the formulas that are counted.
        most: the greatest number of operations.
        mode: see `Profile.form`.
    """

    def term() -> rv.Numeric:
        if chance(rng, 30):
            return rv.Literal(pick(rng, (-1, 1, 2, 0.5)))
        if chance(rng, 30):
            return input_number(rng, replace(shape, events=False))
        of = pick(rng, tuple(rv.Measured))
        if of is rv.Measured.AGO and shape.step:
            of = rv.Measured.MAX
        return _window(rng, shape, draw, of, mode, settled=not shape.step)

    found = term()
    for _ in range(rng.randint(0, most)):
        op = pick(rng, _JOINING)
        found = rv.Arithmetic(op, (found, *(term() for _ in range(op.entry.least - 1))))
    return found


_JOINING = (
    *(NumericOp.ADD, NumericOp.SUB, NumericOp.ADD, NumericOp.SUB, NumericOp.MUL, NumericOp.DIV),
    *(NumericOp.ABS, NumericOp.NEG),
    *(NumericOp.MIN, NumericOp.MAX, NumericOp.MOD, NumericOp.FLOOR),
)


def _window(
    rng: Rng, shape: Shape, draw: Draw, measured: rv.Measured, mode: str, *, settled: bool = False
) -> rv.WindowValue:
    """A window; `settled`: one that in held time changes only at samples."""
    if settled and measured.of_time:
        measured = rv.Measured.COUNT
    window = None if chance(rng, 15) else rng.randint(1, shape.longest)
    below = replace(shape, future=False)
    operand: rv.Formula
    value: rv.Numeric | None = None
    counted: rv.Formula | None = None
    most = None
    chosen: tuple[rv.Compare, ...] = ()
    bounded = False
    plain = replace(shape, events=False)
    may_be_last = measured.of is not Members.HELD and measured is not rv.Measured.DURATION
    if may_be_last and (mode == "last" or chance(rng, 25)) and mode not in ("since", "each"):
        most, window = rng.randint(1, 4), None
        name = pick(rng, (*NUMBERS, CARRIER) if shape.events else NUMBERS)
        operand = rv.EventAtom(name) if name == CARRIER else rv.ProbeAtom(rv.Probe.UPDATED, name)
        if measured is rv.Measured.COUNT:
            counted = draw(rng, below)
        else:
            value = rv.FieldValue(CARRIER, FIELD) if name == CARRIER else rv.SignalValue(name)
            counted = rv.itself(value)
    elif not measured.of_numbers:
        operand = draw(rng, below)
    else:
        likely = 90 if mode == "each" else 40
        fields = shape.events and measured.of is not Members.HELD and chance(rng, likely)
        if settled and measured is rv.Measured.MEAN:
            fields = True
        if measured is rv.Measured.VARIANCE and not shape.step:
            fields = True  # for a held number it changes along a curve: the language refuses it
        number = field_value(rng) if fields else _held(rng, plain)
        if measured is rv.Measured.INTEGRAL and chance(rng, 10):
            number = rv.Literal(1)
        value = number
        operand, chosen = _member(rng, below, draw, measured, number)
        bounded = measured in (rv.Measured.DELTA, rv.Measured.AGO) or (
            measured is rv.Measured.VARIANCE and not fields
        )
        if bounded:  # the language requires a duration
            window = window or shape.longest
    since = mode == "since" or chance(rng, 30)
    if shape.instants and since and not (bounded or most):
        passed_by = rv.passed(pick(rng, shape.instants), rv.Literal(0), strict=False)
        operand = rv.Binary(rv.BinaryOp.AND, passed_by, operand)
    return rv.WindowValue(measured, operand, window, value, most, counted, chosen)


def _held(rng: Rng, shape: Shape) -> rv.Numeric:
    """A held number that reads more than captured values, as the language requires."""
    number = arithmetic(rng, shape) if chance(rng, 30) else input_number(rng, shape)
    return number if any(names_in(number)) else rv.SignalValue(pick(rng, NUMBERS))


def _member(
    rng: Rng, shape: Shape, draw: Draw, measured: rv.Measured, value: rv.Numeric
) -> tuple[rv.Formula, tuple[rv.Compare, ...]]:
    """The condition on members of a number, and the comparisons for each occurrence."""
    member: rv.Formula = rv.itself(value)
    chosen: tuple[rv.Compare, ...] = ()
    if isinstance(value, rv.Literal):
        return draw(rng, shape), ()
    if isinstance(value, rv.FieldValue) and measured is rv.Measured.SUM and chance(rng, 40):
        other = input_number(rng, replace(shape, events=False))
        chosen = (rv.Compare(pick(rng, tuple(rv.CompareOp)), value, other),)
    may_choose = measured in (rv.Measured.SUM, rv.Measured.INTEGRAL)
    if may_choose and chance(rng, 40):
        member = rv.Binary(rv.BinaryOp.AND, draw(rng, shape), member)
    return member, chosen
