"""Expressions over the variables of a network, and statements that change variables and clocks.

Clocks and locations occur as propositions. No function calls itself, so each has places of its own
for its parameters and local variables: slots below 0, which count from the end of the values while
it runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import prod

from rvmon.diagnostics import Span

MAX_TIME = (1 << 31) - 1  # numbers of units of time must be smaller


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
    """Quantifiers over the runs from a state, each with a temporal operator, beside its dual."""

    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    SOME_NEXT = "EX"
    EVERY_NEXT = "AX"
    FINALLY = "F"  # on one run: the body in the end, and `left` until then
    GLOBALLY = "G"  # its dual on one run: not `left` until the body is false
    EVERY_RUN = "A"
    SOME_RUN = "E"


OUTERMOST = tuple(PathOp)[:4]  # those that UPPAAL has


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
    """Whether time passes in a location, and whether it must be left next."""

    NORMAL = "normal"
    URGENT = "urgent"
    COMMITTED = "committed"


@dataclass(frozen=True, slots=True)
class Constant:
    """An integer; truth is 1, falsity 0."""

    value: int


TRUE = Constant(1)
FALSE = Constant(0)


@dataclass(frozen=True, slots=True)
class Slot:
    """A variable or channel, or an element of an array of them."""

    first: int  # index of the array's first element
    # the indices of each dimension of the array, the outermost first; empty for a single one
    extents: tuple[range, ...] = ()
    indices: tuple[Expression, ...] = ()  # one for each dimension; each must lie in its extent
    span: Span | None = field(default=None, compare=False)

    @property
    def size(self) -> int:
        """The number of elements of the array; 1 of a single one."""
        return prod(map(len, self.extents))

    @property
    def is_single(self) -> bool:
        """Whether it has all its indices, so that it is no array."""
        return len(self.indices) == len(self.extents)


@dataclass(frozen=True, slots=True)
class VariableValue:
    """The value of a variable."""

    slot: Slot


@dataclass(frozen=True, slots=True)
class Lookup:
    """An element of a constant array, chosen by the variables; the slot counts from 0."""

    values: tuple[int, ...]
    slot: Slot


@dataclass(frozen=True, slots=True)
class Invoke:
    """The value of a function, which runs when it is asked for; a statement: for what it does."""

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
    """No edge can be taken now or after any delay."""


@dataclass(frozen=True, slots=True)
class PathFormula:
    """A path operator."""

    op: PathOp
    body: Expression
    bound: int | None = None  # in units of time; `None` if there is none
    # the formula that holds until the body does, for `E<>`, `A<>` and `F`; their negations keep it
    left: Expression = TRUE


@dataclass(frozen=True, slots=True)
class Fractional:
    """An operation on numbers with a fraction, which are carried as bits (`fractions`)."""

    name: str
    operands: tuple[Expression, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


Expression = (
    Constant | Fractional | VariableValue | Lookup | Invoke | UnaryOperation | BinaryOperation
    | Choice | InLocation | ClockCompare | Deadlock | PathFormula
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Variable:
    """An integer in `[low, high]`; a bool is one in `[0, 1]`, a real is the bits of a double."""

    name: str
    low: int
    high: int
    initial: int
    is_bool: bool = False
    is_real: bool = False


@dataclass(frozen=True, slots=True)
class Assignment:
    """`slot = value`; the value must lie in the range of the variable, or of the array's first."""

    slot: Slot
    value: Expression
    variable: Variable


@dataclass(frozen=True, slots=True)
class Reset:
    """`clock = value`, a number of units of time that is not negative."""

    clock: int
    value: Expression
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class If:
    """Statements for each truth of a condition."""

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
    """The end of a function, with its value; that of a `cannot_pass` one is 0."""

    value: Expression


@dataclass(frozen=True, slots=True)
class Missing:
    """The end of a body that should have returned a value: a run that comes here has no meaning."""

    function: str
    span: Span | None = field(default=None, compare=False)


Statement = Assignment | Reset | Invoke | If | While | Return | Missing

MOST_ROUNDS = 1_000_000  # rounds that the loops of one computation may go together


@dataclass(frozen=True, slots=True)
class Function:
    """A function with all that it refers to resolved."""

    name: str  # for people
    # the slots of the parameters that are passed by value, with their ranges
    parameters: tuple[tuple[int, Variable], ...]
    result: tuple[int, Variable]  # the slot for its value, with its range
    body: tuple[Statement, ...]  # ends with `Return` or `Missing` on every way
    room: int  # slots below 0 that it and what it calls may use
    changes: bool  # whether it sets a variable that is not its own, or a clock


def statements_in(statements: Sequence[Statement]) -> Iterator[Statement]:
    """Statements and all inside them."""
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
    """The expressions that a statement itself evaluates."""
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
