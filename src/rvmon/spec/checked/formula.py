"""Formulas and numbers whose names, types and units are settled.

Macros and constants are expanded, durations are ticks, intervals are closed. `age(x) > D` and its
kin are rewritten with `updated(x)` and past operators. Operators are otherwise as written; their
meaning is SEMANTICS 2.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from rvmon.diagnostics.span import Span
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.operators import BinaryOp as BinaryOp
from rvmon.spec.checked.operators import Interval as Interval
from rvmon.spec.checked.operators import UnaryOp as UnaryOp

# Numeric (and label) expressions, evaluated in Python floats, ints or strings.


@dataclass(frozen=True, slots=True)
class Literal:
    """A number in the unit that the comparison is made in, or a label.

    Attributes:
        value: the number or label.
        unit: that unit's symbol, for people; "" if it has none.
    """

    value: float | int | str
    unit: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class SignalValue:
    """The held value of an int, real or label signal (bool: False is 0, True is 1)."""

    name: str


@dataclass(frozen=True, slots=True)
class FieldValue:
    """A payload field of an event; only meaningful where the event occurs."""

    event: str
    field: str


@dataclass(frozen=True, slots=True)
class Captured:
    """A value captured by `let` at the trigger, or the instance value of `for each`."""

    name: str


class UpdateFunction(StrEnum):
    """Functions of a signal's last two updates (SEMANTICS 2)."""

    PREV = "prev"
    DELTA = "delta"
    RATE = "rate"


@dataclass(frozen=True, slots=True)
class UpdateValue:
    """`prev(x)`, `delta(x)` or `rate(x)` (per second); unknown before the second update."""

    function: UpdateFunction
    name: str


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """An operation on numbers; a result that is no number (0/0, sqrt(-1), overflow) is unknown."""

    op: NumericOp
    args: tuple[Numeric, ...]


Numeric = Literal | SignalValue | FieldValue | Captured | UpdateValue | Arithmetic


class CompareOp(StrEnum):
    """Comparisons of numbers; labels know only `==` and `!=`.

    Attributes:
        holds: compares two numbers, or arrays of them.
        said: it as an English verb.

    >>> CompareOp.LE.holds(2, 3), CompareOp.LE.mirrored, CompareOp.LE.denied
    (True, <CompareOp.GE: '>='>, <CompareOp.GT: '>'>)
    """

    LT = "<", operator.lt, "is below"
    LE = "<=", operator.le, "is at most"
    EQ = "==", operator.eq, "is"
    NE = "!=", operator.ne, "is not"
    GE = ">=", operator.ge, "is at least"
    GT = ">", operator.gt, "is above"

    holds: Callable[[Any, Any], Any]
    said: str

    def __new__(
        cls, sign: str, holds: Callable[[Any, Any], Any] = operator.eq, said: str = ""
    ) -> CompareOp:
        """A member: its sign, with the comparison, and how it is said."""
        made = str.__new__(cls, sign)
        made._value_ = sign
        made.holds, made.said = holds, said
        return made

    @property
    def mirrored(self) -> CompareOp:
        """What is true of `b` and `a` where this is of `a` and `b`."""
        return CompareOp(self.translate(_MIRROR))

    @property
    def denied(self) -> CompareOp:
        """What is true where this is not."""
        return _DENIED.get(self) or next(op for op, other in _DENIED.items() if other is self)


_MIRROR = str.maketrans("<>", "><")

_DENIED = {
    CompareOp.LT: CompareOp.GE,
    CompareOp.LE: CompareOp.GT,
    CompareOp.EQ: CompareOp.NE,
}


@dataclass(frozen=True, slots=True)
class Constant:
    """`true` or `false`."""

    value: bool
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class SignalAtom:
    """A bool signal as a proposition."""

    name: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class EventAtom:
    """An event: true at the ticks at which it was published."""

    name: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Compare:
    """A comparison; one that reads fields of an event `e` means `e and comparison`."""

    op: CompareOp
    left: Numeric
    right: Numeric
    span: Span | None = None


class Probe(StrEnum):
    """Propositions about the updates of a signal (or event, for `updated`)."""

    KNOWN = "known"
    UPDATED = "updated"
    CHANGED = "changed"


@dataclass(frozen=True, slots=True)
class ProbeAtom:
    """`known(x)`, `updated(x)` (two-valued) or `changed(x)` (an update with another value)."""

    probe: Probe
    name: str
    span: Span | None = None


class Bound(StrEnum):
    """The two ends of a trace as propositions; `end` stands only alone, as a trigger."""

    START = "start"
    END = "end"


@dataclass(frozen=True, slots=True)
class BoundAtom:
    """`start` is true at the first position; `end` when the trace is finished."""

    bound: Bound
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Unary:
    """An operator on one formula; `interval` is `None` exactly where the operator has none."""

    op: UnaryOp
    operand: Formula
    interval: Interval | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator on two formulas; `interval` is `None` exactly where the operator has none."""

    op: BinaryOp
    left: Formula
    right: Formula
    interval: Interval | None = None
    span: Span | None = None


class Measured(StrEnum):
    """What is measured of a formula over the last D."""

    COUNT = "count"
    """The positions at which it holds, of those that `once[0, D]` looks at."""

    DURATION = "duration"
    """The ticks at which it holds, of those up to the one before this instant."""


@dataclass(frozen=True, slots=True)
class Amount:
    """`count(φ, D) >= n`, `duration(φ, D) >= n ticks`; where φ is not born it does not hold.

    Attributes:
        measured: which of the two.
        operand: φ, of the present and past.
        window: D, ticks.
        least: n, 1 or more.
    """

    measured: Measured
    operand: Formula
    window: int
    least: int
    span: Span | None = None


Atom = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom
Formula = Atom | Unary | Binary | Amount
