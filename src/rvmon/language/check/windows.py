"""Checks calls that measure a window of the past: `count`, `sum`, `mean` and the like."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeGuard

from msgspec import Struct
from msgspec.structs import replace

from rvmon.diagnostics import Span
from rvmon.language.check.comparisons import number_of
from rvmon.language.check.quantities import arithmetic, node_of
from rvmon.language.check.scope import Chosen, Lone, Operands, Quantity, Scope
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.classify import future_part, is_pulse
from rvmon.language.checked.functions import LAST
from rvmon.language.checked.names_read import names_in, names_read
from rvmon.language.checked.rewrite import Formulas, chain
from rvmon.language.checked.specification import TimeModel
from rvmon.language.checked.window_measures import Dimension, Members
from rvmon.language.rules import Refusal
from rvmon.language.rules import types as rules
from rvmon.language.syntax.expressions import Call, Expression, Infix, Name
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.units import PLAIN, Unit, parse_unit, product

TRIGGER = "trigger"
"""The word after `since` in a window that starts at the trigger: `x since trigger`."""
_SECONDS = parse_unit("s")
MOST_LAST = 1_000_000  # the greatest n of `last(n, x)`


class _Window(Struct, frozen=True):
    """The window of a call: the expression that is measured, and the extent."""

    of: Expression
    scope: Scope  # of the expression
    ticks: int | None = None  # D in ticks; `None`: no duration is given
    most: int | None = None  # the n of `last(n, x)`; `None`: any number of updates
    since: bool = False  # whether only members since the trigger count

    @property
    def span(self) -> Span:
        """The place of the measured expression."""
        return self.of.span


def _window(operands: Operands, call: Call, scope: Scope) -> _Window:
    """The window of a call: the last D, `last(n, x)`, since the trigger, or since the start."""
    of, inner = operands.unwrapped(call.args[0], scope)
    window = _Window(call.args[0], scope)
    match of:
        case Call(function=function, args=(count, x)) if function.text == LAST:
            window = _Window(x, inner, most=_count(operands, count, inner))
        case Infix(op=rv.BinaryOp.SINCE, left=left, right=right, window=None):
            name, place = operands.unwrapped(right, inner)
            if (
                isinstance(name, Name)
                and name.text == TRIGGER
                and not operands.known(TRIGGER, place)
            ):
                if scope.trigger is None:
                    raise Refusal(rules.since_no_trigger(of.span))
                window = _Window(left, inner, since=True)
    if len(call.args) == 1:
        return window
    if window.most is not None or window.since:
        raise Refusal(rules.two_windows(call.span))
    ticks = operands.duration(call.args[1], scope)
    if ticks == 0:
        raise Refusal(rules.no_duration(call.args[1].span))
    return replace(window, ticks=ticks)


def _count(operands: Operands, expression: Expression, scope: Scope) -> int:
    count = number_of(operands.values((expression,), scope)[0], expression.span)
    number = count.constant
    whole = number is not None and number.denominator == 1 and not count.unit.symbol
    if number is None or not whole or not 1 <= number <= MOST_LAST:
        raise Refusal(rules.last_count(expression.span, MOST_LAST))
    return int(number)


def amount(operands: Operands, measured: rv.Measured, call: Call, scope: Scope) -> Quantity:
    """The quantity of a call that measures a window.

    Raises:
        Refusal: the window is invalid, or the measure does not apply to its members.
        Reported: an operand has an error.
    """
    window = _window(operands, call, scope)
    lone = (_added if measured.of_numbers else _counted)(operands, measured, call, window)
    of = replace(lone.of, window=window.ticks, most=window.most)
    if window.since and scope.trigger is not None:
        started = scope.trigger.started(window.span)
        of = replace(of, operand=Formulas(window.span).both(started, of.operand))
        lone = replace(lone, started=started)
    lone = replace(lone, of=of)
    added = lone.added or Quantity(integral=True)
    whole = added.integral and measured not in (rv.Measured.MEAN, rv.Measured.VARIANCE)
    unit = _unit_of(measured, added.unit)
    quantity = Quantity(of, unit=unit, integral=whole and not measured.of_time)
    if lone.share:
        seconds = Fraction(of.window or 0, TICKS_PER_SECOND)
        span = Quantity(constant=seconds, unit=_SECONDS)
        quantity = arithmetic(NumericOp.DIV, ((quantity, call.span), (span, call.span)), call.span)
    return replace(quantity, lone=lone)


def _unit_of(measured: rv.Measured, unit: Unit) -> Unit:
    """The unit of a measure over numbers of the given unit."""
    match measured.dimension:
        case Dimension.PLAIN:
            return PLAIN
        case Dimension.TIMES_TIME | Dimension.TIME:
            return product(unit, _SECONDS)
        case Dimension.SQUARE:
            return product(unit, unit)
        case Dimension.SAME:
            return unit


def _counted(operands: Operands, measured: rv.Measured, call: Call, window: _Window) -> Lone:
    """A count, duration or share of a formula, which must not refer to the future."""
    formula = operands.formula(window.of, window.scope)
    _refuse_future(formula, call, call.function.text)
    share = call.function.text == "share"
    if share and window.ticks is None and window.most is None:
        raise Refusal(rules.argument_count(call.span, "share", "two arguments", 1))
    if window.most is not None:
        if share or measured is not rv.Measured.COUNT:
            raise Refusal(rules.not_of_last(call.span, call.function.text))
        updated = _updates(operands, {*names_read(formula)}, window.span)
        return Lone(rv.WindowValue(measured, updated, None, counted=formula))
    held = operands.table.time is TimeModel.HELD
    if measured is rv.Measured.COUNT and held and not is_pulse(formula):
        raise Refusal(rules.count_of_state(window.span))
    return Lone(rv.WindowValue(measured, formula, None), share=share)


def _refuse_future(formula: rv.Formula, call: Call, name: str) -> None:
    if (ahead := future_part(formula)) is not None:
        raise Refusal(rules.amount_of_future(ahead.span or call.span, name))


def _updates(operands: Operands, names: set[str], span: Span) -> rv.Formula:
    """The formula that is true where the only name that an expression reads is updated."""
    if len(names) != 1:
        raise Refusal(rules.last_of_several(span))
    (name,) = names
    if name in operands.table.events:
        return rv.EventAtom(name, span)
    return rv.ProbeAtom(rv.Probe.UPDATED, name, span)


def _added(operands: Operands, measured: rv.Measured, call: Call, window: _Window) -> Lone:
    """A measure over numbers: fields of occurrences, updates of a signal, or held values."""
    place = window.span
    (value,) = operands.values((window.of,), window.scope)
    conditions: list[rv.Formula] = []
    may_choose = measured in (rv.Measured.SUM, rv.Measured.INTEGRAL) and window.most is None
    match value:
        case Chosen(otherwise=Quantity(constant=0)) if may_choose:
            conditions, value = chain(value.condition), value.chosen
    quantity = number_of(value, place)
    if quantity.node is None:
        raise Refusal(rules.not_added(place, measured, measured.of.value))
    node = node_of((quantity, place))
    if rv.windows_in(node):
        raise Refusal(rules.window_in_window(place))
    events = {value.event for value in rv.fields_in(node)}
    signals = {*names_in(node)} - events
    if window.most is not None:
        if measured.of is Members.HELD:
            raise Refusal(rules.not_of_last(call.span, measured))
        updated = _updates(operands, events | signals, place)
        of = rv.WindowValue(measured, updated, None, node, counted=rv.itself(node, place))
        return Lone(of, quantity)
    if not _can_be_added(measured, node, fields=bool(events), signals=bool(signals)):
        raise Refusal(rules.not_added(place, measured, measured.of.value))
    if measured is rv.Measured.VARIANCE and signals:
        _refuse_curve(operands, call, window)
    if measured is rv.Measured.AGO and operands.table.time is not TimeModel.HELD:
        raise Refusal(rules.ago_of_samples(call.span))
    if measured.of is Members.EVENTS and isinstance(node, rv.SignalValue):
        conditions.insert(0, rv.ProbeAtom(rv.Probe.UPDATED, node.name, place))
    chosen = tuple(condition for condition in conditions if _is_of_occurrence(condition, events))
    member: rv.Formula = rv.itself(node, place)
    for condition in reversed([condition for condition in conditions if condition not in chosen]):
        _refuse_future(condition, call, measured)
        member = Formulas(place).both(condition, member)
    return Lone(rv.WindowValue(measured, member, None, node, chosen=chosen), quantity)


def _is_of_occurrence(formula: rv.Formula, events: set[str]) -> TypeGuard[rv.Compare]:
    """Whether a formula is a comparison that reads fields of the single event in `events`."""
    if not isinstance(formula, rv.Compare) or len(events) != 1:
        return False
    return {value.event for value in rv.fields_in(formula.left, formula.right)} == events


def _can_be_added(measured: rv.Measured, node: rv.Numeric, *, fields: bool, signals: bool) -> bool:
    """Whether a measure applies to a number that reads fields of events, or signals, or both."""
    match measured.of:
        case Members.EVENTS:
            return fields or isinstance(node, rv.SignalValue)
        case Members.HELD:
            return signals and not fields
        case _ if measured.recalls:
            return fields or signals
        case _:
            return fields is not signals


def _refuse_curve(operands: Operands, call: Call, window: _Window) -> None:
    """Refuse a variance over held values in `time held`, and on a clock without a duration.

    In held time it moves along a curve between samples, and its crossing of a limit is not
    computed.
    """
    time = operands.table.time
    if time is TimeModel.HELD:
        raise Refusal(rules.variance_moves(call.span))
    if time is TimeModel.CLOCKED and window.ticks is None:
        raise Refusal(rules.argument_count(call.span, "variance", "two arguments", 1))


def is_extreme(operands: Operands, call: Call, scope: Scope) -> bool:
    """Whether a call of `min` or `max` is a window `max(x, D)`, not the greatest of arguments.

    It is a window if it has one argument, or if the second of two is a constant duration and the
    first is not a duration.
    """
    if len(call.args) == 1:
        return True
    if len(call.args) > 2:
        return False
    first, second = operands.values(call.args, scope)
    if not isinstance(first, Quantity) or not isinstance(second, Quantity):
        return False
    is_time = second.constant is not None and second.unit.dimension == _SECONDS.dimension
    return first.constant is None and is_time and first.unit.dimension != _SECONDS.dimension
