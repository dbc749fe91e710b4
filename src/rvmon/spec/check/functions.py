"""The functions of the language applied to arguments; expressions read as formula or number."""

from __future__ import annotations

from rvmon.diagnostics import Diagnostic, Span
from rvmon.spec.check.comparisons import alone
from rvmon.spec.check.quantities import either
from rvmon.spec.check.scope import (
    Age,
    Ago,
    AmountOf,
    Beside,
    Chosen,
    Extreme,
    Operands,
    Quantity,
    Scope,
    Value,
)
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.classify import fields_in, future_part, is_pulse, reads_field
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
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
    UpdateFunction,
    UpdateValue,
    itself,
)
from rvmon.spec.checked.functions import FUNCTIONS, Argument, Function, Recall
from rvmon.spec.checked.names_read import names_in
from rvmon.spec.checked.specification import TimeModel
from rvmon.spec.rules import Refusal, Reported
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import time as time_rules
from rvmon.spec.rules import types as rules
from rvmon.spec.syntax.expressions import Call, Name
from rvmon.spec.syntax.fixes import NEVER
from rvmon.texts import did_you_mean
from rvmon.trace.schema import Kind
from rvmon.units import PLAIN, parse_unit, quotient


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


_INSTEAD = {
    **dict.fromkeys(
        ("median", "percentile"),
        "bound the share that is off: `share(x > 2, 10 s) <= 10 %`, or all: `max(x, 10 s) <= 2`",
    ),
    **dict.fromkeys(("average", "avg"), "write `mean(x, 10 s)`"),
    **dict.fromkeys(
        ("variance", "stddev"), "bound the spread: `max(x, D) <= 2 and min(x, D) >= 1`"
    ),
}
"""What says nearly the same as functions that there are not."""
_EXTREMES = (NumericOp.MIN, NumericOp.MAX)
_COUNTS = ("no argument", "one argument", "two arguments")


def applied(operands: Operands, call: Call, scope: Scope) -> Value:
    """What a call of a function of the language stands for.

    Raises:
        Refusal: there is no such function, or the arguments do not fit.
        Reported: an argument is wrong.
    """
    name = call.function.text
    function = FUNCTIONS.get(name)
    if function is None:
        if name in operands.table.doubtful:
            raise Reported
        raise Refusal(_unknown(operands, call))
    _check_count(call, function)
    match function.means:
        case UnaryOp() as op:
            operand = operands.formula(call.args[0], scope)
            lengths = [operands.duration(arg, scope) for arg in call.args[1:]]
            return Unary(op, operand, Interval(0, *lengths) if lengths else None, call.span)
        case Probe() as probe:
            return ProbeAtom(probe, _named(operands, call, scope, function)[0], call.span)
        case UpdateFunction() as of_updates:
            return _of_updates(operands, of_updates, _named(operands, call, scope, function))
        case NumericOp() as op if op in _EXTREMES and len(call.args) <= 2:
            extreme = _extreme(operands, op, call, scope)
            return extreme or operands.calculated(op, call.args, scope, call.span)
        case NumericOp() as op:
            return operands.calculated(op, call.args, scope, call.span)
        case Measured() as measured if measured.of_numbers:
            return _added(operands, measured, call, scope)
        case Measured() as measured:
            return _amount(operands, measured, call, scope)
        case Recall():
            return _ago(operands, call, scope)
        case None:
            return Age(_named(operands, call, scope, function)[0])


def _amount(operands: Operands, measured: Measured, call: Call, scope: Scope) -> AmountOf:
    """How much of a formula there was, which has to be known at once."""
    formula = operands.formula(call.args[0], scope)
    if (ahead := future_part(formula)) is not None:
        raise Refusal(rules.amount_of_future(ahead.span or call.span, call.function.text))
    held = operands.table.time is TimeModel.HELD
    if measured is Measured.COUNT and held and not is_pulse(formula):
        raise Refusal(rules.count_of_state(call.args[0].span))
    window = _window(operands, call, scope)
    share = call.function.text == "share"
    if share and window is None:
        raise Refusal(rules.argument_count(call.span, "share", "two arguments", 1))
    return AmountOf(measured, formula, window, share)


def _window(operands: Operands, call: Call, scope: Scope) -> int | None:
    """The duration behind the first argument, longer than 0; `None`: since the first instant."""
    if len(call.args) == 1:
        return None
    window = operands.duration(call.args[1], scope)
    if window == 0:
        raise Refusal(time_rules.no_duration(call.args[1].span))
    return window


