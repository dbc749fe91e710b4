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

from rvmon.diagnostics import Span
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


@dataclass(frozen=True, slots=True)
class NowValue:
    """`now`: ticks since the first instant; unknown if an outage hides which that was."""


Numeric = Literal | NowValue | SignalValue | FieldValue | Captured | UpdateValue | Arithmetic


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
    """What is measured of a formula, or of a number, over the last D.

    Attributes:
        takes: what it is of, and its unit.
        doc: its value in a few words.
        unknown: what becomes of it where something in the window is not known.
        memory: that it takes.
    """

    COUNT = (
        *("count", "a formula that is true at single instants; a plain number"),
        "how often φ was true in the last D",
        *("between what it may be", "16 bytes a stretch of instants, 32 once one was unknown"),
    )
    DURATION = (
        *("duration", "a formula; a duration"),
        "for how long φ was true in the last D, up to this instant",
        *("between what it may be", "16 bytes a stretch of time, 32 once one was unknown"),
    )
    SUM = (
        *("sum", "fields of events, or a signal at its updates; their unit"),
        "what x came to in the last D, together",
        *("unknown", "32 bytes a value, and 296"),
    )
    MEAN = (
        *("mean", "signals, or fields of events; their unit"),
        "the mean of x at all instants of the last D, of a field at its occurrences",
        *("unknown, as of nothing", "32 bytes a stretch of one value, and 296"),
    )
    INTEGRAL = (
        *("integral", "signals; their unit times s"),
        "x times the time for which it was held, in the last D, up to this instant",
        *("unknown", "32 bytes a stretch of one value, and 296"),
    )

    takes: str
    doc: str
    unknown: str
    memory: str

    def __new__(
        cls, name: str, takes: str = "", doc: str = "", unknown: str = "", memory: str = ""
    ) -> Measured:
        """A member: the name that it is called by, with the rest of its entry."""
        made = str.__new__(cls, name)
        made._value_ = name
        made.takes, made.doc, made.unknown, made.memory = takes, doc, unknown, memory
        return made

    @property
    def of_numbers(self) -> bool:
        """Whether numbers are added up, exactly."""
        return self not in (Measured.COUNT, Measured.DURATION)


@dataclass(frozen=True, slots=True)
class Amount:
    """`count(φ, D) >= n`, `sum(x, D) >= c` and their kin; where φ is not born it does not hold.

    Of numbers, φ says at which positions there is one: a comparison of x with itself is unknown
    where that is, and FALSE where its event does not occur. Any that is unknown within the last D
    leaves the whole unknown. A mean of signals is not born before these are.

    Attributes:
        measured: what of it.
        operand: φ, of the present and past.
        window: D, ticks; `None`: since the first instant.
        least: of a count or duration, n, 1 or more.
        value: of numbers, x.
        limit: of numbers, c, in the unit of x; of an integral in that times seconds.
        strict: whether it is `> c`.
        known: a comparison of c with itself, if it may change.
    """

    measured: Measured
    operand: Formula
    window: int | None
    least: int = 1
    span: Span | None = None
    value: Numeric | None = None
    limit: Numeric | None = None
    strict: bool = False
    known: Compare | None = None

    @property
    def operands(self) -> tuple[Formula, ...]:
        """φ, and what says whether c is known."""
        return (self.operand,) if self.known is None else (self.operand, self.known)


@dataclass(frozen=True, slots=True)
class Passed:
    """`now - t0 >= x`: at least so long has passed since an instant that was captured.

    Attributes:
        since: the name of that instant; `None`: since the first.
        after: x, seconds, rounded to whole ticks; halves to even ones.
        strict: whether it is `> x`.
        known: a comparison with itself of what it reads: where that is known.
    """

    since: str | None
    after: Numeric
    strict: bool
    known: Compare
    span: Span | None = None


def itself(value: Numeric, span: Span | None = None) -> Compare:
    """A comparison of a number with itself: unknown where that is, else true."""
    return Compare(CompareOp.EQ, value, value, span)


def passed(since: str | None, after: Numeric, strict: bool, span: Span | None = None) -> Passed:
    """That so many seconds have passed since an instant that was captured, or the first."""
    read = after if since is None else Arithmetic(NumericOp.ADD, (Captured(since), after))
    return Passed(since, after, strict, itself(read), span)


Atom = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom
Formula = Atom | Unary | Binary | Amount | Passed
