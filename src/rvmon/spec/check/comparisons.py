"""Comparisons: numbers, labels beside their signal, ages, and durations."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from rvmon.diagnostics.span import Span
from rvmon.spec.check.choices import decided, spread
from rvmon.spec.check.operands import Operands
from rvmon.spec.check.quantities import Placed, compare
from rvmon.spec.check.values import Age, AmountOf, Extreme, Quantity, Scope, Value
from rvmon.spec.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    Constant,
    Formula,
    Interval,
    Literal,
    Measured,
    Probe,
    ProbeAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.reads import names_in
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import time as time_rules
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal
from rvmon.spec.syntax.expressions import Comparison, Expression, Name
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT

_SECOND = (("s", 1),)


def ticks_of(value: Value, span: Span) -> int:
    """A constant with a unit of time, exactly; 0 needs no unit.

    Raises:
        Refusal: it is no such constant, no whole number of ticks, negative, or too long.
    """
    if not isinstance(value, Quantity) or value.constant is None:
        raise Refusal(time_rules.no_duration(span))
    if value.unit.dimension != _SECOND and value.constant != 0:
        raise Refusal(time_rules.no_duration(span, plain=not value.unit.symbol))
    ticks: Fraction = value.constant * value.unit.factor * TICKS_PER_SECOND
    if ticks.denominator != 1:
        raise Refusal(time_rules.part_of_tick(span))
    if ticks < 0:
        raise Refusal(time_rules.negative(span))
    if ticks >= TIME_LIMIT:
        raise Refusal(time_rules.too_long(span))
    return int(ticks)


def closed_interval(
    low: int, high: int | None, *, low_open: bool, high_open: bool, span: Span
) -> Interval:
    """The closed interval of ticks with these ends.

    Raises:
        Refusal: no tick lies in it.

    >>> from rvmon.diagnostics.span import Source
    >>> closed_interval(2, 5, low_open=True, high_open=False, span=Span(Source("", ""), 0, 0))
    Interval(low=3, high=5)
    """
    first = low + low_open
    last = None if high is None else high - high_open
    if last is not None and last < first:
        raise Refusal(time_rules.empty(span))
    return Interval(first, last)


_EQUALITY = (CompareOp.EQ, CompareOp.NE)


def compared(operands: Operands, node: Comparison, scope: Scope) -> Formula:
    """What a comparison stands for.

    Raises:
        Refusal: the sides cannot be compared.
        Reported: a side is wrong.
    """
    sides = _sides(operands, node, scope)
    return decided(spread(sides, node.span, lambda values: _compared(node, *values)), node.span)


def _compared(node: Comparison, left: Value, right: Value) -> Formula:
    if isinstance(left, Age):
        limit = _comparable(right, node.right.span)
        return _age(left, node.op, limit, node.span)
    if isinstance(right, Age):
        limit = _comparable(left, node.left.span)
        return _age(right, node.op.mirrored, limit, node.span)
    if isinstance(left, AmountOf):
        return _amount(left, node.op, _comparable(right, node.right.span), node.span)
    if isinstance(right, AmountOf):
        return _amount(right, node.op.mirrored, _comparable(left, node.left.span), node.span)
    if isinstance(left, Extreme):
        return _extreme(left, node.op, _comparable(right, node.right.span), node.span)
    if isinstance(right, Extreme):
        return _extreme(right, node.op.mirrored, _comparable(left, node.left.span), node.span)
    first = _comparable(left, node.left.span)
    second = _comparable(right, node.right.span)
    return _quantities(node.op, first, second, node.span)


def _sides(operands: Operands, node: Comparison, scope: Scope) -> list[Value]:
    """Both values; a name that is a label of the other side's signal is that label."""
    for first, second in ((node.left, node.right), (node.right, node.left)):
        name, place = operands.peeled(second, scope)
        other, _ = operands.peeled(first, scope)
        if not isinstance(name, Name) or not _may_be_signal(operands, other, scope):
            continue
        value = operands.values((first,), scope)[0]
        if not isinstance(value, Quantity) or not value.labels:
            continue
        if name.text in value.labels:
            label = Quantity(Literal(name.text), labels=value.labels)
            return [value, label] if first is node.left else [label, value]
        if not operands.known(name.text, place):
            raise Refusal(name_rules.unknown_label(name.span, name.text, value.labels))
    return operands.values((node.left, node.right), scope)


