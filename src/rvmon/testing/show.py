"""Cases as text: what a person needs to try a counterexample by hand."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    Binary,
    BoundAtom,
    Captured,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Formula,
    Interval,
    Literal,
    Numeric,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UpdateValue,
)
from rvmon.spec.checked.specification import CheckedSpec, EndPolicy, Requirement, Signal, TimeModel
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind

_INFIX = (NumericOp.ADD, NumericOp.SUB, NumericOp.MUL, NumericOp.DIV)


def show_case(case: Case) -> str:
    """The specification as `.rv` text, then what the monitor is told, line by line."""
    lines = [show_spec(case.spec), ""]
    if case.names is not None:
        lines.append(f"sources: {', '.join(sorted(case.names)) or 'none'}")
    for action in case.actions:
        if isinstance(action, Sample):
            lines.append(f"sample  {action.t:>4}  {dict(action.values)}")
        else:
            lines.append(f"advance {action:>4}")
    lines.append(f"finish  {'' if case.end is None else case.end:>4}".rstrip())
    return "\n".join(lines)


def show_spec(spec: CheckedSpec) -> str:
    """A checked specification as `.rv` text, with every bracket."""
    period = f" {spec.period} ns" if spec.time is TimeModel.CLOCKED else ""
    lines = [f'spec {spec.name} "{spec.title}"', f"time {spec.time.value}{period}", ""]
    lines += [_signal(signal) for signal in spec.signals.values()]
    for event in spec.events.values():
        fields = ", ".join(f"{name}: {type_.kind.value}" for name, type_ in event.fields.items())
        lines.append(f"event {event.name}" + (f"({fields})" if fields else ""))
    for requirement in spec.requirements.values():
        lines += ["", *_requirement(requirement)]
    return "\n".join(lines)


def _signal(signal: Signal) -> str:
    labels = f"{{{', '.join(signal.type.labels)}}}"
    type_ = labels if signal.type.kind is Kind.LABEL else signal.type.kind.value
    ignoring = " ignore NaN" if signal.ignores_nan else ""
    stale = "" if signal.stale_after is None else f" stale after {signal.stale_after} ns"
    return f"signal {signal.name} : {type_}{ignoring}{stale}"


def _requirement(requirement: Requirement) -> Iterator[str]:
    yield f"requirement {requirement.id}"
    yield f"  {requirement.mode.value} {show(requirement.trigger)}"
    yield f"  then {show(requirement.consequent)}"
    if requirement.for_each:
        field = requirement.for_each.value
        yield f"  for each {requirement.for_each.name} in {field.event}.{field.field}"
    for capture in requirement.captures:
        yield f"  let {capture.name} = {show_number(capture.value)}"
    if requirement.at_end is not EndPolicy.DEFAULT:
        yield f"  at end {requirement.at_end.value}"


def show(formula: Formula) -> str:
    """A formula as text, with every bracket.

    >>> from rvmon.spec.checked.formula import UnaryOp
    >>> show(Unary(UnaryOp.EVENTUALLY, SignalAtom("p"), Interval(0, 3)))
    '(F[0 ns, 3 ns] p)'
    """
    match formula:
        case Constant(value=value):
            return "true" if value else "false"
        case SignalAtom(name=name) | EventAtom(name=name):
            return name
        case Compare(op=op, left=left, right=right):
            return f"({show_number(left)} {op.value} {show_number(right)})"
        case ProbeAtom(probe=probe, name=name):
            return f"{probe.value}({name})"
        case BoundAtom(bound=bound):
            return bound.value
        case Unary(op=op, operand=operand, interval=interval) if op.entry.called:
            length = "" if interval is None else f", {interval.high} ns"
            return f"{op.value}({show(operand)}{length})"
        case Unary(op=op, operand=operand, interval=interval):
            return f"({op.value}{_window(interval)} {show(operand)})"
        case Binary(op=op, left=left, right=right, interval=interval):
            return f"({show(left)} {op.value}{_window(interval)} {show(right)})"
        case _:
            assert_never(formula)


def _window(interval: Interval | None) -> str:
    if interval is None or interval == Interval():
        return ""
    if interval.high is None:
        return f"[{interval.low} ns, inf)"
    return f"[{interval.low} ns, {interval.high} ns]"


def show_number(expression: Numeric) -> str:
    """A numeric expression as text, with every bracket."""
    match expression:
        case Literal(value=value):
            return str(value)
        case SignalValue(name=name) | Captured(name=name):
            return name
        case FieldValue(event=event, field=field):
            return f"{event}.{field}"
        case UpdateValue(function=function, name=name):
            return f"{function.value}({name})"
        case Arithmetic(op=op, args=args) if op in _INFIX:
            return "(" + f" {op.value} ".join(show_number(arg) for arg in args) + ")"
        case Arithmetic(op=NumericOp.NEG, args=(arg,)):
            return f"(-{show_number(arg)})"
        case Arithmetic(op=op, args=args):
            return f"{op.value}({', '.join(show_number(arg) for arg in args)})"
        case _:
            assert_never(expression)
