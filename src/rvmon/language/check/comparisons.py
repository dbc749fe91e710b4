"""Checks comparisons of numbers, labels, ages, `now` and measured windows."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil

from rvmon.diagnostics import Diagnostic, Span
from rvmon.language.check import quantities
from rvmon.language.check import scope as sc
from rvmon.language.check.moving_windows import above, by_limits, isolated
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.names_read import names_in
from rvmon.language.checked.specification import TimeModel
from rvmon.language.rules import Refusal
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import types as rules
from rvmon.language.syntax.expressions import Comparison, Name
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.units import Unit, parse_unit

_EQUALITY = (rv.CompareOp.EQ, rv.CompareOp.NE)


def compared(operands: sc.Operands, node: Comparison, scope: sc.Scope) -> rv.Formula:
    """The formula of a comparison.

    Raises:
        Refusal: the sides cannot be compared.
        Reported: a side has an error.
    """
    sides = _sides(operands, node, scope)
    time = operands.table.time
    formulas = quantities.for_each_outcome(
        sides, node.span, lambda values: _compared(time, node, *values)
    )
    return quantities.joined(formulas, node.span)


def _compared(time: TimeModel, node: Comparison, left: sc.Value, right: sc.Value) -> rv.Formula:
    op, places = node.op, (node.left.span, node.right.span)
    # Ages and `now` are moved to the left side, to halve the cases below.
    if isinstance(right, sc.TimeValue) and not isinstance(left, sc.TimeValue):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, sc.Moment) and isinstance(right, sc.Now):
        left, right, op, places = right, left, op.mirrored, places[::-1]
    if isinstance(left, sc.Now):
        return _now(left, op, right, places[1], node.span)
    limit = _comparable(right, places[1])
    if isinstance(left, sc.Age):
        return _age(left, op, limit, node.span)
    first = _comparable(left, places[0])
    if limit[0].lone and not first[0].lone:
        first, limit, op = limit, first, op.mirrored
    # A window that is a side by itself is compared exactly, in ticks or whole numbers. Within an
    # expression it is a rounded number (SEMANTICS 5).
    windows = [_windows_of(side) for side in (first, limit)]
    if first[0].lone and not windows[1]:
        lone = first[0].lone
        if not lone.of.measured.recalls:
            return _amount(lone, first[0].unit, op, limit, node.span)
        if (extreme := _extreme(lone, op, limit, node.span)) is not None:
            return extreme
    comparison = _quantities(op, first, limit, node.span)
    if not any(windows) or not isinstance(comparison, rv.Compare):
        return comparison
    if any(rv.fields_in(comparison.left, comparison.right)):
        raise Refusal(rules.limit_of_event(node.span))
    if time is TimeModel.HELD and any(window.moves for window in (*windows[0], *windows[1])):
        return isolated(comparison, node.span)
    return comparison


def _windows_of(placed: quantities.Placed) -> tuple[rv.WindowValue, ...]:
    node = placed[0].node
    return () if node is None else rv.windows_in(node)


def _sides(operands: sc.Operands, node: Comparison, scope: sc.Scope) -> list[sc.Value]:
    """The values of both sides; a name is a label if the other side is a signal with that label."""
    for first, second in ((node.left, node.right), (node.right, node.left)):
        name, place = operands.unwrapped(second, scope)
        other, _ = operands.unwrapped(first, scope)
        # An unknown name on the other side is not evaluated in search of a signal with labels.
        may_be_signal = not isinstance(other, Name) or operands.known(other.text, scope)
        if not isinstance(name, Name) or not may_be_signal:
            continue
        value = operands.values((first,), scope)[0]
        if not isinstance(value, sc.Quantity) or not value.labels:
            continue
        if name.text in value.labels:
            label = sc.Quantity(rv.Literal(name.text), labels=value.labels)
            return [value, label] if first is node.left else [label, value]
        if not operands.known(name.text, place):
            raise Refusal(name_rules.unknown_label(name.span, name.text, value.labels))
    return operands.values((node.left, node.right), scope)


def _amount(
    lone: sc.Lone, unit: Unit, op: rv.CompareOp, limit: quantities.Placed, span: Span
) -> rv.Formula:
    if lone.added is None and limit[0].constant is not None:
        return by_limits(op, lambda strict: _counted(lone, limit, strict, span), span)
    bound = _bound(lone, unit, limit, span)
    return by_limits(op, lambda strict: above(lone.of, bound, strict, span), span)


def _counted(lone: sc.Lone, limit: quantities.Placed, strict: bool, span: Span) -> rv.Formula:
    """The comparison of a count, duration or share with a constant, in whole numbers."""
    value, place = limit
    exact = (value.constant or 0) * value.unit.factor
    if lone.share or lone.of.measured is rv.Measured.COUNT:
        if value.unit.dimension:
            raise Refusal(rules.mismatch(span, "no unit", value.unit.symbol, "compared with"))
        exact *= lone.of.window or 1 if lone.share else 1
    else:
        exact = Fraction(quantities.ticks_of(value, place))
    # What is compared is whole, so both `> 2.5` and `>= 2.5` are `>= 3`.
    if exact.denominator > 1:
        exact, strict = Fraction(ceil(exact)), False
    always = exact < 0 if strict else exact <= 0
    return (
        rv.Constant(True, span)
        if always
        else rv.Amount(lone.of, rv.Literal(int(exact)), strict, span)
    )


def _bound(lone: sc.Lone, unit: Unit, limit: quantities.Placed, span: Span) -> rv.Numeric:
    """The limit of a window, in the unit of the measure; it does not move between samples."""
    value, place = limit
    if value.node is not None and any(rv.fields_in(value.node)):
        raise Refusal(rules.limit_of_event(place))
    if lone.share:
        unit = parse_unit("s")
        whole = sc.Quantity(constant=Fraction(lone.of.window or 0, TICKS_PER_SECOND), unit=unit)
        limit = quantities.arithmetic(NumericOp.MUL, (limit, (whole, place)), span), place
    return quantities.converted(unit, limit, span)


def _extreme(
    lone: sc.Lone, op: rv.CompareOp, limit: quantities.Placed, span: Span
) -> rv.Formula | None:
    """A comparison of `min`, `max` or `ago` with a constant, as a formula of the past.

    `max(x, D) <= c` means that `x <= c` holds throughout the last D, and `max(x, D) >= c` that
    `x >= c` held at some instant. `ago(x, D) <= c` is `x <= c` D ago, and false where there was no
    such instant. `None` if the limit reads names: the window is then compared as a number.
    """
    bound, added = limit[0].node, lone.added
    if added is None or (bound is not None and any(names_in(bound))):
        return None
    of = lone.of
    if of.measured is rv.Measured.AGO:
        then = quantities.compare(op, (added, span), limit, span)
        return rv.Unary(rv.UnaryOp.ONCE, then, rv.Interval(of.window or 0, of.window), span)
    greatest = of.measured is rv.Measured.MAX
    every = (rv.CompareOp.LT, rv.CompareOp.LE) if greatest else (rv.CompareOp.GT, rv.CompareOp.GE)
    occurs = added.node is not None and any(rv.fields_in(added.node))

    def over(how: rv.CompareOp) -> rv.Formula:
        # A comparison of a field is false where its event does not occur, so "all members satisfy
        # it" is written as "no member violates it", which is also right for a window without
        # members.
        if how in every and (lone.started or of.most or occurs):
            return rv.Unary(rv.UnaryOp.NOT, over(how.denied), None, span)
        one: rv.Formula = quantities.compare(how, (added, span), limit, span)
        if of.most is not None:
            counted = rv.WindowValue(rv.Measured.COUNT, of.operand, None, most=of.most, counted=one)
            return rv.Amount(counted, rv.Literal(1), span=span)
        whole = rv.UnaryOp.HISTORICALLY if how in every else rv.UnaryOp.ONCE
        if lone.started is not None:
            one = rv.Binary(rv.BinaryOp.AND, lone.started, one, None, span)
        return rv.Unary(whole, one, rv.Interval(0, of.window), span)

    if op not in _EQUALITY:
        return over(op)
    same = rv.Binary(rv.BinaryOp.AND, over(rv.CompareOp.LE), over(rv.CompareOp.GE), None, span)
    return same if op is rv.CompareOp.EQ else rv.Unary(rv.UnaryOp.NOT, same, None, span)


def alone(value: sc.TimeValue, span: Span) -> Diagnostic:
    """The finding for a value of time outside a comparison."""
    return (rules.age_alone if isinstance(value, sc.Age) else rules.now_alone)(span)


def formula_of(value: sc.Value, span: Span) -> rv.Formula:
    """The value as a formula.

    Raises:
        Refusal: it is a number, a label or a value of time.
    """
    if isinstance(value, sc.TimeValue):
        raise Refusal(alone(value, span))
    match value:
        case sc.Quantity(node=rv.SignalValue(name=name), truth=True):
            return rv.SignalAtom(name, span)
        case sc.Quantity(node=node, truth=True) if node is not None:
            return rv.Compare(rv.CompareOp.EQ, node, rv.Literal(True), span)
        case sc.Quantity(labels=labels):
            raise Refusal(rules.needs_formula(span, "a label" if labels else "a number"))
        case sc.Chosen(condition=condition, chosen=chosen, otherwise=otherwise):
            return quantities.if_then_else(
                condition, formula_of(chosen, span), formula_of(otherwise, span), span
            )
        case _:
            return value


def number_of(value: sc.Value, span: Span) -> sc.Quantity:
    """The value as a number.

    Raises:
        Refusal: it is a formula, a label, a choice or a value of time.
    """
    if isinstance(value, sc.TimeValue):
        raise Refusal(alone(value, span))
    match value:
        case sc.Quantity(truth=False, labels=()):
            return value
        case sc.Quantity(truth=False):
            raise Refusal(rules.label_use(span))
        case sc.Chosen():
            raise Refusal(rules.choice_alone(span))
        case _:
            raise Refusal(rules.needs_number(span))


def _comparable(value: sc.Value, span: Span) -> quantities.Placed:
    if isinstance(value, sc.TimeValue):
        raise Refusal(alone(value, span))
    if not isinstance(value, sc.Quantity) or value.truth:
        raise Refusal(rules.compared_truth(span))
    return value, span


def _quantities(
    op: rv.CompareOp, left: quantities.Placed, right: quantities.Placed, span: Span
) -> rv.Compare | rv.Constant:
    (first, first_span), (second, second_span) = left, right
    if not first.labels and not second.labels:
        return quantities.compare(op, left, right, span)
    labelled = op in _EQUALITY and first.labels and second.labels
    if not labelled or first.node is None or second.node is None:
        raise Refusal(rules.label_use(first_span if first.labels else second_span))
    return rv.Compare(op, first.node, second.node, span)


def time_shifted(op: NumericOp, values: Sequence[sc.Value]) -> sc.Now | sc.Moment | None:
    """The value of `now - t0`, `t0 + x` or `x + t0`; `None` for any other operation."""
    match op, values:
        case NumericOp.SUB, [sc.Now(since=None), sc.Moment(name=name, later=None)]:
            return sc.Now(name)
        case NumericOp.ADD, (
            [sc.Moment(name=name, later=None), sc.Quantity() as later]
            | [sc.Quantity() as later, sc.Moment(name=name, later=None)]
        ):
            return sc.Moment(name, later)
    return None


def _now(now: sc.Now, op: rv.CompareOp, limit: sc.Value, place: Span, span: Span) -> rv.Formula:
    """A comparison of `now`: `now >= D` with a constant D means that there was an instant D ago.

    Comparisons with a captured instant, or with data, become `Passed`.
    """
    if isinstance(limit, sc.Moment) and now.since is None:
        later = sc.Quantity(constant=Fraction(0)) if limit.later is None else limit.later
        now, limit = sc.Now(limit.name), later
    value, _ = _comparable(limit, place)
    if value.node is not None and any(rv.fields_in(value.node)):
        raise Refusal(rules.limit_of_event(place))
    if _windows_of((value, place)) or op in _EQUALITY:
        raise Refusal(rules.now_alone(span))

    def late(strict: bool) -> rv.Formula:
        if now.since is None and value.constant is not None:
            ticks = quantities.ticks_of(value, place) + strict
            return rv.Unary(rv.UnaryOp.ONCE, rv.Constant(True, span), rv.Interval(ticks), span)
        return rv.passed(now.since, quantities.seconds_of((value, place)), strict, span)

    return by_limits(op, late, span)


def _age(age: sc.Age, op: rv.CompareOp, limit: quantities.Placed, span: Span) -> rv.Formula:
    """A comparison of an age: `age(x) > D` means no update, and no start, within the last D.

    In whole ticks, `>= D` is `> D - 1 tick`.
    """
    if op in _EQUALITY:
        raise Refusal(rules.age_alone(span))
    ticks = quantities.ticks_of(*limit)
    window = ticks if op in (rv.CompareOp.GT, rv.CompareOp.LE) else ticks - 1
    older = op in (rv.CompareOp.GT, rv.CompareOp.GE)
    if window < 0:
        return rv.Constant(older, span)
    updated = rv.ProbeAtom(rv.Probe.UPDATED, age.name, span)
    started = rv.Binary(rv.BinaryOp.OR, updated, rv.BoundAtom(rv.Bound.START, span), None, span)
    recent = rv.Unary(rv.UnaryOp.ONCE, started, rv.Interval(0, window), span)
    return rv.Unary(rv.UnaryOp.NOT, recent, None, span) if older else recent
