"""Expressions over the variables of a network; clocks and locations occur as propositions."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from rvmon.diagnostics import Span
from rvmon.timed.model.operators import BinaryOp, PathOp, UnaryOp

MAX_TIME = (1 << 31) - 1
"""Numbers of units of time must be smaller."""


@dataclass(frozen=True, slots=True)
class Constant:
    """An integer; truth is 1, falsity 0."""

    value: int


TRUE = Constant(1)
FALSE = Constant(0)


@dataclass(frozen=True, slots=True)
class Slot:
    """A variable or channel, or an element of an array of them.

    Attributes:
        first: index of the array's first element.
        extents: the indices of each dimension of the array, the outermost first; empty for a
            single one.
        indices: one for each dimension; each must lie in its extent.
    """

    first: int
    extents: tuple[range, ...] = ()
    indices: tuple[Expression, ...] = ()
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class VariableValue:
    """The value of a variable."""

    slot: Slot


@dataclass(frozen=True, slots=True)
class Lookup:
    """An element of a constant array, chosen by the variables; `extent` are its indices."""

    values: tuple[int, ...]
    extent: range
    index: Expression
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class UnaryOperation:
    """An operator on one operand."""

    op: UnaryOp
    operand: Expression


@dataclass(frozen=True, slots=True)
class BinaryOperation:
    """An operator on two operands; `span` is where a division stands."""

    op: BinaryOp
    left: Expression
    right: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Choice:
    """`condition ? then : otherwise`."""

    condition: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True, slots=True)
class InLocation:
    """An automaton is in a location."""

    automaton: int
    location: int


class ClockOp(StrEnum):
    """How a clock is compared with a number."""

    LT = "<"
    LE = "<="
    GE = ">="
    GT = ">"


@dataclass(frozen=True, slots=True)
class ClockCompare:
    """A clock compared with a number of units of time."""

    clock: int
    op: ClockOp
    bound: Expression


@dataclass(frozen=True, slots=True)
class Deadlock:
    """No edge can be taken now or after any delay."""


@dataclass(frozen=True, slots=True)
class PathFormula:
    """A path operator.

    Attributes:
        bound: in units of time; `None` if there is none.
        left: what holds until the body does, for `E<>`, `A<>` and `F`; their negations keep it.
    """

    op: PathOp
    body: Expression
    bound: int | None = None
    left: Expression = TRUE


Expression = (
    Constant
    | VariableValue
    | Lookup
    | UnaryOperation
    | BinaryOperation
    | Choice
    | InLocation
    | ClockCompare
    | Deadlock
    | PathFormula
)