def _added(operands: Operands, measured: Measured, call: Call, scope: Scope) -> AmountOf:
    """The numbers that are added up: those of occurrences, of updates, or what is held."""
    place = call.args[0].span
    (value,) = operands.values(call.args[:1], scope)
    condition: Formula | None = None
    if isinstance(value, Chosen) and measured is not Measured.MEAN and _is_nothing(value.otherwise):
        condition, value = value.condition, value.chosen
    quantity = number_of(value, place)
    node = quantity.node
    fields, signals = node is not None and reads_field(node), False
    if node is not None:
        signals = len({*names_in(node)} - {*(one.event for one in fields_in(node))}) > 0
    if node is None or not _can_be_added(measured, node, fields=fields, signals=signals):
        raise Refusal(rules.not_added(place, measured))
    member: Formula = itself(node, place)
    if measured is Measured.SUM and isinstance(node, SignalValue):
        updated = ProbeAtom(Probe.UPDATED, node.name, place)
        condition = updated if condition is None else _both(updated, condition, place)
    if condition is not None:
        if (ahead := future_part(condition)) is not None:
            raise Refusal(rules.amount_of_future(ahead.span or call.span, measured))
        member = _both(condition, member, place)
    return AmountOf(measured, member, _window(operands, call, scope), added=quantity)


def _both(left: Formula, right: Formula, span: Span) -> Formula:
    return Binary(BinaryOp.AND, left, right, None, span)


def _is_nothing(value: Value) -> bool:
    return isinstance(value, Quantity) and value.constant == 0


def _can_be_added(measured: Measured, node: Numeric, *, fields: bool, signals: bool) -> bool:
    """A sum is of what occurs, an integral of what is held, a mean of either."""
    match measured:
        case Measured.SUM:
            return fields or isinstance(node, SignalValue)
        case Measured.INTEGRAL:
            return signals and not fields
        case _:
            return fields is not signals


def _ago(operands: Operands, call: Call, scope: Scope) -> Ago:
    (quantity,) = operands.quantities(call.args[:1], scope)
    if quantity.node is None or reads_field(quantity.node):
        raise Refusal(rules.argument_kind(call.args[0].span, "ago", "a number of signals"))
    if operands.table.time is not TimeModel.HELD:
        raise Refusal(time_rules.ago_of_samples(call.span))
    return Ago(quantity, call.args[0].span, operands.duration(call.args[1], scope))


def _extreme(operands: Operands, op: NumericOp, call: Call, scope: Scope) -> Extreme | None:
    """That of a window, if the second argument is a duration and the first is no time."""
    if len(call.args) == 1:
        (number,) = operands.quantities(call.args, scope)
        return Extreme(op is NumericOp.MAX, number, call.args[0].span, None)
    first, second = operands.values(call.args, scope)
    if not isinstance(first, Quantity) or not isinstance(second, Quantity):
        return None
    time = parse_unit("s").dimension
    is_window = second.constant is not None and second.unit.dimension == time
    if first.constant is not None or not is_window or first.unit.dimension == time:
        return None
    window = operands.duration(call.args[1], scope)
    return Extreme(op is NumericOp.MAX, first, call.args[0].span, window)


def _check_count(call: Call, function: Function) -> None:
    wanted, given = len(function.arguments), len(call.args)
    if given < wanted - function.optional or (given > wanted and not function.more):
        takes = _COUNTS[wanted] if wanted < len(_COUNTS) else f"{wanted} arguments"
        takes = f"{takes.removesuffix(' arguments')} or more arguments" if function.more else takes
        raise Refusal(rules.argument_count(call.span, function.name, takes, given))


def _named(operands: Operands, call: Call, scope: Scope, function: Function) -> tuple[str, Span]:
    """The only argument, which has to be the name of a signal (or of an event)."""
    events = function.arguments[0] is Argument.SOURCE
    name, inner = operands.peeled(call.args[0], scope)
    if isinstance(name, Name) and name.text not in inner.names:
        table = operands.table
        if name.text in table.signals or (events and name.text in table.events):
            return name.text, name.span
        operands.values((name,), inner)
    needed = function.arguments[0].value
    raise Refusal(rules.argument_kind(call.args[0].span, function.name, needed))


def _of_updates(operands: Operands, function: UpdateFunction, named: tuple[str, Span]) -> Quantity:
    name, span = named
    signal = operands.table.signals[name]
    if function is not UpdateFunction.PREV and signal.type.kind in (Kind.BOOL, Kind.LABEL):
        raise Refusal(rules.argument_kind(span, function, "a signal with numbers"))
    unit = operands.table.units.get(name, PLAIN)
    rate = function is UpdateFunction.RATE
    return Quantity(
        UpdateValue(function, name),
        unit=quotient(unit, parse_unit("s")) if rate and unit.symbol else unit,
        integral=signal.type.kind is Kind.INT and not rate,
        labels=signal.type.labels,
        truth=signal.type.kind is Kind.BOOL,
    )


def _unknown(operands: Operands, call: Call) -> Diagnostic:
    name = call.function.text
    if name in operands.table.declared:
        rest = call.span.text[len(name) :]
        return name_rules.unknown_function(
            call.function.span, name, f"put a space before the bracket: `{name} {rest[:20]}`"
        )
    fix = did_you_mean(name, [*FUNCTIONS, *operands.table.declared])
    fix = NEVER if name == "never" else _INSTEAD.get(name, fix)
    return name_rules.unknown_function(call.function.span, name, fix)
