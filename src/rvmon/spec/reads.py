"""Which signals and events a formula reads."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.spec.checked import (
    Arithmetic,
    Compare,
    EventAtom,
    FieldValue,
    Formula,
    Numeric,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
)
from rvmon.spec.tense import subformulas


def names_read(formula: Formula) -> Iterator[str]:
    """The names of the signals and events that a formula reads, with repetitions."""
    for part in subformulas(formula):
        match part:
            case SignalAtom(name=name) | EventAtom(name=name) | ProbeAtom(name=name):
                yield name
            case Compare(left=left, right=right):
                yield from names_in(left)
                yield from names_in(right)


def names_in(numeric: Numeric) -> Iterator[str]:
    """The names that a number is made of."""
    waiting = [numeric]
    while waiting:
        match waiting.pop():
            case SignalValue(name=name) | UpdateValue(name=name) | FieldValue(event=name):
                yield name
            case Arithmetic(args=args):
                waiting += args
