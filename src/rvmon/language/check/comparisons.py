"""Comparisons: numbers, labels with their signal, ages, and durations."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil

from rvmon.diagnostics import Diagnostic, Span
from rvmon.language.check import quantities
from rvmon.language.check.moving_windows import above, brought_alone, by_limits
from rvmon.language.check.scope import (
    Age,
    Chosen,
    Lone,
    Moment,
    Now,
    Operands,
    Quantity,
    Scope,
    TimeValue,
    Value,
)
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import (
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
    WindowValue,
    fields_in,
    passed,
    windows_in,
)
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.specification import TimeModel
from rvmon.language.rules import Refusal
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import types as rules
from rvmon.language.syntax.expressions import Comparison, Expression, Name
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.units import Unit, parse_unit

_EQUALITY = (CompareOp.EQ, CompareOp.NE)


def compared(operands: Operands, node: Comparison, scope: Scope) -> Formula:
    """The formula of a comparison.

    Raises:
        Refusal: the sides cannot be compared.
        Reported: a side is wrong.
    """
    sides = _sides(operands, node, scope)
    time = operands.table.time
    formulas = quantities.spread(sides, node.span, lambda values: _compared(time, node, *values))
    return quantities.decided(formulas, node.span)


def _compared(time: TimeModel, node: Comparison, left: Value, right: Value) -> Formula:
    op, places = node.op, (node.left.span, node.right.span)
    # Ages and `now` are moved to the left side, which halves the cases below.
    if isinstance(right, TimeValue) and not isinstance(left, TimeValue):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, Moment) and isinstance(right, Now):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, Now):
        return _now(left, op, right, places[1], node.span)
    limit = _comparable(right, places[1])
    if isinstance(left, Age):
        return _age(left, op, limit, node.span)
    first = _comparable(left, places[0])
    if limit[0].lone and not first[0].lone:
        first, limit, op = limit, first, op.mirrored
    # A window compared alone is compared exactly, in ticks or whole numbers; within an expression
    # it is a rounded number (SEMANTICS 5).
    windows = [_windows_of(side) for side in (first, limit)]
    if first[0].lone and not windows[1]:
        lone = first[0].lone
        if not lone.of.measured.recalls:
            return _amount(lone, first[0].unit, op, limit, node.span)
        if (extreme := _extreme(lone, op, limit, node.span)) is not None:
            return extreme
    comparison = _quantities(op, first, limit, node.span)
    if not any(windows) or not isinstance(comparison, Compare):
        return comparison
    if any(fields_in(comparison.left, comparison.right)):
        raise Refusal(rules.limit_of_event(node.span))
    if time is TimeModel.HELD and any(window.moves for window in (*windows[0], *windows[1])):
        return brought_alone(comparison, node.span)
    return comparison


def _windows_of(placed: quantities.Placed) -> tuple[WindowValue, ...]:
    node = placed[0].node
    return () if node is None else windows_in(node)


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


def _amount(lone: Lone, unit: Unit, op: CompareOp, limit: quantities.Placed, span: Span) -> Formula:
    if lone.added is None and limit[0].constant is not None:
        return by_limits(op, lambda strict: _counted(lone, limit, strict, span), span)
    bound = _bound(lone, unit, limit, span)
    return by_limits(op, lambda strict: above(lone.of, bound, strict, span), span)


def _counted(lone: Lone, limit: quantities.Placed, strict: bool, span: Span) -> Formula:
    """A comparison of a count or duration with a constant, in whole numbers."""
    value, place = limit
    exact = (value.constant or 0) * value.unit.factor
    if lone.share or lone.of.measured is Measured.COUNT:
        if value.unit.dimension:
            raise Refusal(rules.mismatch(span, "no unit", value.unit.symbol, "compared with"))
        exact *= lone.of.window or 1 if lone.share else 1
    else:
        exact = Fraction(quantities.ticks_of(value, place))
    # A count is whole: more than 2.5 is at least 3.
    if exact.denominator > 1:
        exact, strict = Fraction(ceil(exact)), False
    always = exact < 0 if strict else exact <= 0
    return Constant(True, span) if always else Amount(lone.of, Literal(int(exact)), strict, span)


def _bound(lone: Lone, unit: Unit, limit: quantities.Placed, span: Span) -> Numeric:
    """A limit that does not move between samples, in the unit of what is measured."""
    value, place = limit
    if value.node is not None and any(fields_in(value.node)):
        raise Refusal(rules.limit_of_event(place))
    if lone.share:
        unit = parse_unit("s")
        whole = Quantity(constant=Fraction(lone.of.window or 0, TICKS_PER_SECOND), unit=unit)
        limit = quantities.arithmetic(NumericOp.MUL, (limit, (whole, place)), span), place
    return quantities.brought_to(unit, limit, span)


def _extreme(lone: Lone, op: CompareOp, limit: quantities.Placed, span: Span) -> Formula | None:
    """`max(x, D) <= c` is: `x <= c` all through the last D; `max(x, D) >= c`: at some instant.

    `ago(x, D) <= c` is that comparison D ago: false where there was no such instant. `None`: it is
    beside what changes, and looked at as a number.
    """
    bound, added = limit[0].node, lone.added
    if added is None or (bound is not None and any(names_in(bound))):
        return None
    of = lone.of
    if of.measured is Measured.AGO:
        then = quantities.compare(op, (added, span), limit, span)
        return Unary(UnaryOp.ONCE, then, Interval(of.window or 0, of.window), span)
    greatest = of.measured is Measured.MAX
    every = (CompareOp.LT, CompareOp.LE) if greatest else (CompareOp.GT, CompareOp.GE)
    occurs = added.node is not None and any(fields_in(added.node))

    def over(how: CompareOp) -> Formula:
        # Without members, `all` is true of any limit, but a comparison of a field is false where
        # its event does not occur. So "all are" is written as "none is not".
        if how in every and (lone.begun or of.most or occurs):
            return Unary(UnaryOp.NOT, over(how.denied), None, span)
        one: Formula = quantities.compare(how, (added, span), limit, span)
        if of.most is not None:
            counted = WindowValue(Measured.COUNT, of.operand, None, most=of.most, counted=one)
            return Amount(counted, Literal(1), span=span)
        whole = UnaryOp.HISTORICALLY if how in every else UnaryOp.ONCE
        if lone.begun is not None:
            one = Binary(BinaryOp.AND, lone.begun, one, None, span)
        return Unary(whole, one, Interval(0, of.window), span)

    if op not in _EQUALITY:
        return over(op)
    same = Binary(BinaryOp.AND, over(CompareOp.LE), over(CompareOp.GE), None, span)
    return same if op is CompareOp.EQ else Unary(UnaryOp.NOT, same, None, span)


def alone(value: TimeValue, span: Span) -> Diagnostic:
    """The finding for a value of time that is no side of a comparison."""
    match value:
        case Age():
            return rules.age_alone(span)
        case Now() | Moment():
            return rules.now_alone(span)


def formula_of(value: Value, span: Span) -> Formula:
    """The value as a formula.

    Raises:
        Refusal: it is a number or label.
    """
    if isinstance(value, TimeValue):
        raise Refusal(alone(value, span))
    match value:
        case Quantity(node=SignalValue(name=name), truth=True):
            return SignalAtom(name, span)
        case Quantity(node=node, truth=True) if node is not None:
            return Compare(CompareOp.EQ, node, Literal(True), span)
        case Quantity(labels=labels):
            raise Refusal(rules.needs_formula(span, "a label" if labels else "a number"))
        case Chosen(condition=condition, chosen=chosen, otherwise=otherwise):
            return quantities.either(
                condition, formula_of(chosen, span), formula_of(otherwise, span), span
            )
        case _:
            return value


def number_of(value: Value, span: Span) -> Quantity:
    """The value as a number.

    Raises:
        Refusal: it is a formula or label.
    """
    if isinstance(value, TimeValue):
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


def _comparable(value: Value, span: Span) -> quantities.Placed:
    if isinstance(value, TimeValue):
        raise Refusal(alone(value, span))
    if not isinstance(value, Quantity) or value.truth:
        raise Refusal(rules.compared_truth(span))
    return value, span


def _quantities(
    op: CompareOp, left: quantities.Placed, right: quantities.Placed, span: Span
) -> Compare | Constant:
    (first, first_span), (second, second_span) = left, right
    if not first.labels and not second.labels:
        return quantities.compare(op, left, right, span)
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
    if value.node is not None and any(fields_in(value.node)):
        raise Refusal(rules.limit_of_event(place))
    if _windows_of((value, place)):
        raise Refusal(rules.now_alone(span))
    if op in _EQUALITY:
        raise Refusal(rules.now_alone(span))
    # `now <= D` is the negation of `now > D`, and that is `now >= D + 1 tick`.
    strict = op in (CompareOp.GT, CompareOp.LE)
    late = op in (CompareOp.GT, CompareOp.GE)
    if now.since is None and value.constant is not None:
        ticks = quantities.ticks_of(value, place) + strict
        begun: Formula = Unary(UnaryOp.ONCE, Constant(True, span), Interval(ticks), span)
    else:
        begun = passed(now.since, quantities.seconds_of((value, place)), strict, span)
    return begun if late else Unary(UnaryOp.NOT, begun, None, span)


def _age(age: Age, op: CompareOp, limit: quantities.Placed, span: Span) -> Formula:
    """`age(x) > D` is: neither an update within the last D, nor the beginning of the trace.

    In whole ticks, `>= D` is `> D - 1 tick`.
    """
    if op in _EQUALITY:
        raise Refusal(rules.age_alone(span))
    ticks = quantities.ticks_of(*limit)
    window = ticks if op in (CompareOp.GT, CompareOp.LE) else ticks - 1
    older = op in (CompareOp.GT, CompareOp.GE)
    if window < 0:
        return Constant(older, span)
    updated = ProbeAtom(Probe.UPDATED, age.name, span)
    begun = Binary(BinaryOp.OR, updated, BoundAtom(Bound.START, span), None, span)
    recent = Unary(UnaryOp.ONCE, begun, Interval(0, window), span)
    return Unary(UnaryOp.NOT, recent, None, span) if older else recent
