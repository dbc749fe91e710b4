"""Checked formulas and numbers: names, types and units are resolved.

Macros and constants are expanded, durations are ticks, intervals are closed. Comparisons of ages
are rewritten with `updated(x)` and past operators. All other operators are as written; their
meaning is SEMANTICS 2.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.operators import BinaryOp as BinaryOp
from rvmon.language.checked.operators import Interval as Interval
from rvmon.language.checked.operators import UnaryOp as UnaryOp
from rvmon.language.checked.window_measures import Measured as Measured
from rvmon.trace.time import TICKS_PER_SECOND

# Numeric (and label) expressions, evaluated in Python floats, ints or strings.


@dataclass(frozen=True, slots=True)
class Literal:
    """A label, or a number in the unit of its comparison; `unit` is its symbol, for display."""

    value: float | int | str
    unit: str = field(default="", compare=False)


class SignalValue(Struct, frozen=True):
    """The held value of an int, real or label signal (bool: False is 0, True is 1)."""

    name: str


class FieldValue(Struct, frozen=True):
    """A payload field of an event; only meaningful where the event occurs."""

    event: str
    field: str


class Captured(Struct, frozen=True):
    """A value captured by `let` at the trigger, or the instance value of `for each`."""

    name: str


class UpdateFunction(StrEnum):
    """The functions of a signal's last two updates (SEMANTICS 2)."""

    PREV = "prev"
    DELTA = "delta"
    RATE = "rate"


class UpdateValue(Struct, frozen=True):
    """`prev(x)`, `delta(x)` or `rate(x)` (per second); unknown before the second update."""

    function: UpdateFunction
    name: str


class Arithmetic(Struct, frozen=True):
    """An operation on numbers; an undefined result (0/0, sqrt(-1), overflow) is unknown."""

    op: NumericOp
    args: tuple[Numeric, ...]


class NowValue(Struct, frozen=True):
    """`now`: ticks since the first instant; unknown if an outage hides which instant that was."""


class WindowValue(Struct, frozen=True):
    """`count(φ, D)`, `sum(x, D)` and the like: a measure of the members of a window.

    A member is a position at which φ is true, with the number x there; where φ is unborn there is
    no member. If x reads fields of one event, each occurrence that satisfies `chosen` is a member.
    """

    measured: Measured
    operand: Formula  # φ, of the present and past
    window: int | None  # D, ticks; `None`: since the first instant
    value: Numeric | None = None  # x; `None`: positions or ticks are counted
    # the n of `last(n, …)`: only the last n members count; `None`: all members of the window
    most: int | None = None
    # with `most`, the condition on which a member counts; over numbers, that x is known
    counted: Formula | None = None
    chosen: tuple[Compare, ...] = ()  # comparisons of fields, tested for each occurrence

    @property
    def operands(self) -> tuple[Formula, ...]:
        """All formulas of the window: φ, `counted` if there is one, and `chosen`."""
        operands = (self.operand, self.counted, *self.chosen)
        return tuple(part for part in operands if part is not None)

    @property
    def moves(self) -> bool:
        """Whether its value changes continuously between samples."""
        held = self.measured in (Measured.MEAN, Measured.VARIANCE) and self.most is None
        return self.measured.of_time or (
            held and not (self.value is not None and any(fields_in(self.value)))
        )

    @property
    def born_with(self) -> tuple[Compare, ...]:
        """The comparison that must be born first: that of x, if the measure needs a member."""
        asks = self.value is not None and self.measured.asks_for_one
        return (itself(self.value),) if asks and self.value is not None else ()


Read = NowValue | SignalValue | FieldValue | Captured | UpdateValue
"""Numbers that are read from the input or captured."""

Numeric = Literal | Read | WindowValue | Arithmetic


def numbers_in(*numbers: Numeric) -> Iterator[Numeric]:
    """Numbers and the operands of their arithmetic, from the left, without those in windows."""
    for number in numbers:
        yield number
        if isinstance(number, Arithmetic):
            yield from numbers_in(*number.args)


def windows_in(*numbers: Numeric) -> tuple[WindowValue, ...]:
    """The windows in numbers, each once, from the left."""
    windows = (one for one in numbers_in(*numbers) if isinstance(one, WindowValue))
    return tuple(dict.fromkeys(windows))


def fields_in(*numbers: Numeric) -> Iterator[FieldValue]:
    """The payload fields in numbers outside of windows, from the left."""
    return (one for one in numbers_in(*numbers) if isinstance(one, FieldValue))


class CompareOp(StrEnum):
    """The comparisons of numbers; labels have only `==` and `!=`.

    >>> CompareOp.LE.holds(2, 3), CompareOp.LE.mirrored, CompareOp.LE.denied
    (True, <CompareOp.GE: '>='>, <CompareOp.GT: '>'>)
    """

    LT = "<", operator.lt, "is below"
    LE = "<=", operator.le, "is at most"
    EQ = "==", operator.eq, "is"
    NE = "!=", operator.ne, "is not"
    GE = ">=", operator.ge, "is at least"
    GT = ">", operator.gt, "is above"

    holds: Callable[[Any, Any], Any]  # compares two numbers, or arrays of them
    wording: str  # its wording in English

    def __new__(
        cls, sign: str, holds: Callable[[Any, Any], Any] = operator.eq, wording: str = ""
    ) -> CompareOp:
        """A member: its sign, with the comparison and its wording."""
        member = str.__new__(cls, sign)
        member._value_ = sign
        member.holds, member.wording = holds, wording
        return member

    @property
    def mirrored(self) -> CompareOp:
        """The operator for swapped operands: `a < b` is `b > a`."""
        return CompareOp(self.translate(_MIRROR))

    @property
    def denied(self) -> CompareOp:
        """The operator of the negation: `not a < b` is `a >= b`."""
        return _DENIED.get(self) or next(op for op, other in _DENIED.items() if other is self)


