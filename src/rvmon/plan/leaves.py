"""Leaves of state formulas: what they read, and their value at a position."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import assert_never

from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Elapsed, Lapsed, Leaf, Lost, Unborn
from rvmon.plan.inputs import Input
from rvmon.plan.numbers import captured_of, events_of, inputs_of, reader
from rvmon.runtime.past import compared
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


def truth_of(leaf: Leaf, inputs: Input) -> int:
    """The truth of a leaf that reads the values of signals and events, no captured ones.

    Raises:
        ValueError: the leaf reads something else.
    """
    match leaf:
        case SignalAtom(name=name):
            value = inputs.value_of(name)
            return UNKNOWN if value is None else TRUE if value else FALSE
        case EventAtom(name=name):
            found = inputs.payloads_of(name)
            return max((UNKNOWN if one is None else TRUE for one in found), default=FALSE)
        case Compare(op=op, left=left, right=right):
            sides = [reader(side, inputs, {}) for side in (left, right)]
            events = events_of(left, right)
            truths = [FALSE]
            for chosen in product(*map(inputs.payloads_of, events)):
                payloads = {e: p for e, p in zip(events, chosen, strict=True) if p is not None}
                whole = len(payloads) == len(events)
                truths.append(
                    compared(op.holds, *(side(payloads) for side in sides)) if whole else UNKNOWN
                )
            return max(truths)
        case _:
            raise ValueError(f"{leaf} reads more than values")
