"""Expressions over the variables of a network, and statements that change variables and clocks.

Clocks and locations occur as propositions. Functions cannot recurse, so each function has fixed
slots for its parameters and local variables. These slots are negative and count from the end of the
values while the function runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import prod

from rvmon.diagnostics import Span

MAX_TIME = (1 << 31) - 1  # exclusive limit for numbers of units of time


class UnaryOp(StrEnum):
    """Operators on one operand."""

    NOT = "not"
    NEGATE = "-"
    INVERT = "~"


class BinaryOp(StrEnum):
    """Operators on two operands."""

    AND = "and"
    OR = "or"
    IMPLY = "imply"
    LT = "<"
    LE = "<="
    EQ = "=="
    NE = "!="
    GE = ">="
    GT = ">"
    ADD = "+"
    SUB = "-"
    MUL = "*"
    DIV = "/"
    MOD = "%"
    BIT_AND = "&"
    BIT_OR = "|"
    BIT_XOR = "^"
    SHIFT_LEFT = "<<"
    SHIFT_RIGHT = ">>"
    MINIMUM = "<?"
    MAXIMUM = ">?"


class PathOp(StrEnum):
    """Quantifiers over the runs from a state, each with a temporal operator and before its dual."""

    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    SOME_NEXT = "EX"
    EVERY_NEXT = "AX"
    FINALLY = "F"  # on one run: the body holds at some point, and `left` until then
    GLOBALLY = "G"  # the dual: the body holds up to and including the first state without `left`
    EVERY_RUN = "A"
    SOME_RUN = "E"


OUTERMOST = tuple(PathOp)[:4]  # the operators of UPPAAL


class BaseType(StrEnum):
    """The base types of declared names."""

    INT = "int"
    BOOL = "bool"
    DOUBLE = "double"
    CLOCK = "clock"
    CHANNEL = "chan"
    RECORD = "struct"
    NAMED = "typedef"


class LocationKind(StrEnum):
    """Whether time passes in a location, and whether the next step must leave it."""

    NORMAL = "normal"
    URGENT = "urgent"
    COMMITTED = "committed"


@dataclass(frozen=True, slots=True)
class Constant:
    """An integer. True is 1, false is 0."""

    value: int


TRUE = Constant(1)
FALSE = Constant(0)


@dataclass(frozen=True, slots=True)
class Slot:
    """A variable or channel, or an element of an array of them."""

    first: int  # index of the array's first element
    # the index range of each dimension of the array, outermost first; empty for a scalar
    extents: tuple[range, ...] = ()
    indices: tuple[Expression, ...] = ()  # one per dimension; each must lie in its extent
    span: Span | None = field(default=None, compare=False)

    @property
    def size(self) -> int:
        """The number of elements of the array; 1 for a scalar."""
        return prod(map(len, self.extents))

    @property
    def is_single(self) -> bool:
        """Whether the slot has all its indices, so that it names no array."""
        return len(self.indices) == len(self.extents)


@dataclass(frozen=True, slots=True)
class VariableValue:
    """The value of a variable."""

    slot: Slot


@dataclass(frozen=True, slots=True)
class Lookup:
    """An element of a constant array, chosen by the variables. The slot counts from 0."""

    values: tuple[int, ...]
    slot: Slot


@dataclass(frozen=True, slots=True)
class Invoke:
    """A call of a function, for its value or, as a statement, for its effects."""

    function: Function
    arguments: tuple[Expression, ...]
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class UnaryOperation:
    """An operator on one operand."""

    op: UnaryOp
    operand: Expression


@dataclass(frozen=True, slots=True)
class BinaryOperation:
    """An operator on two operands; `span` is the place of a division."""

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
    """Whether an automaton is in a location."""

    automaton: int
    location: int


class ClockOp(StrEnum):
    """Comparisons of a clock with a number."""

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
    """Whether no edge can be taken now or after any delay."""


@dataclass(frozen=True, slots=True)
class PathFormula:
    """A path operator applied to a formula."""

    op: PathOp
    body: Expression
    bound: int | None = None  # in units of time; `None` if there is none
    # For `E<>`, `A<>` and `F`: the formula that holds until the body does. Their duals carry it
    # unnegated.
    left: Expression = TRUE


@dataclass(frozen=True, slots=True)
class Fractional:
    """An operation on numbers with a fraction, which are represented by bits (see `fractions`)."""

    name: str
    operands: tuple[Expression, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


Expression = (
    Constant | Fractional | VariableValue | Lookup | Invoke | UnaryOperation | BinaryOperation
    | Choice | InLocation | ClockCompare | Deadlock | PathFormula
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Variable:
    """An integer in `[low, high]`; a bool is in `[0, 1]`, a real is the bits of a double."""

    name: str
    low: int
    high: int
    initial: int
    is_bool: bool = False
    is_real: bool = False


@dataclass(frozen=True, slots=True)
class Assignment:
    """`slot = value`; the value must lie in the range of `variable` (for an array: its first)."""

    slot: Slot
    value: Expression
    variable: Variable


@dataclass(frozen=True, slots=True)
class Reset:
    """`clock = value`, a number of units of time from 0 on."""

    clock: int
    value: Expression
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class If:
    """Statements for either truth of a condition."""

    condition: Expression
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class While:
    """Statements repeated as long as a condition holds, `MOST_ROUNDS` times at most."""

    condition: Expression
    body: tuple[Statement, ...]
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Return:
    """The end of a function, with its value. A `void` function returns 0."""

    value: Expression


@dataclass(frozen=True, slots=True)
class Missing:
    """The end of a function body without the required `return`; to reach it is an error."""

    function: str
    span: Span | None = field(default=None, compare=False)


Statement = Assignment | Reset | Invoke | If | While | Return | Missing

MOST_ROUNDS = 1_000_000  # limit for the rounds of all loops of one computation together


@dataclass(frozen=True, slots=True)
class Function:
    """A function with all that it refers to resolved."""

    name: str  # for people
    # the slots of the parameters that are passed by value, with their ranges
    parameters: tuple[tuple[int, Variable], ...]
    result: tuple[int, Variable]  # the slot for its value, with its range
    body: tuple[Statement, ...]  # ends with `Return` or `Missing` on every way
    room: int  # number of negative slots that the function and its callees may use
    changes: bool  # whether it sets a clock or a variable other than its own


def statements_in(statements: Sequence[Statement]) -> Iterator[Statement]:
    """Statements and all statements nested in them."""
    for statement in statements:
        yield statement
        match statement:
            case If(_, then, otherwise):
                yield from statements_in(then)
                yield from statements_in(otherwise)
            case While(_, body):
                yield from statements_in(body)
            case _:
                pass


def expressions_of(statement: Statement) -> tuple[Expression, ...]:
    """The expressions that a statement itself evaluates, without those of nested statements."""
    match statement:
        case Assignment(slot, value):
            return (*slot.indices, value)
        case Reset(_, value) | Return(value):
            return (value,)
        case Invoke():
            return (statement,)
        case If(condition) | While(condition):
            return (condition,)
        case Missing():
            return ()
