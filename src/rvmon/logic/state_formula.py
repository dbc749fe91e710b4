"""State formulas: present and past only, so their value is known at once; and what atoms read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from rvmon.spec.checked.formula import (
    Amount,
    Arithmetic,
    BoundAtom,
    Captured,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Numeric,
    Passed,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
    WindowValue,
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


FALSE, UNKNOWN, TRUE = 0, 1, 2
"""Kleene's truth values: `and` is the minimum, `or` the maximum, `not` is 2 − x."""


@dataclass(frozen=True, slots=True)
class Elapsed:
    """At least `duration` ticks lie between the first position and this one."""

    duration: int


@dataclass(frozen=True, slots=True)
class Unborn:
    """Some signal has had no known value yet; two-valued.

    Attributes:
        signals: by name, whether an update after the first known value is asked for, too.
    """

    signals: tuple[tuple[str, bool], ...]


@dataclass(frozen=True, slots=True)
class Lost:
    """Unknown, whatever the input."""


@dataclass(frozen=True, slots=True)
class Lapsed:
    """It is not known any more which values an attempt has captured; two-valued."""


InputState = Lost | Unborn | Lapsed
"""What speaks of what is known, not of what is there."""

Shown = SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom
"""What has a name in a spec."""

Leaf = InputState | Shown | Constant | Elapsed
"""What is read off the input; spans are dropped, so that equal leaves are one."""


class StateOp(Enum):
    """Operators of state formulas, the least set that expresses all of SEMANTICS 1 to 3."""

    LEAF = "leaf"
    NOT = "not"
    AND = "and"
    OR = "or"
    PREVIOUS = "previous"
    SINCE = "since"
    AMOUNT = "amount"
    PASSED = "passed"
    COMPARED = "compared"
    """A comparison of windows; its operands: whether the rest is known, and then these."""
    SURE = "sure"
    """Two-valued: the operand is TRUE."""
    DOUBT = "doubt"
    """Whether a trigger may have been hidden: UNKNOWN at each position at which an attempt may
    start, or not; TRUE at the others of a stretch behind the first of these; else FALSE."""


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
        amount: of `AMOUNT`, what is measured; its operands are those of the state. A window alone
            is TRUE where it is known, and has a number.
        compared: of `COMPARED`, the comparison.
        passed: of `PASSED`, what time is asked for; the operand says whether it is known.
        unborn: of a `LEAF` over signals, the truth that it has before their birth.
        pulse: of `DOUBT`, whether the trigger starts an attempt wherever it is true.
        every: of `DOUBT`, whether no trigger is sure.
    """

    id: int
    op: StateOp
    args: tuple[State, ...] = ()
    leaf: Leaf | None = None
    low: int = 0
    high: int | None = None
    amount: Amount | WindowValue | None = None
    compared: Compare | None = None
    passed: Passed | None = None
    unborn: int = UNKNOWN
    pulse: bool = False
    every: bool = False