def _may_be_signal(operands: Operands, expression: Expression, scope: Scope) -> bool:
    """Whether evaluating it is worth while in search of a signal with labels."""
    return not isinstance(expression, Name) or operands.known(expression.text, scope)


def _amount(amount: AmountOf, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """All comparisons are made of `>= n`, which grows with what there is."""
    value, place = limit
    if value.constant is None:
        raise Refusal(rules.amount_alone(span))
    exact = value.constant * value.unit.factor
    if amount.share or amount.measured is Measured.COUNT:
        if value.unit.dimension:
            raise Refusal(rules.mismatch(span, "no unit", value.unit.symbol, "compared with"))
        exact *= amount.window if amount.share else 1
    else:
        exact = Fraction(ticks_of(value, place))

    def at_least(least: int) -> Formula:
        if least <= 0:
            return Constant(True, span)
        return Amount(amount.measured, amount.operand, amount.window, least, span)

    up, above = at_least(ceil(exact)), at_least(floor(exact) + 1)
    match op:
        case CompareOp.GE:
            return up
        case CompareOp.GT:
            return above
        case CompareOp.LT:
            return Unary(UnaryOp.NOT, up, None, span)
        case CompareOp.LE:
            return Unary(UnaryOp.NOT, above, None, span)
    same = Binary(BinaryOp.AND, up, Unary(UnaryOp.NOT, above, None, span), None, span)
    return same if op is CompareOp.EQ else Unary(UnaryOp.NOT, same, None, span)


def _extreme(extreme: Extreme, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """`max(x, D) <= c` is: `x <= c` all through the last D; `max(x, D) >= c`: at some instant."""
    bound = limit[0].node
    if bound is not None and any(names_in(bound)):
        raise Refusal(rules.extreme_alone(span))
    every = (CompareOp.LT, CompareOp.LE) if extreme.greatest else (CompareOp.GT, CompareOp.GE)

    def over(how: CompareOp) -> Formula:
        one = compare(how, (extreme.quantity, extreme.span), limit, span)
        whole = UnaryOp.HISTORICALLY if how in every else UnaryOp.ONCE
        return Unary(whole, one, Interval(0, extreme.window), span)

    if op not in _EQUALITY:
        return over(op)
    same = Binary(BinaryOp.AND, over(CompareOp.LE), over(CompareOp.GE), None, span)
    return same if op is CompareOp.EQ else Unary(UnaryOp.NOT, same, None, span)


def _comparable(value: Value, span: Span) -> Placed:
    if isinstance(value, AmountOf):
        raise Refusal(rules.amount_alone(span))
    if isinstance(value, Extreme):
        raise Refusal(rules.extreme_alone(span))
    if isinstance(value, Age):
        raise Refusal(rules.age_alone(span))
    if not isinstance(value, Quantity) or value.truth:
        raise Refusal(rules.compared_truth(span))
    return value, span


def _quantities(op: CompareOp, left: Placed, right: Placed, span: Span) -> Compare | Constant:
    (first, first_span), (second, second_span) = left, right
    if not first.labels and not second.labels:
        return compare(op, left, right, span)
    if op not in _EQUALITY:
        raise Refusal(rules.label_use(first_span if first.labels else second_span))
    if not (first.labels and second.labels) or first.node is None or second.node is None:
        raise Refusal(rules.label_use(first_span if first.labels else second_span))
    return Compare(op, first.node, second.node, span)


def _age(age: Age, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """`age(x) > D` is: no update within the last D. In whole ticks, `>= D` is `> D - 1 tick`."""
    if op in _EQUALITY:
        raise Refusal(rules.age_alone(span))
    ticks = ticks_of(*limit)
    window = ticks if op in (CompareOp.GT, CompareOp.LE) else ticks - 1
    older = op in (CompareOp.GT, CompareOp.GE)
    if window < 0:
        return Constant(older, span)
    updated = ProbeAtom(Probe.UPDATED, age.name, span)
    recent = Unary(UnaryOp.ONCE, updated, Interval(0, window), span)
    return Unary(UnaryOp.NOT, recent, None, span) if older else recent
