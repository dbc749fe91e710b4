"""The names that random and hand-written test specifications speak of."""

from __future__ import annotations

from collections.abc import Container, Mapping

from rvmon.spec.checked.specification import Event, Signal, Type
from rvmon.trace.schema import Kind

BOOLS = ("p", "q", "r")
NUMBERS = ("x", "y")
"""A real number and a whole one."""
LABEL = "mode"
LABELS = ("red", "green", "blue")
EVENTS = ("e", "f")
CARRIER = "g"
"""The event with a payload."""
FIELD = "k"
FURTHER = "h"
"""Another event with a payload."""
SIZE = "m"
WIDE = (-(2**63), -(2**53) - 1, 0, 2**53, 2**53 + 1, 2**62, 2**63 - 1)
"""Whole numbers that doubles do not tell from their neighbours, but for 0."""


def signals(
    stale: Mapping[str, int] | None = None, ignoring: Container[str] = ()
) -> dict[str, Signal]:
    """The signals.

    Args:
        stale: those that are `stale after` so many ticks.
        ignoring: those of which NaN and null are no update.
    """
    kinds = {
        **dict.fromkeys(BOOLS, Type(Kind.BOOL)),
        **dict(zip(NUMBERS, (Type(Kind.REAL), Type(Kind.INT)), strict=True)),
        LABEL: Type(Kind.LABEL, labels=LABELS),
    }
    after = stale or {}
    return {
        name: Signal(name, type_, stale_after=after.get(name), ignores_nan=name in ignoring)
        for name, type_ in kinds.items()
    }


def events() -> dict[str, Event]:
    """The events."""
    fields = {CARRIER: {FIELD: Type(Kind.INT)}, FURTHER: {SIZE: Type(Kind.REAL)}}
    return {name: Event(name, fields.get(name, {})) for name in (*EVENTS, CARRIER, FURTHER)}
