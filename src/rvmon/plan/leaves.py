"""Leaves of state formulas: what they read, and their value at a position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import assert_never

from rvmon.formula.state import Elapsed, Lapsed, Leaf, Lost, Unborn
from rvmon.plan.numbers import captured_of, events_of, inputs_of
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Probe,
    ProbeAtom,
    SignalAtom,
)


@dataclass(frozen=True, slots=True)
class Reads:
    """What a leaf depends on.

    Attributes:
        names: signals and events whose updates can change it.
        momentary: whether it speaks of one position only and has to be read again at the next.
    """

    names: frozenset[str] = frozenset()
    momentary: bool = False


def reads(leaf: Leaf) -> Reads:
    """What a leaf depends on."""
    match leaf:
        case Constant() | Elapsed() | Lost() | Lapsed():
            return Reads()
        case Unborn(signals=signals):
            return Reads(frozenset(name for name, _ in signals))
        case BoundAtom():
            return Reads(momentary=True)
        case SignalAtom(name=name):
            return Reads(frozenset({name}))
        case EventAtom(name=name):
            return Reads(frozenset({name}), True)
        case ProbeAtom(probe=probe, name=name):
            return Reads(frozenset({name}), probe is not Probe.KNOWN)
        case Compare(left=left, right=right):
            return Reads(inputs_of(left, right), bool(events_of(left, right)))
        case _:
            assert_never(leaf)


def captured_names(leaf: Leaf) -> frozenset[str]:
    """The captured values that a leaf compares with."""
    if isinstance(leaf, Compare):
        return captured_of(leaf.left, leaf.right)
    return frozenset()
