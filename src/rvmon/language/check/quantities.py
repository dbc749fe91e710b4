"""Arithmetic on quantities and comparison of quantities, with exact constants and units.

An operation on a choice between numbers gives a choice between the results for both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from math import prod
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.language.check.scope import Chosen, Quantity, TimeValue, Value
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp, UnitRule
from rvmon.language.checked.rewrite import Formulas
from rvmon.language.rules import Refusal, short
from rvmon.language.rules import types as rules
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT
from rvmon.units import PLAIN, Unit, base_unit, parse_unit, product, quotient, root

Placed = tuple[Quantity, Span]  # a quantity with the place of its expression

_RADIAN = parse_unit("rad")
_OF_ANGLES = {UnitRule.OF_ANGLE: PLAIN, UnitRule.PLACES: parse_unit("m")}
_HIGHEST = 9  # the highest power of a unit
_DOING = {NumericOp.ADD: "added to", NumericOp.SUB: "reduced by"}  # words for findings


def compare(op: rv.CompareOp, left: Placed, right: Placed, span: Span) -> rv.Compare | rv.Constant:
    """Compare numbers in the unit of the first side that is not a constant.

    Raises:
        Refusal: the units do not fit, or a constant is out of range.
    """
    sides = (left, right)
    unit = _common_unit(sides, "compared with", span)
    if left[0].constant is not None and right[0].constant is not None:
        exact = [_exact(value, unit) for value, _ in sides]
        return rv.Constant(op.holds(*exact), span)
    first, second = _nodes(sides, unit)
    return rv.Compare(op, first, second, span)


def arithmetic(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    """Apply an operation to numbers.

    Raises:
        Refusal: the units do not fit, or a constant is out of range.
    """
    rule = op.entry.unit
    try:
        match rule:
            case UnitRule.PRODUCT | UnitRule.QUOTIENT:
                return _scale(op, args, span)
            case UnitRule.ROOT:
                return _root(op, args[0], span)
            case UnitRule.POWER if args[0][0].unit.symbol:
                return _power(op, args, span)
            case UnitRule.SAME | UnitRule.DIRECTION:
                unit = _common_unit(args, _DOING.get(op, "beside"), span)
                return _applied(op, args, unit, unit if rule is UnitRule.SAME else _RADIAN, span)
            case UnitRule.SIGN:
                return _applied(op, args, args[0][0].unit, PLAIN, span)
            case UnitRule.PLAIN | UnitRule.POWER | UnitRule.BITS:
                _check_dimension(op, args, PLAIN, whole=rule is UnitRule.BITS)
                return _applied(op, args, PLAIN, PLAIN, span)
            case UnitRule.TO_ANGLE:
                _check_dimension(op, args, PLAIN)
                return _applied(op, args, PLAIN, _RADIAN, span)
            case UnitRule.OF_ANGLE | UnitRule.PLACES:
                _check_dimension(op, args, _RADIAN)
                return _applied(op, args, _RADIAN, _OF_ANGLES[rule], span)
            case UnitRule.TURN:
                _check_dimension(op, args, _RADIAN)
                unit = _common_unit(args, "beside", span)
                turn = Quantity(constant=parse_unit("rev").factor / unit.factor, unit=unit), span
                return _applied(op, (*args, turn), unit, unit, span)
            case _:
                assert_never(rule)
    except (ArithmeticError, ValueError):
        raise Refusal(rules.out_of_range(span)) from None


def node_of(placed: Placed) -> rv.Numeric:
    """The expression that yields the quantity at run time, in its own unit.

    Raises:
        Refusal: it is a constant that is out of range.
    """
    return _nodes((placed,), placed[0].unit)[0]


def _check_dimension(
    op: NumericOp, args: Sequence[Placed], unit: Unit, *, whole: bool = False
) -> None:
    """Refuse arguments in other dimensions than that of `unit`; `whole`: also non-integers."""
    for value, place in args:
        if value.unit.dimension != unit.dimension and not _bare_zero(value):
            raise Refusal(rules.argument_unit(place, op, value.unit.symbol, unit.symbol))
        if whole and not _is_integral(value):
            raise Refusal(rules.argument_kind(place, op, "a number of type `int`"))


def _applied(
    op: NumericOp, args: Sequence[Placed], unit: Unit, result: Unit, span: Span
) -> Quantity:
    """An operation on values converted to `unit`, with a result in the unit `result`."""
    truth = op is NumericOp.BIT
    constants = [_exact(value, unit) for value, _ in args if value.constant is not None]
    if len(constants) == len(args) and not truth:
        return Quantity(constant=_folded(op, constants, span), unit=result)
    node = rv.Arithmetic(op, _nodes(args, unit))
    return Quantity(node, unit=result, integral=_is_whole(op, args), truth=truth)


def _power(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    """A power of a value with a unit; the exponent must be a small whole constant."""
    (base, _), (exponent, place) = args
    power = exponent.constant
    if power is None or exponent.unit.symbol or power.denominator != 1 or abs(power) > _HIGHEST:
        raise Refusal(rules.power_of_unit(place, base.unit.symbol))
    inverse = quotient(PLAIN, base.unit)
    factors = [base.unit if power > 0 else inverse] * abs(int(power))
    unit = reduce(product, factors, PLAIN)
    if base.constant is not None:
        return Quantity(constant=_folded(op, [base.constant, power], span), unit=unit)
    return Quantity(rv.Arithmetic(op, (node_of(args[0]), rv.Literal(int(power)))), unit=unit)


def _folded(op: NumericOp, constants: Sequence[Fraction], span: Span) -> Fraction:
    """The result of an operation on constants, refused if it needs more than 4096 bits."""
    whole = op.entry.unit is UnitRule.BITS
    value = Fraction(op.entry.apply(*(map(int, constants) if whole else constants)))
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > 4096:
        raise Refusal(rules.out_of_range(span))
    return value


def _scale(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    (left, _), (right, _) = args
    multiply = op.entry.unit is UnitRule.PRODUCT
    unit = (product if multiply else quotient)(left.unit, right.unit)
    if left.constant is not None and right.constant is not None:
        constants = (left.constant, right.constant)
        return Quantity(constant=_folded(op, constants, span), unit=unit)
    if not multiply and right.constant == 0:
        raise Refusal(rules.out_of_range(span))
    node = rv.Arithmetic(op, tuple(map(node_of, args)))
    return Quantity(node, unit=unit, integral=_is_whole(op, args))


def _root(op: NumericOp, placed: Placed, span: Span) -> Quantity:
    """The square root, computed in base units, as the factor of a unit may have no exact root."""
    value, place = placed
    unit = root(value.unit)
    if unit is None:
        raise Refusal(rules.no_root(place, value.unit.symbol))
    squared = base_unit(dict(value.unit.dimension))
    if value.constant is not None:
        exact = _exact(value, squared)
        if exact < 0:
            raise Refusal(rules.out_of_range(span))
        return Quantity(constant=_folded(op, [exact], span), unit=unit)
    return Quantity(rv.Arithmetic(op, _nodes((placed,), squared)), unit=unit)


def _common_unit(args: Sequence[Placed], doing: str, span: Span) -> Unit:
    """The unit to which values are converted: that of the first value that is not a constant.

    If all are constants, it is that of the first with a unit. `doing` is a word for findings.
    """
    varying = [value.unit for value, _ in args if value.constant is None]
    named = [value.unit for value, _ in args if value.unit.symbol]
    unit = (varying or named or [PLAIN])[0]
    for value, place in args:
        if value.unit.dimension == unit.dimension or _bare_zero(value):
            continue
        if value.constant is not None and not value.unit.symbol:
            raise Refusal(rules.missing_unit(place, unit.symbol))
        if not unit.symbol:
            other = next(p for v, p in args if v.constant is None)
            raise Refusal(rules.superfluous_unit(place, value.unit.symbol, short(other.text)))
        shown = [v.unit.symbol or "no unit" for v, _ in args if not _bare_zero(v)]
        raise Refusal(rules.mismatch(span, shown[0], shown[-1], doing))
    return unit


def _bare_zero(value: Quantity) -> bool:
    return value.constant == 0 and not value.unit.symbol


def _is_whole(op: NumericOp, args: Sequence[Placed]) -> bool:
    return op.entry.whole and all(_is_integral(value) for value, _ in args)


def _is_integral(value: Quantity) -> bool:
    return value.integral if value.constant is None else value.constant.denominator == 1


def _exact(value: Quantity, unit: Unit) -> Fraction:
    """The value of a constant in another unit of the same dimension."""
    return (value.constant or Fraction(0)) * value.unit.factor / unit.factor


def _nodes(args: Sequence[Placed], unit: Unit) -> tuple[rv.Numeric, ...]:
    """All values in `unit`; constants are ints if possible where all others are, else floats."""
    whole = all(value.integral for value, _ in args if value.constant is None)
    return tuple(_node(value, unit, whole, place) for value, place in args)


def _node(value: Quantity, unit: Unit, whole: bool, place: Span) -> rv.Numeric:
    if value.node is not None:
        factor = value.unit.factor / unit.factor
        if factor == 1:
            return value.node
        return rv.Arithmetic(NumericOp.MUL, (value.node, rv.Literal(float(factor))))
    exact = _exact(value, unit)
    if whole and exact.denominator == 1:
        return rv.Literal(int(exact), unit.symbol)
    try:
        return rv.Literal(float(exact), unit.symbol)
    except OverflowError:
        raise Refusal(rules.out_of_range(place)) from None


MOST_OUTCOMES = 64  # the most numbers between which an expression may choose


def for_each_outcome(
    values: Sequence[Value], span: Span, make: Callable[[Sequence[Value]], Value]
) -> Value:
    """Apply `make` to values; for values that are choices, to each combination of outcomes.

    Raises:
        Refusal: there are too many outcomes, or `make` raises it.
    """
    if prod(map(_outcomes, values)) > MOST_OUTCOMES:
        raise Refusal(rules.many_outcomes(span, MOST_OUTCOMES))
    return _per_outcome(values, make)


def _outcomes(value: Value) -> int:
    if isinstance(value, Chosen):
        return _outcomes(value.chosen) + _outcomes(value.otherwise)
    return 1


def _per_outcome(values: Sequence[Value], make: Callable[[Sequence[Value]], Value]) -> Value:
    for number, value in enumerate(values):
        if isinstance(value, Chosen):
            before, behind = values[:number], values[number + 1 :]
            sides = [
                _per_outcome((*before, side, *behind), make)
                for side in (value.chosen, value.otherwise)
            ]
            return Chosen(value.condition, *sides)
    return make(values)


def joined(value: Value, span: Span) -> rv.Formula:
    """A choice between formulas, as one formula."""
    if isinstance(value, Chosen):
        chosen, otherwise = joined(value.chosen, span), joined(value.otherwise, span)
        return if_then_else(value.condition, chosen, otherwise, span)
    assert not isinstance(value, Quantity | TimeValue), "it was made of formulas"
    return value


def if_then_else(
    condition: rv.Formula, chosen: rv.Formula, otherwise: rv.Formula, span: Span
) -> rv.Formula:
    """The formula `if φ then ψ else χ`."""
    # The last disjunct makes it known where both sides are true though the condition is unknown.
    make, denied = Formulas(span), rv.Unary(rv.UnaryOp.NOT, condition, None, span)
    one = make.either(make.both(condition, chosen), make.both(denied, otherwise))
    return make.either(one, make.both(chosen, otherwise))


_SECOND = (("s", 1),)


def ticks_of(value: Value, span: Span) -> int:
    """A constant duration in whole ticks; 0 needs no unit.

    Raises:
        Refusal: it is not a constant duration, not a whole number of ticks, negative, or too long.
    """
    if not isinstance(value, Quantity) or value.constant is None:
        moves = isinstance(value, Quantity) and is_time(value)
        raise Refusal((rules.moving if moves else rules.no_duration)(span))
    if not is_time(value) and value.constant != 0:
        raise Refusal(rules.no_duration(span, plain=not value.unit.symbol))
    ticks: Fraction = value.constant * value.unit.factor * TICKS_PER_SECOND
    if ticks.denominator != 1:
        raise Refusal(rules.part_of_tick(span))
    if ticks < 0:
        raise Refusal(rules.negative(span))
    if ticks >= TIME_LIMIT:
        raise Refusal(rules.too_long(span))
    return int(ticks)


def is_time(value: Quantity) -> bool:
    """Whether a quantity has a unit of time."""
    return value.unit.dimension == _SECOND


def closed_interval(
    low: int, high: int | None, *, low_open: bool, high_open: bool, span: Span
) -> rv.Interval:
    """The closed interval of ticks equal to one with open or closed ends.

    Raises:
        Refusal: no tick lies in it.

    >>> from rvmon.diagnostics import Source
    >>> closed_interval(2, 5, low_open=True, high_open=False, span=Span(Source("", ""), 0, 0))
    Interval(low=3, high=5)
    """
    first = low + low_open
    last = None if high is None else high - high_open
    if last is not None and last < first:
        raise Refusal(rules.empty(span))
    return rv.Interval(first, last)


def seconds_of(duration: Placed) -> rv.Numeric:
    """A duration, constant or data, as a number in seconds.

    Raises:
        Refusal: it is not a duration.
    """
    if duration[0].constant is not None:
        ticks_of(*duration)
    return converted(parse_unit("s"), duration, duration[1])


def converted(unit: Unit, placed: Placed, span: Span) -> rv.Numeric:
    """A number converted to a unit as the right side of a comparison is.

    Raises:
        Refusal: the units do not fit, or a constant is out of range.
    """
    compared = compare(
        rv.CompareOp.GE, (Quantity(rv.SignalValue(""), unit=unit), span), placed, span
    )
    assert isinstance(compared, rv.Compare), "one side varies"
    return compared.right
