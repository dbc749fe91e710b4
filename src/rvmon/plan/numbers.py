"""What numeric expressions read."""

from __future__ import annotations

from rvmon.formula.numeric import operands
from rvmon.spec.checked.formula import (
    Captured,
    FieldValue,
    Numeric,
    SignalValue,
    UpdateValue,
)


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
