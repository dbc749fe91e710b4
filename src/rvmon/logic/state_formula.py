"""State formulas (present and past only, valued at each position) and the inputs atoms read."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum

from msgspec import Struct

from rvmon.language.checked import formula as rv


def operands(*expressions: rv.Numeric) -> Iterator[rv.Numeric]:
    """The non-arithmetic leaves of numeric expressions, from the left."""
    return (part for part in rv.numbers_in(*expressions) if not isinstance(part, rv.Arithmetic))


def signals_of(atom: rv.SignalAtom | rv.Compare) -> dict[str, bool]:
    """The signals an atom reads; the value says whether it needs an update after the birth.

    Source: SEMANTICS, section 1 (Birth).
    """
    if isinstance(atom, rv.SignalAtom):
        return {atom.name: False}
    found: dict[str, bool] = {}
    for part in operands(atom.left, atom.right):
        if isinstance(part, rv.SignalValue | rv.UpdateValue):
            found[part.name] = found.get(part.name, False) or isinstance(part, rv.UpdateValue)
    return found


def reads_fields(atom: rv.SignalAtom | rv.Compare) -> bool:
    """Whether an atom reads a payload field of an event."""
    return isinstance(atom, rv.Compare) and any(rv.fields_in(atom.left, atom.right))


def inputs_of(*expressions: rv.Numeric) -> frozenset[str]:
    """The signals and events that expressions read."""
    read = (p for p in operands(*expressions) if isinstance(p, rv.SignalValue | rv.UpdateValue))
    return frozenset(part.name for part in read).union(events_of(*expressions))


def events_of(*expressions: rv.Numeric) -> tuple[str, ...]:
    """The events whose fields expressions read, each once."""
    return tuple(dict.fromkeys(field.event for field in rv.fields_in(*expressions)))


FALSE, UNKNOWN, TRUE = 0, 1, 2
"""Kleene's truth values: `and` is the minimum, `or` the maximum, `not` is 2 − x."""


class Elapsed(Struct, frozen=True):
    """At least `duration` ticks lie between the first position and this one."""

    duration: int


class Unborn(Struct, frozen=True):
    """Some signal has had no known value yet; two-valued."""

    # names, and whether an update after the first known value is needed as well
    signals: tuple[tuple[str, bool], ...]


class Lost(Struct, frozen=True):
    """Unknown, whatever the input."""


class Lapsed(Struct, frozen=True):
    """The captured values of the attempt have become uncertain; two-valued."""


InputState = Lost | Unborn | Lapsed
"""Leaves about the state of knowledge, not about values of the input."""

Shown = rv.SignalAtom | rv.EventAtom | rv.Compare | rv.ProbeAtom | rv.BoundAtom
"""Leaves that can be written in a specification."""

Leaf = InputState | Shown | rv.Constant | Elapsed
"""A leaf of a state formula; without spans, so that equal leaves are interned as one."""


class StateOp(StrEnum):
    """Operators of state formulas, a minimal set that expresses SEMANTICS 1 to 3."""

    LEAF = "leaf"
    NOT = "not"
    AND = "and"
    OR = "or"
    PREVIOUS = "previous"
    SINCE = "since"
    AMOUNT = "amount"
    PASSED = "passed"
    COMPARED = "compared"
    """A comparison between windows; operands: `known` of the other sides, then the windows."""
    SURE = "sure"  # two-valued: the operand is TRUE
    DOUBT = "doubt"
    """Whether a trigger may have been hidden: UNKNOWN where it is uncertain whether an attempt
    starts, TRUE at the other positions of that stretch from its first such one, else FALSE."""


class State(Struct, frozen=True, eq=False):
    """A state formula, interned by `Factory`: equal ones are the same object."""

    id: int  # creation order; operands have smaller ids than the operators above them
    op: StateOp
    args: tuple[State, ...] = ()
    leaf: Leaf | None = None  # of a `LEAF`, the input that it reads
    low: int = 0  # of `SINCE`, the least distance in ticks
    high: int | None = None  # of `SINCE`, the greatest distance; `None` if unbounded
    # of `AMOUNT`, the measured window, with or without a limit; its operands are `args`. Without a
    # limit the state is TRUE where the window's number is known
    amount: rv.Amount | rv.WindowValue | None = None
    compared: rv.Compare | None = None  # of `COMPARED`, the comparison
    # of `PASSED`, the instant and duration compared; `args` says whether it is known
    passed: rv.Passed | None = None
    unborn: int = UNKNOWN  # of a `LEAF` over signals, its truth value before their birth
    # of `DOUBT`, whether the trigger is a pulse (starts an attempt wherever it is true)
    pulse: bool = False
    every: bool = False  # of `DOUBT`, whether even a TRUE trigger counts as uncertain
