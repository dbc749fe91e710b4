"""The functions of the language, applied to their arguments."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.diagnostics.span import Span
from rvmon.spec.check.operands import Operands
from rvmon.spec.check.values import Age, AmountOf, Extreme, Quantity, Scope, Value
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Interval,
    Measured,
    Probe,
    ProbeAtom,
    Unary,
    UnaryOp,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.functions import FUNCTIONS, Argument, Function
from rvmon.spec.checked.specification import TimeModel
from rvmon.spec.checked.tense import future_part, is_pulse
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import time as time_rules
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal, Reported
from rvmon.spec.syntax.expressions import Call, Name
from rvmon.spec.syntax.fixes import NEVER
from rvmon.trace.schema import Kind
from rvmon.units import PLAIN, parse_unit, quotient

_INSTEAD = {
    **dict.fromkeys(
        ("mean", "average", "avg", "median", "percentile"),
        "bound the share that is off: `share(x > 2, 10 s) <= 10 %`, or all: `max(x, 10 s) <= 2`",
    ),
    **dict.fromkeys(
        ("sum", "integral"),
        "bound what adds up, `count(e, D)`, `duration(φ, D)`, or publish the sum as a signal",
    ),
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
        case NumericOp() as op if op in _EXTREMES and len(call.args) == 2:
            extreme = _extreme(operands, op, call, scope)
            return extreme or operands.calculated(op, call.args, scope, call.span)
        case NumericOp() as op:
            return operands.calculated(op, call.args, scope, call.span)
        case Measured() as measured:
            return _amount(operands, measured, call, scope)
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
    window = operands.duration(call.args[1], scope)
    if window == 0:
        raise Refusal(time_rules.no_duration(call.args[1].span))
    return AmountOf(measured, formula, window, call.function.text == "share")


def _extreme(operands: Operands, op: NumericOp, call: Call, scope: Scope) -> Extreme | None:
    """That of a window, if the second argument is a duration and the first is no time."""
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
    if given < wanted or (given > wanted and not function.more):
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
