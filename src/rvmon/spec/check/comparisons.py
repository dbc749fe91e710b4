"""Comparisons: numbers, labels beside their signal, ages, and durations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil, floor

from rvmon.diagnostics import Diagnostic, Span
from rvmon.spec.check.quantities import (
    Placed,
    arithmetic,
    compare,
    decided,
    either,
    node_of,
    seconds_of,
    spread,
    ticks_of,
)
from rvmon.spec.check.scope import (
    Age,
    Ago,
    AmountOf,
    Beside,
    Chosen,
    Extreme,
    Moment,
    Now,
    Operands,
    Quantity,
    Scope,
    Value,
)
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.classify import reads_field
from rvmon.spec.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
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
    itself,
    passed,
)
from rvmon.spec.checked.measured import Dimension
from rvmon.spec.checked.names_read import names_in
from rvmon.spec.rules import Refusal
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import types as rules
from rvmon.spec.syntax.expressions import Comparison, Expression, Name
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.units import PLAIN, Unit, parse_unit, product

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
    op, places = node.op, (node.left.span, node.right.span)
    if isinstance(right, Beside) and not isinstance(left, Beside):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, Moment) and isinstance(right, Now):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, Now):
        return _now(left, op, right, places[1], node.span)
    limit = _comparable(right, places[1])
    match left:
        case Age():
            return _age(left, op, limit, node.span)
        case AmountOf():
            return _amount(left, op, limit, node.span)
        case Extreme():
            return _extreme(left, op, limit, node.span)
        case Ago():
            return _ago(left, op, limit, node.span)
        case _:
            return _quantities(op, _comparable(left, places[0]), limit, node.span)


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
    """All comparisons are made of `>= c` and `> c`."""
    counted = amount.added is None and limit[0].constant is not None
    make = _counted if counted else _added
    up, above = (make(amount, limit, strict, span) for strict in (False, True))
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


def _counted(amount: AmountOf, limit: Placed, strict: bool, span: Span) -> Formula:
    """A count or duration beside a constant, in whole numbers: `> c` is `>= floor(c) + 1`."""
    value, place = limit
    exact = (value.constant or 0) * value.unit.factor
    if amount.share or amount.measured is Measured.COUNT:
        if value.unit.dimension:
            raise Refusal(rules.mismatch(span, "no unit", value.unit.symbol, "compared with"))
        exact *= amount.window or 1 if amount.share else 1
    else:
        exact = Fraction(ticks_of(value, place))
    least = floor(exact) + 1 if strict else ceil(exact)
    if least <= 0:
        return Constant(True, span)
    return _of(amount, Literal(least), span)


def _of(amount: AmountOf, limit: Numeric, span: Span) -> Amount:
    """What is measured beside a limit, but for numbers."""
    return Amount(
        *(amount.measured, amount.operand, amount.window, limit),
        span=span,
        most=amount.most,
        counted=amount.counted,
        chosen=amount.chosen,
    )


_SECONDS = parse_unit("s")


def _unit_of(measured: Measured, unit: Unit) -> Unit:
    """The unit of what is measured of numbers."""
    match measured.dimension:
        case Dimension.PLAIN:
            return PLAIN
        case Dimension.TIMES_TIME | Dimension.TIME:
            return product(unit, _SECONDS)
        case Dimension.SQUARE:
            return product(unit, unit)
        case Dimension.SAME:
            return unit


def _added(amount: AmountOf, limit: Placed, strict: bool, span: Span) -> Formula:
    """Members beside any number that does not move between samples.

    A duration beside one is the integral of 1.
    """
    value, place = limit
    if value.node is not None and reads_field(value.node):
        raise Refusal(rules.limit_of_event(place))
    one = Quantity(constant=Fraction(1))
    added = amount.added or one
    unit = _unit_of(amount.measured, added.unit)
    if amount.share:
        window = Quantity(constant=Fraction(amount.window or 0, TICKS_PER_SECOND), unit=_SECONDS)
        limit = arithmetic(NumericOp.MUL, (limit, (window, place)), span), place
    if amount.measured is Measured.DURATION:
        amount = replace(amount, measured=Measured.INTEGRAL, added=one)
    whole = Quantity(SignalValue(""), unit=unit)
    beside = compare(CompareOp.GE, (whole, span), limit, span)
    if not isinstance(beside, Compare):
        raise AssertionError("one side varies")
    bound = beside.right
    return replace(
        _of(amount, bound, span),
        value=None if amount.added is None else node_of((amount.added, span)),
        strict=strict,
        known=None if isinstance(bound, Literal) else itself(bound, place),
    )


def _ago(ago: Ago, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """It is that comparison D ago: false where there was no such instant."""
    bound = limit[0].node
    if bound is not None and any(names_in(bound)):
        raise Refusal(rules.extreme_alone(span))
    then = compare(op, (ago.quantity, ago.span), limit, span)
    return Unary(UnaryOp.ONCE, then, Interval(ago.window, ago.window), span)


def _extreme(extreme: Extreme, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """`max(x, D) <= c` is: `x <= c` all through the last D; `max(x, D) >= c`: at some instant."""
    bound = limit[0].node
    if bound is not None and any(names_in(bound)):
        raise Refusal(rules.extreme_alone(span))
    every = (CompareOp.LT, CompareOp.LE) if extreme.greatest else (CompareOp.GT, CompareOp.GE)

    def over(how: CompareOp) -> Formula:
        if how in every and (extreme.begun or extreme.updated):
            return Unary(UnaryOp.NOT, over(how.denied), None, span)
        one: Formula = compare(how, (extreme.quantity, extreme.span), limit, span)
        if extreme.updated is not None:
            counted = AmountOf(
                Measured.COUNT, extreme.updated, None, most=extreme.most, counted=one
            )
            return _of(counted, Literal(1), span)
        whole = UnaryOp.HISTORICALLY if how in every else UnaryOp.ONCE
        if extreme.begun is not None:
            one = Binary(BinaryOp.AND, extreme.begun, one, None, span)
        return Unary(whole, one, Interval(0, extreme.window), span)

    if op not in _EQUALITY:
        return over(op)
    same = Binary(BinaryOp.AND, over(CompareOp.LE), over(CompareOp.GE), None, span)
    return same if op is CompareOp.EQ else Unary(UnaryOp.NOT, same, None, span)


def alone(value: Beside, span: Span) -> Diagnostic:
    """What is wrong with what stands alone and may not."""
    match value:
        case Age():
            return rules.age_alone(span)
        case Now() | Moment():
            return rules.now_alone(span)
        case AmountOf():
            return rules.amount_alone(span)
        case Extreme() | Ago():
            return rules.extreme_alone(span)


def formula_of(value: Value, span: Span) -> Formula:
    """The value as a formula.

    Raises:
        Refusal: it is a number or label.
    """
    if isinstance(value, Beside):
        raise Refusal(alone(value, span))
    match value:
        case Quantity(node=SignalValue(name=name), truth=True):
            return SignalAtom(name, span)
        case Quantity(node=node, truth=True) if node is not None:
            return Compare(CompareOp.EQ, node, Literal(True), span)
        case Quantity(labels=labels):
            raise Refusal(rules.needs_formula(span, "a label" if labels else "a number"))
        case Chosen(condition=condition, chosen=chosen, otherwise=otherwise):
            return either(condition, formula_of(chosen, span), formula_of(otherwise, span), span)
        case _:
            return value


def number_of(value: Value, span: Span) -> Quantity:
    """The value as a number.

    Raises:
        Refusal: it is a formula or label.
    """
    if isinstance(value, Beside):
        raise Refusal(alone(value, span))
    match value:
        case Quantity(truth=False, labels=()):
            return value
        case Quantity(truth=False):
            raise Refusal(rules.label_use(span))
        case Chosen():
            raise Refusal(rules.choice_alone(span))
        case _:
            raise Refusal(rules.needs_number(span))


def _comparable(value: Value, span: Span) -> Placed:
    if isinstance(value, Beside):
        raise Refusal(alone(value, span))
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


def moved(op: NumericOp, values: Sequence[Value]) -> Now | Moment | None:
    """`now - t0`, `t0 + x`, `x + t0`, `t0 - x`; `None`: something else."""
    match op, values:
        case NumericOp.SUB, [Now(since=None), Moment(name=name, later=None)]:
            return Now(name)
        case NumericOp.ADD, [Moment(name=name, later=None), Quantity() as later]:
            return Moment(name, later)
        case NumericOp.ADD, [Quantity() as later, Moment(name=name, later=None)]:
            return Moment(name, later)
    return None


def _now(now: Now, op: CompareOp, limit: Value, place: Span, span: Span) -> Formula:
    """`now >= D` is: there was an instant D ago, or earlier; others look at data for how long."""
    if isinstance(limit, Moment) and now.since is None:
        later = Quantity(constant=Fraction(0)) if limit.later is None else limit.later
        now, limit = Now(limit.name), later
    value, _ = _comparable(limit, place)
    if value.node is not None and reads_field(value.node):
        raise Refusal(rules.limit_of_event(place))
    if op in _EQUALITY:
        raise Refusal(rules.now_alone(span))
    strict = op in (CompareOp.GT, CompareOp.LE)
    late = op in (CompareOp.GT, CompareOp.GE)
    if now.since is None and value.constant is not None:
        ticks = ticks_of(value, place) + strict
        begun: Formula = Unary(UnaryOp.ONCE, Constant(True, span), Interval(ticks), span)
    else:
        begun = passed(now.since, seconds_of((value, place)), strict, span)
    return begun if late else Unary(UnaryOp.NOT, begun, None, span)


def _age(age: Age, op: CompareOp, limit: Placed, span: Span) -> Formula:
    """`age(x) > D` is: neither an update within the last D, nor the beginning of the trace.

    In whole ticks, `>= D` is `> D - 1 tick`.
    """
    if op in _EQUALITY:
        raise Refusal(rules.age_alone(span))
    ticks = ticks_of(*limit)
    window = ticks if op in (CompareOp.GT, CompareOp.LE) else ticks - 1
    older = op in (CompareOp.GT, CompareOp.GE)
    if window < 0:
        return Constant(older, span)
    updated = ProbeAtom(Probe.UPDATED, age.name, span)
    begun = Binary(BinaryOp.OR, updated, BoundAtom(Bound.START, span), None, span)
    recent = Unary(UnaryOp.ONCE, begun, Interval(0, window), span)
    return Unary(UnaryOp.NOT, recent, None, span) if older else recent
