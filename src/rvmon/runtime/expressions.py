"""Numeric expressions as functions of the input; `None` is unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, assert_never

from rvmon.runtime.past import History, finite, number
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateValue,
)
from rvmon.trace.sample import Payload, Scalar


class Input(Protocol):
    """What expressions read."""

    def value_of(self, signal: str) -> Scalar:
        """The value of a signal; `None` if it is unknown."""

    def history_of(self, signal: str) -> History:
        """Its last two updates."""

    def payloads_of(self, event: str) -> Sequence[Payload | None]:
        """What occurs of an event; `None` is unknown."""


Payloads = Mapping[str, Payload]
"""By event, the payload that its fields are read from."""

Read = Callable[[Payloads], Scalar]


def reader(expression: Numeric, inputs: Input, captured: Mapping[str, Scalar]) -> Read:
    """A function that gives the value of an expression at the current position."""
    match expression:
        case Literal(value=value):
            return lambda _: value
        case SignalValue(name=name):
            return lambda _: inputs.value_of(name)
        case FieldValue(event=event, field=field):
            return lambda payloads: number(payloads[event].get(field))
        case Captured(name=name):
            known = captured[name]
            return lambda _: known
        case UpdateValue(function=function, name=name):
            asked = getattr(History, function.value)
            return lambda _: asked(inputs.history_of(name), inputs.value_of(name))
        case Arithmetic(op=op, args=args):
            return _arithmetic(op.entry.apply, [reader(arg, inputs, captured) for arg in args])
        case _:
            assert_never(expression)


def _arithmetic(operation: Callable[..., float], args: list[Read]) -> Read:
    return lambda payloads: finite(operation, *[arg(payloads) for arg in args])
