"""Random windows of the past, beside a limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import (
    Amount,
    Arithmetic,
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    EventAtom,
    FieldValue,
    Formula,
    Literal,
    Measured,
    Numeric,
    Probe,
    ProbeAtom,
    SignalValue,
    WindowValue,
    itself,
    passed,
    windows_in,
)
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.window_measures import Members
from rvmon.testing.generate import (
    CARRIER,
    FIELD,
    NUMBERS,
    Rng,
    chance,
    pick,
)
from rvmon.testing.generate.numbers import Shape, arithmetic, field_value, input_number

Draw = Callable[[Rng, Shape], Formula]
"""A function that draws an operand."""


def late(rng: Rng, shape: Shape) -> Formula:
    """A comparison of the time since an instant, with or without data in the duration."""
    after: Numeric = Literal(pick(rng, (1e-9, 2e-9, 3e-9, 5e-9, 0)))
    if chance(rng, 60):
        after = Arithmetic(
            NumericOp.MUL, (input_number(rng, replace(shape, events=False)), Literal(1e-9))
        )
    since = pick(rng, shape.instants) if shape.instants and chance(rng, 85) else None
    return passed(since, after, chance(rng, 50))


ALONE = tuple(measured for measured in Measured if not measured.recalls)
"""The measures that can stand beside a limit by themselves."""
EXPRESSION = "expression"
"""The form of windows that are numbers among others."""


def amount(rng: Rng, shape: Shape, draw: Draw) -> Formula:
    """A limit on a measure of a formula or number, in a window or since the first instant."""
    mode, _, form = shape.form.rpartition(" ")
    plain = replace(shape, events=False)
    several = form == EXPRESSION or (not form and chance(rng, 30))
    if several and shape.numbers and not shape.wide:
        return _compared(rng, shape, draw, mode)
    measured = Measured(form) if form and form != EXPRESSION else pick(rng, ALONE)
    if measured.of_numbers and (not shape.numbers or shape.wide):
        measured = Measured.COUNT
    of = _window(rng, shape, draw, measured, mode)
    limit: Numeric = Literal(pick(rng, (-1, 0, 1, 2, 3, 0.5, 2.5)))
    if measured is Measured.INTEGRAL:
        limit = Literal(pick(rng, (-3e-9, 0, 1e-9, 2e-9, 3e-9, 5e-9, 1.5e-9)))
    if not measured.of_numbers:
        limit = Literal(rng.randint(1, 4))
    if chance(rng, 20) and measured is not Measured.DURATION and shape.numbers and not shape.wide:
        limit = input_number(rng, plain)
    return _above(of, limit, chance(rng, 50))


def _above(of: WindowValue, limit: Numeric, strict: bool) -> Amount:
    known = None if isinstance(limit, Literal) else itself(limit)
    return Amount(of, limit, strict, known=known)


def _compared(rng: Rng, shape: Shape, draw: Draw, mode: str) -> Formula:
    """An expression of one window or more, beside another; of what moves one alone at most."""

    def side(most: int) -> Numeric:
        return number_of_windows(rng, shape, draw, most, mode)

    if chance(rng, 20):
        alone = _window(rng, shape, draw, pick(rng, ALONE), mode)
        if alone.measured is Measured.DURATION:
            alone = replace(alone, measured=Measured.INTEGRAL, value=Literal(1))
        return _above(alone, side(2), chance(rng, 50))
    while True:
        compared = Compare(pick(rng, tuple(CompareOp)), side(3), side(1))
        if windows_in(compared.left, compared.right):
            return compared


def number_of_windows(rng: Rng, shape: Shape, draw: Draw, most: int = 2, mode: str = "") -> Numeric:
    """An expression of windows, signals and constants; in `time held` none of them moves.

    Args:
        rng: see `random_spec`.
        shape: its limits; without `step` it is of held time.
        draw: draws what is counted.
        most: the most operations.
        mode: of windows.
    """

    def term() -> Numeric:
        if chance(rng, 30):
            return Literal(pick(rng, (-1, 1, 2, 0.5)))
        if chance(rng, 30):
            return input_number(rng, replace(shape, events=False))
        of = pick(rng, tuple(Measured))
        if of is Measured.AGO and shape.step:
            of = Measured.MAX
        return _window(rng, shape, draw, of, mode, settled=not shape.step)

    found = term()
    for _ in range(rng.randint(0, most)):
        op = pick(rng, _JOINING)
        found = Arithmetic(op, (found, *(term() for _ in range(op.entry.least - 1))))
    return found


_JOINING = (
    *(NumericOp.ADD, NumericOp.SUB, NumericOp.ADD, NumericOp.SUB, NumericOp.MUL, NumericOp.DIV),
    *(NumericOp.ABS, NumericOp.NEG),
    *(NumericOp.MIN, NumericOp.MAX, NumericOp.MOD, NumericOp.FLOOR),
)


def _window(
    rng: Rng,
    shape: Shape,
    draw: Draw,
    measured: Measured,
    mode: str,
    *,
    settled: bool = False,
) -> WindowValue:
    """A window; `settled`: one that changes by jumps alone, in `time held`."""
    if settled and measured.of_time:
        measured = Measured.COUNT
    window = None if chance(rng, 15) else rng.randint(1, shape.longest)
    below = replace(shape, future=False)
    operand: Formula
    value: Numeric | None = None
    counted: Formula | None = None
    most = None
    chosen: tuple[Compare, ...] = ()
    bounded = False
    plain = replace(shape, events=False)
    may_be_last = measured.of is not Members.HELD and measured is not Measured.DURATION
    if may_be_last and (mode == "last" or chance(rng, 25)) and mode not in ("since", "each"):
        most, window = rng.randint(1, 4), None
        name = pick(rng, (*NUMBERS, CARRIER) if shape.events else NUMBERS)
        operand = EventAtom(name) if name == CARRIER else ProbeAtom(Probe.UPDATED, name)
        if measured is Measured.COUNT:
            counted = draw(rng, below)
        else:
            value = FieldValue(CARRIER, FIELD) if name == CARRIER else SignalValue(name)
            counted = itself(value)
    elif not measured.of_numbers:
        operand = draw(rng, below)
    else:
        likely = 90 if mode == "each" else 40
        fields = shape.events and measured.of is not Members.HELD and chance(rng, likely)
        if settled and measured is Measured.MEAN:
            fields = True
        if measured is Measured.VARIANCE and not shape.step:
            fields = True  # that of what is held moves along a curve: the language refuses it
        number = field_value(rng) if fields else _held(rng, plain)
        if measured is Measured.INTEGRAL and chance(rng, 10):
            number = Literal(1)
        value = number
        operand, chosen = _member(rng, below, draw, measured, number)
        bounded = measured in (Measured.DELTA, Measured.AGO) or (
            measured is Measured.VARIANCE and not fields
        )
        if bounded:  # the language asks for a D
            window = window or shape.longest
    since = mode == "since" or chance(rng, 30)
    if shape.instants and since and not (bounded or most):
        begun = passed(pick(rng, shape.instants), Literal(0), strict=False)
        operand = Binary(BinaryOp.AND, begun, operand)
    return WindowValue(measured, operand, window, value, most, counted, chosen)


def _held(rng: Rng, shape: Shape) -> Numeric:
    """A number that is held: what was captured alone is none, says the language."""
    number = arithmetic(rng, shape) if chance(rng, 30) else input_number(rng, shape)
    return number if any(names_in(number)) else SignalValue(pick(rng, NUMBERS))


def _member(
    rng: Rng, shape: Shape, draw: Draw, measured: Measured, value: Numeric
) -> tuple[Formula, tuple[Compare, ...]]:
    """The condition on members of a number, and the comparisons for each occurrence."""
    member: Formula = itself(value)
    chosen: tuple[Compare, ...] = ()
    if isinstance(value, Literal):
        return draw(rng, shape), ()
    if isinstance(value, FieldValue) and measured is Measured.SUM and chance(rng, 40):
        beside = input_number(rng, replace(shape, events=False))
        chosen = (Compare(pick(rng, tuple(CompareOp)), value, beside),)
    may_choose = measured in (Measured.SUM, Measured.INTEGRAL)
    if may_choose and chance(rng, 40):
        member = Binary(BinaryOp.AND, draw(rng, shape), member)
    return member, chosen
