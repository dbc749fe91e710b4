"""State formulas: present and past only, so known at once; the propositions of the engines."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from rvmon.spec.checked import BoundAtom, Compare, Constant, EventAtom, ProbeAtom, SignalAtom

FALSE, UNKNOWN, TRUE = 0, 1, 2
"""Kleene's truth values: `and` is the minimum, `or` the maximum, `not` is 2 − x."""


@dataclass(frozen=True, slots=True)
class Elapsed:
    """At least `duration` ticks lie between the first position and this one."""

    duration: int


Leaf = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom | Elapsed
"""What is read off the input; spans are dropped, so that equal leaves are one."""


class StateOp(Enum):
    """Operators of state formulas, the least set that expresses all of SEMANTICS 2."""

    LEAF = "leaf"
    NOT = "not"
    AND = "and"
    OR = "or"
    PREVIOUS = "previous"
    SINCE = "since"


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """A state formula, made by `Factory`: equal ones are the same object.

    Attributes:
        id: position in the order of making; operands come before what they are part of.
        op: the operator.
        args: its operands.
        leaf: what a `LEAF` reads.
        low: of `SINCE`, the least distance in ticks.
        high: of `SINCE`, the greatest distance; `None` if unbounded.
        text: as in the spec.
    """

    id: int
    op: StateOp
    args: tuple[State, ...] = ()
    leaf: Leaf | None = None
    low: int = 0
    high: int | None = None
