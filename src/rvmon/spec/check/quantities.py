"""Arithmetic and comparison of quantities: constants exactly, units converted."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rvmon.diagnostics.span import Span
from rvmon.spec.check.values import Quantity
from rvmon.spec.checked.arithmetic import NumericOp, UnitRule
from rvmon.spec.checked.formula import Arithmetic, Compare, CompareOp, Constant, Literal, Numeric
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal
from rvmon.units import PLAIN, Unit, base_unit, product, quotient, root

Placed = tuple[Quantity, Span]
"""A quantity with the place of its expression."""

_DOING = {NumericOp.ADD: "added to", NumericOp.SUB: "reduced by"}


def compare(op: CompareOp, left: Placed, right: Placed, span: Span) -> Compare | Constant:
    """Compare numbers in the unit of the first side that is no constant.

    Raises:
        Refusal: the units do not fit, or a constant is out of range.
    """
    sides = (left, right)
    unit = _common_unit(sides, "compared with", span)
    if left[0].constant is not None and right[0].constant is not None:
        exact = [_exact(value, unit) for value, _ in sides]
        return Constant(op.holds(*exact), span)
    first, second = _nodes(sides, unit)
    return Compare(op, first, second, span)


def arithmetic(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    """Apply an operation.

    Raises:
        Refusal: the units do not fit, or a constant is out of range.
    """
    try:
        match op.entry.unit:
            case UnitRule.PRODUCT | UnitRule.QUOTIENT:
                return _scale(op, args, span)
            case UnitRule.ROOT:
                return _root(op, args[0], span)
            case UnitRule.SAME:
                return _alike(op, args, span)
    except (ZeroDivisionError, OverflowError):
        raise Refusal(rules.out_of_range(span)) from None


def node_of(placed: Placed) -> Numeric:
    """What yields the quantity at run time, in its own unit.

    Raises:
        Refusal: a constant that is out of range.
    """
    return _nodes((placed,), placed[0].unit)[0]


def _alike(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    """Operations on values of one unit, which is that of the result."""
    unit = _common_unit(args, _DOING.get(op, "beside"), span)
    constants = [_exact(value, unit) for value, _ in args if value.constant is not None]
    if len(constants) == len(args):
        return Quantity(constant=_folded(op, constants, span), unit=unit)
    node = Arithmetic(op, _nodes(args, unit))
    return Quantity(node, unit=unit, integral=_is_whole(op, args))


def _folded(op: NumericOp, constants: Sequence[Fraction], span: Span) -> Fraction:
    """The result for constants, which stay within what is written in a few hundred digits."""
    value = Fraction(op.entry.apply(*constants))
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > 4096:
        raise Refusal(rules.out_of_range(span))
    return value


def _scale(op: NumericOp, args: Sequence[Placed], span: Span) -> Quantity:
    """Products and quotients."""
    (left, _), (right, _) = args
    multiply = op.entry.unit is UnitRule.PRODUCT
    unit = (product if multiply else quotient)(left.unit, right.unit)
    if left.constant is not None and right.constant is not None:
        constants = (left.constant, right.constant)
        return Quantity(constant=_folded(op, constants, span), unit=unit)
    if not multiply and right.constant == 0:
        raise Refusal(rules.out_of_range(span))
    node = Arithmetic(op, tuple(map(node_of, args)))
    return Quantity(node, unit=unit, integral=_is_whole(op, args))


def _root(op: NumericOp, placed: Placed, span: Span) -> Quantity:
    """The square root, taken in base units, since a factor need not have an exact root."""
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
    return Quantity(Arithmetic(op, _nodes((placed,), squared)), unit=unit)


def _common_unit(args: Sequence[Placed], doing: str, span: Span) -> Unit:
    """The unit that values are brought to: that of the first that is no constant."""
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
            raise Refusal(rules.superfluous_unit(place, value.unit.symbol, other))
        shown = [v.unit.symbol or "no unit" for v, _ in args if not _bare_zero(v)]
        raise Refusal(rules.mismatch(span, shown[0], shown[-1], doing))
    return unit


def _bare_zero(value: Quantity) -> bool:
    return value.constant == 0 and not value.unit.symbol


def _is_whole(op: NumericOp, args: Sequence[Placed]) -> bool:
    """Whether only whole numbers come in, and go out."""
    return op.entry.whole and all(
        value.integral if value.constant is None else value.constant.denominator == 1
        for value, _ in args
    )


def _exact(value: Quantity, unit: Unit) -> Fraction:
    """The value of a constant in another unit of its kind."""
    return (value.constant or Fraction(0)) * value.unit.factor / unit.factor


def _nodes(args: Sequence[Placed], unit: Unit) -> tuple[Numeric, ...]:
    """All values in `unit`; constants as whole numbers beside whole numbers, else as floats."""
    whole = all(value.integral for value, _ in args if value.constant is None)
    return tuple(_node(value, unit, whole, place) for value, place in args)


def _node(value: Quantity, unit: Unit, whole: bool, place: Span) -> Numeric:
    if value.node is not None:
        factor = value.unit.factor / unit.factor
        if factor == 1:
            return value.node
        return Arithmetic(NumericOp.MUL, (value.node, Literal(float(factor))))
    exact = _exact(value, unit)
    if whole and exact.denominator == 1:
        return Literal(int(exact), unit.symbol)
    try:
        return Literal(float(exact), unit.symbol)
    except OverflowError:
        raise Refusal(rules.out_of_range(place)) from None
