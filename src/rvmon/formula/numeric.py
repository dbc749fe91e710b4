"""What atoms read of the input."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Numeric,
    SignalAtom,
    SignalValue,
    UpdateValue,
)


def operands(expression: Numeric) -> Iterator[Numeric]:
    """What an expression is made of, without the operations."""
    match expression:
        case Arithmetic(args=args):
            for arg in args:
                yield from operands(arg)
        case _:
            yield expression


def signals_of(atom: SignalAtom | Compare) -> dict[str, bool]:
    """The signals that an atom reads; of each, whether it asks for an update after its birth.

    Source: SEMANTICS, section 1 (Birth).
    """
    if isinstance(atom, SignalAtom):
        return {atom.name: False}
    found: dict[str, bool] = {}
    for part in (*operands(atom.left), *operands(atom.right)):
        if isinstance(part, SignalValue | UpdateValue):
            found[part.name] = found.get(part.name, False) or isinstance(part, UpdateValue)
    return found


def reads_fields(atom: SignalAtom | Compare) -> bool:
    """Whether it speaks of the payload of an event."""
    return isinstance(atom, Compare) and any(
        isinstance(part, FieldValue) for part in (*operands(atom.left), *operands(atom.right))
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
