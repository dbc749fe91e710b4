"""Numeric expressions as functions of the input; `None` is unknown."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from typing import Any, assert_never

from rvmon.dataflow.inputs import Inputs, Slot
from rvmon.formula.numeric import operands
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    CompareOp,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.trace.sample import Payload, Scalar
from rvmon.trace.time import TICKS_PER_SECOND

Payloads = Mapping[str, Payload]
"""By event, the payload that its fields are read from."""

Read = Callable[[Payloads], Scalar]

COMPARE: Mapping[CompareOp, Callable[[Any, Any], bool]] = {
    CompareOp.LT: operator.lt,
    CompareOp.LE: operator.le,
    CompareOp.EQ: operator.eq,
    CompareOp.NE: operator.ne,
    CompareOp.GE: operator.ge,
    CompareOp.GT: operator.gt,
}


def reader(expression: Numeric, inputs: Inputs, captured: Mapping[str, Scalar]) -> Read:
    """A function that gives the value of an expression at the current position."""
    match expression:
        case Literal(value=value):
            return lambda _: value
        case SignalValue(name=name):
            slot = inputs.slots[name]
            return lambda _: slot.value
        case FieldValue(event=event, field=field):
            return lambda payloads: _number(payloads[event].get(field))
        case Captured(name=name):
            known = captured[name]
            return lambda _: known
        case UpdateValue(function=function, name=name):
            return _update_reader(function, inputs.slots[name])
        case Arithmetic(op=op, args=args):
            return _arithmetic(op.entry.apply, [reader(arg, inputs, captured) for arg in args])
        case _:
            assert_never(expression)


def _number(value: Scalar) -> Scalar:
    return None if value != value else value


def _update_reader(function: UpdateFunction, slot: Slot) -> Read:
    def prev(_: Payloads) -> Scalar:
        return slot.before if slot.updates == 2 and slot.value is not None else None

    def delta(payloads: Payloads) -> float | None:
        before, now = prev(payloads), slot.value
        if before is None or isinstance(before, str) or now is None or isinstance(now, str):
            return None
        return _finite(operator.sub, [now, before])

    def rate(payloads: Payloads) -> float | None:
        difference = delta(payloads)
        if difference is None:
            return None
        return _finite(lambda: difference * TICKS_PER_SECOND / (slot.at - slot.before_at), [])

    match function:
        case UpdateFunction.PREV:
            return prev
        case UpdateFunction.DELTA:
            return delta
        case UpdateFunction.RATE:
            return rate
        case _:
            assert_never(function)


def _arithmetic(operation: Callable[..., float], args: list[Read]) -> Read:
    def read(payloads: Payloads) -> float | None:
        values = [arg(payloads) for arg in args]
        if any(value is None or isinstance(value, str) for value in values):
            return None
        return _finite(operation, values)

    return read


def _finite(operation: Callable[..., float], values: list[Scalar]) -> float | None:
    """The result, unless it is no finite number."""
    try:
        result = operation(*values)
        return result if math.isfinite(result) else None
    except (ValueError, OverflowError, ZeroDivisionError):
        return None


def inputs_of(*expressions: Numeric) -> frozenset[str]:
    """The signals and events that expressions read."""
    parts = [part for expression in expressions for part in operands(expression)]
    signals = {part.name for part in parts if isinstance(part, SignalValue | UpdateValue)}
    return frozenset(signals) | frozenset(events_of(*expressions))


def events_of(*expressions: Numeric) -> tuple[str, ...]:
    """The events whose fields expressions read, each once."""
    parts = [part for expression in expressions for part in operands(expression)]
    return tuple(dict.fromkeys(part.event for part in parts if isinstance(part, FieldValue)))


def captured_of(*expressions: Numeric) -> frozenset[str]:
    """The captured values that expressions read."""
    parts = [part for expression in expressions for part in operands(expression)]
    return frozenset(part.name for part in parts if isinstance(part, Captured))
