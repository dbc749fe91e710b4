"""Checks calls of the language's built-in functions."""

from __future__ import annotations

from msgspec.structs import replace

from rvmon.diagnostics import Diagnostic, Span
from rvmon.language.check.scope import Age, Operands, Quantity, Scope, Value, typed
from rvmon.language.check.windows import amount, is_extreme
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.functions import FUNCTIONS, LAST, Argument, Function
from rvmon.language.rules import Refusal, Reported
from rvmon.language.rules import names as name_rules
from rvmon.language.rules import types as rules
from rvmon.language.syntax.expressions import Call, Name
from rvmon.language.syntax.syntax_errors import NEVER
from rvmon.texts import did_you_mean
from rvmon.trace.schema import Kind
from rvmon.units import PLAIN, parse_unit, quotient

_INSTEAD = {
    **dict.fromkeys(
        ("median", "percentile"),
        "bound the share that is off: `share(x > 2, 10 s) <= 10 %`, or all: `max(x, 10 s) <= 2`",
    ),
    **dict.fromkeys(("average", "avg"), "write `mean(x, 10 s)`"),
    **dict.fromkeys(
        ("derivative", "slope"), "write `rate(x)`, the change a second between updates"
    ),
    "rms": "its square is the mean of squares: `mean(x * x, 10 s) <= 0.04`",
    **dict.fromkeys(("stddev", "std"), "its square is the variance: `variance(e.x, 10 s) <= 0.04`"),
}
"""Advice for functions that the language lacks, by name: how to write nearly the same."""
_EXTREMES = {NumericOp.MIN: rv.Measured.MIN, NumericOp.MAX: rv.Measured.MAX}
_COUNTS = ("no argument", "one argument", "two arguments")


def applied(operands: Operands, call: Call, scope: Scope) -> Value:
    """The value of a call of a built-in function.

    Raises:
        Refusal: there is no such function, or the arguments do not fit.
        Reported: an argument has an error.
    """
    name = call.function.text
    function = FUNCTIONS.get(name)
    if function is None:
        if name in operands.table.doubtful:
            raise Reported
        raise Refusal(_unknown(operands, call))
    _check_count(call, function)
    match function.means:
        case rv.UnaryOp() as op:
            operand = operands.formula(call.args[0], scope)
            lengths = [operands.duration(arg, scope) for arg in call.args[1:]]
            return rv.Unary(op, operand, rv.Interval(0, *lengths) if lengths else None, call.span)
        case rv.Probe() as probe:
            return rv.ProbeAtom(probe, _named(operands, call, scope, function)[0], call.span)
        case rv.UpdateFunction.DELTA if len(call.args) > 1:
            return amount(operands, rv.Measured.DELTA, call, scope)
        case rv.UpdateFunction() as of_updates:
            return _of_updates(operands, of_updates, _named(operands, call, scope, function))
        case NumericOp() as op if op in _EXTREMES and is_extreme(operands, call, scope):
            return amount(operands, _EXTREMES[op], call, scope)
        case NumericOp() as op:
            return operands.calculated(op, call.args, scope, call.span)
        case rv.Measured() as measured:
            return amount(operands, measured, call, scope)
        case None if function.name == LAST:
            raise Refusal(rules.last_alone(call.span))
        case None:
            return Age(_named(operands, call, scope, function)[0])


def _check_count(call: Call, function: Function) -> None:
    wanted, given = len(function.arguments), len(call.args)
    if given < wanted - function.optional or (given > wanted and not function.more):
        takes = _COUNTS[wanted] if wanted < len(_COUNTS) else f"{wanted} arguments"
        takes = f"{takes.removesuffix(' arguments')} or more arguments" if function.more else takes
        raise Refusal(rules.argument_count(call.span, function.name, takes, given))


def _named(operands: Operands, call: Call, scope: Scope, function: Function) -> tuple[str, Span]:
    """The name that a call has as its only argument, with its place.

    It must be the name of a signal, or of an event if the function accepts one.
    """
    events = function.arguments[0] is Argument.SOURCE
    name, inner = operands.unwrapped(call.args[0], scope)
    if isinstance(name, Name) and name.text not in inner.names:
        table = operands.table
        if name.text in table.signals or (events and name.text in table.events):
            return name.text, name.span
        operands.values((name,), inner)
    needed = function.arguments[0].value
    raise Refusal(rules.argument_kind(call.args[0].span, function.name, needed))


def _of_updates(
    operands: Operands, function: rv.UpdateFunction, named: tuple[str, Span]
) -> Quantity:
    name, span = named
    signal = operands.table.signals[name]
    if function is not rv.UpdateFunction.PREV and signal.type.kind in (Kind.BOOL, Kind.LABEL):
        raise Refusal(rules.argument_kind(span, function, "a signal with numbers"))
    unit = operands.table.units.get(name, PLAIN)
    found = typed(rv.UpdateValue(function, name), signal.type, unit)
    if function is not rv.UpdateFunction.RATE:
        return found
    rate = quotient(unit, parse_unit("s")) if unit.symbol else unit
    return replace(found, unit=rate, integral=False)


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