_MIRROR = str.maketrans("<>", "><")

_DENIED = {CompareOp.LT: CompareOp.GE, CompareOp.LE: CompareOp.GT, CompareOp.EQ: CompareOp.NE}


class Constant(Struct, frozen=True):
    """`true` or `false`."""

    value: bool
    span: Span | None = None


class SignalAtom(Struct, frozen=True):
    """A bool signal as a proposition."""

    name: str
    span: Span | None = None


class EventAtom(Struct, frozen=True):
    """An event: true at the ticks at which it was published."""

    name: str
    span: Span | None = None


class Compare(Struct, frozen=True):
    """A comparison; one that reads fields of an event `e` means `e and comparison`."""

    op: CompareOp
    left: Numeric
    right: Numeric
    span: Span | None = None


class Probe(StrEnum):
    """Propositions about the updates of a signal; `updated` also applies to events."""

    KNOWN = "known"
    UPDATED = "updated"
    CHANGED = "changed"


class ProbeAtom(Struct, frozen=True):
    """`known(x)`, `updated(x)` (two-valued) or `changed(x)` (an update with another value)."""

    probe: Probe
    name: str
    span: Span | None = None


class Bound(StrEnum):
    """The two ends of a trace as propositions; `end` may only be a trigger by itself."""

    START = "start"
    END = "end"


class BoundAtom(Struct, frozen=True):
    """`start`, true at the first position, or `end`, true when the trace is finished."""

    bound: Bound
    span: Span | None = None


class Unary(Struct, frozen=True):
    """An operator on one formula; `interval` is `None` exactly where the operator has none."""

    op: UnaryOp
    operand: Formula
    interval: Interval | None = None
    span: Span | None = None


class Binary(Struct, frozen=True):
    """An operator on two formulas; `interval` is `None` exactly where the operator has none."""

    op: BinaryOp
    left: Formula
    right: Formula
    interval: Interval | None = None
    span: Span | None = None


class Amount(Struct, frozen=True):
    """`count(φ, D) >= n`, `sum(x, D) > c` and the like: a window compared exactly with a limit."""

    of: WindowValue
    # n or c, in the unit of the measure: ticks for a duration, the unit of x times seconds for an
    # integral, the square of the unit of x for a variance
    limit: Numeric
    strict: bool = False  # whether the comparison is `>`, not `>=`
    span: Span | None = None
    known: Compare | None = None  # the condition that the limit is known; `None` for a literal

    @property
    def operands(self) -> tuple[Formula, ...]:
        """The operands of the window, then the condition that the limit is known."""
        # The chosen comparisons come last, because `core/nodes.py` counts them from the end.
        operands = self.of.operands
        chosen = len(operands) - len(self.of.chosen)
        known = () if self.known is None else (self.known,)
        return (*operands[:chosen], *known, *operands[chosen:])

    @property
    def comparison(self) -> Compare:
        """The same as a comparison of numbers, for robustness; a duration is in seconds."""
        of, limit = self.of, self.limit
        if of.measured is Measured.DURATION and isinstance(limit, Literal):
            limit = Literal(int(limit.value) / TICKS_PER_SECOND, "s")
        return Compare(CompareOp.GT if self.strict else CompareOp.GE, of, limit, self.span)

    def has_distance(self, *, held: bool) -> bool:
        """Whether its robustness is computed: not if it moves between samples in held time."""
        return not (held and self.of.moves)

    @property
    def born_with(self) -> tuple[Compare, ...]:
        """The comparisons that must be born first: that of the limit, and that of the window."""
        return (*(() if self.known is None else (self.known,)), *self.of.born_with)


class Passed(Struct, frozen=True):
    """`now - t0 >= x`: at least x has passed since a captured instant."""

    since: str | None  # the name of the captured instant; `None`: the first instant of the trace
    after: Numeric  # x in seconds, rounded to whole ticks, halves to even
    strict: bool  # whether the comparison is `>`, not `>=`
    known: Compare  # the condition that everything it reads is known
    span: Span | None = None

    @property
    def starts(self) -> bool:
        """Whether it is true from a captured instant on, that is, `>= 0`."""
        return self.since is not None and self.after == Literal(0) and not self.strict


def itself(value: Numeric, span: Span | None = None) -> Compare:
    """The comparison of a number with itself: unknown where the number is, else true."""
    return Compare(CompareOp.EQ, value, value, span)


TRIGGERED = "upon"
"""The name under which the instant of the trigger is captured, for windows since the trigger."""


def since_trigger(span: Span | None = None) -> Passed:
    """The condition that the trigger has come."""
    return passed(TRIGGERED, Literal(0, "s"), False, span)


def passed(since: str | None, after: Numeric, strict: bool, span: Span | None = None) -> Passed:
    """The condition that a duration has passed since a captured instant, or since the start."""
    read = after if since is None else Arithmetic(NumericOp.ADD, (Captured(since), after))
    return Passed(since, after, strict, itself(read), span)


Atom = Constant | SignalAtom | EventAtom | Compare | ProbeAtom | BoundAtom
Formula = Atom | Unary | Binary | Amount | Passed
