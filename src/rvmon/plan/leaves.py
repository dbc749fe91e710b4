"""Leaves of state formulas: what they read, and their value at a position."""

from __future__ import annotations

from typing import assert_never

from rvmon.formula.numeric import captured_of, inputs_of
from rvmon.formula.state import Elapsed, Lapsed, Leaf, Lost, Unborn
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    ProbeAtom,
    SignalAtom,
)


def names_of(leaf: Leaf) -> frozenset[str]:
    """The signals and events whose updates can change a leaf."""
    match leaf:
        case Constant() | Elapsed() | Lost() | Lapsed() | BoundAtom():
            return frozenset()
        case Unborn(signals=signals):
            return frozenset(name for name, _ in signals)
        case SignalAtom(name=name) | EventAtom(name=name) | ProbeAtom(name=name):
            return frozenset({name})
        case Compare(left=left, right=right):
            return inputs_of(left, right)
        case _:
            assert_never(leaf)


def captured_names(leaf: Leaf) -> frozenset[str]:
    """The captured values that a leaf compares with."""
    if isinstance(leaf, Compare):
        return captured_of(leaf.left, leaf.right)
    return frozenset()
