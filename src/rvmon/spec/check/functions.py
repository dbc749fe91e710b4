"""The functions of the language, applied to their arguments."""

from __future__ import annotations

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.diagnostics.nearest import did_you_mean
from rvmon.diagnostics.span import Span
from rvmon.spec.check.operands import Operands
from rvmon.spec.check.quantities import arithmetic
from rvmon.spec.check.values import Age, Quantity, Scope, Value
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Interval,
    Probe,
    ProbeAtom,
    Unary,
    UnaryOp,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.rules import names as name_rules
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal, Reported
from rvmon.spec.syntax.expressions import Call, Name
from rvmon.spec.syntax.mends import NEVER
from rvmon.spec.syntax.unit import PLAIN
from rvmon.spec.syntax.units import parse_unit, quotient
from rvmon.spec.syntax.words import FUNCTIONS
from rvmon.trace.schema import Kind

_ARGUMENTS = {
    "rise": 1,
    "fall": 1,
    "held": 2,
    "known": 1,
    "updated": 1,
    "changed": 1,
    "age": 1,
    "prev": 1,
    "delta": 1,
    "rate": 1,
    **{op.value: op.entry.least for op in NumericOp if op.entry.most is not None},
}
"""How many arguments a function takes; those that are not here take two or more."""


def applied(operands: Operands, call: Call, scope: Scope) -> Value:
    """What a call of a function of the language stands for.

    Raises:
        Refusal: there is no such function, or the arguments do not fit.
        Reported: an argument is wrong.
    """
    name = call.function.text
    if name not in FUNCTIONS:
        if name in operands.table.doubtful:
            raise Reported
        raise Refusal(_unknown(operands, call))
    _check_count(call)
    match name:
        case "rise" | "fall":
            return Unary(UnaryOp(name), operands.formula(call.args[0], scope), None, call.span)
        case "held":
            operand = operands.formula(call.args[0], scope)
            ticks = operands.duration(call.args[1], scope)
            return Unary(UnaryOp.HELD, operand, Interval(0, ticks), call.span)
        case "known" | "changed":
            signal, _ = _named(operands, call, scope, events=False)
            return ProbeAtom(Probe(name), signal, call.span)
        case "updated":
            return ProbeAtom(
                Probe.UPDATED, _named(operands, call, scope, events=True)[0], call.span
            )
        case "age":
            return Age(_named(operands, call, scope, events=True)[0])
        case "prev" | "delta" | "rate":
            return _of_updates(operands, call, scope)
        case _:
            quantities = operands.quantities(call.args, scope)
            placed = zip(quantities, (arg.span for arg in call.args), strict=True)
            return arithmetic(NumericOp.of(name), list(placed), call.span)


def _check_count(call: Call) -> None:
    name, given = call.function.text, len(call.args)
    wanted = _ARGUMENTS.get(name)
    if wanted is None:
        if given < 2:
            raise Refusal(rules.argument_count(call.span, name, "two or more arguments", given))
    elif given != wanted:
        takes = "one argument" if wanted == 1 else "two arguments"
        raise Refusal(rules.argument_count(call.span, name, takes, given))


def _named(operands: Operands, call: Call, scope: Scope, *, events: bool) -> tuple[str, Span]:
    """The only argument, which has to be the name of a signal (or of an event)."""
    needed = "the name of a signal or event" if events else "the name of a signal"
    name, inner = operands.peeled(call.args[0], scope)
    if isinstance(name, Name) and name.text not in inner.names:
        table = operands.table
        if name.text in table.signals or (events and name.text in table.events):
            return name.text, name.span
        operands.values((name,), inner)
    raise Refusal(rules.argument_kind(call.args[0].span, call.function.text, needed))


def _of_updates(operands: Operands, call: Call, scope: Scope) -> Quantity:
    name, span = _named(operands, call, scope, events=False)
    signal = operands.table.signals[name]
    function = UpdateFunction(call.function.text)
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
    mend = did_you_mean(name, [*FUNCTIONS, *operands.table.declared])
    mend = NEVER if name == "never" else mend
    return name_rules.unknown_function(call.function.span, name, mend)
