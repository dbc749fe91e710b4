"""A model as it was written: names unresolved, templates not instantiated, places noted.

Both text forms, `.ta` and UPPAAL's XML, are read into these types; `elaborate` makes a `Network`.
"""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.diagnostics import Span
from rvmon.models.network.expressions import BaseType, BinaryOp, PathOp, UnaryOp

# Expressions: of guards, invariants, updates, declarations and queries alike.


@dataclass(frozen=True, slots=True)
class Number:
    """An integer; `true` and `false` are 1 and 0."""

    value: int
    span: Span


@dataclass(frozen=True, slots=True)
class Decimal:
    """A number with a fraction."""

    value: float
    span: Span


@dataclass(frozen=True, slots=True)
class Name:
    """Anything that has a name."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Index:
    """`base[index]`."""

    base: Expression
    index: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Member:
    """`base.name`: a location or a local variable of an automaton."""

    base: Expression
    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Rate:
    """`target'`: how fast a clock runs."""

    target: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """`name(arguments)`: a function's value, or in a query an instance of a template."""

    name: str
    arguments: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Unary:
    """An operator on one operand."""

    op: UnaryOp
    operand: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator on two operands."""

    op: BinaryOp
    left: Expression
    right: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Conditional:
    """`condition ? then : otherwise`."""

    condition: Expression
    then: Expression
    otherwise: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Quantified:
    """`forall (name : type) body`, `exists (…) …` or `sum (…) …`: a finite type's values joined."""

    op: BinaryOp
    name: str
    type: TypeText
    body: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Path:
    """A path operator on a formula; `bound` is the T of `[<=T]`, `left` the p of `[p U q]`."""

    op: PathOp
    body: Expression
    bound: Expression | None
    span: Span
    left: Expression | None = None


@dataclass(frozen=True, slots=True)
class LeadsTo:
    """`left --> right`, with `[<=T]` if bounded."""

    left: Expression
    right: Expression
    bound: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class Assuming:
    """A query about the runs that a formula holds of."""

    query: Expression
    premise: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Chance:
    """`Pr[<=T; n](<> p)`, or with `[]`; compared with a `level` by `op` if it is a test."""

    op: PathOp
    body: Expression
    within: Expression
    runs: Expression | None
    sign: BinaryOp | None
    level: float
    span: Span


@dataclass(frozen=True, slots=True)
class Mean:
    """`E[<=T; n](max: e)`, or with `min`."""

    largest: bool
    value: Expression
    within: Expression
    runs: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class Simulation:
    """`simulate [<=T; n] {e, …}`."""

    terms: tuple[Expression, ...]
    within: Expression
    runs: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class Extremes:
    """`sup{where}: e, …`, `inf` or `bounds`; `ends` says which: the largest value, the least."""

    ends: tuple[bool, ...]
    where: Expression | None
    terms: tuple[Expression, ...]
    span: Span


Expression = (
    Number
    | Decimal
    | Name
    | Index
    | Member
    | Rate
    | Call
    | Unary
    | Binary
    | Conditional
    | Quantified
    | Path
    | LeadsTo
    | Assuming
    | Chance
    | Mean
    | Simulation
    | Extremes
)


# Declarations.


@dataclass(frozen=True, slots=True)
class TypeText:
    """A type as written.

    Attributes:
        low, high: the range of an int; `None` if it has none.
        name: of the typedef, for `NAMED`.
        fields: of a record.
        const, broadcast, urgent: the prefixes.
    """

    base: BaseType
    span: Span
    low: Expression | None = None
    high: Expression | None = None
    name: str = ""
    fields: tuple[Declaration, ...] = ()
    const: bool = False
    broadcast: bool = False
    urgent: bool = False


@dataclass(frozen=True, slots=True)
class Values:
    """`{a, b, …}`: the initial values of an array."""

    items: tuple[Initial, ...]
    span: Span


Initial = Expression | Values

Size = Expression | TypeText
"""The size of an array: a number, or a type whose values are its indices."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """One declared name."""

    type: TypeText
    name: str
    sizes: tuple[Size, ...]
    initial: Initial | None
    span: Span


@dataclass(frozen=True, slots=True)
class TypeDefinition:
    """`typedef type name`, or that of an array."""

    name: str
    type: TypeText
    sizes: tuple[Size, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a template or function; a `reference` stands for the thing itself."""

    type: TypeText
    name: str
    sizes: tuple[Size, ...]
    reference: bool
    span: Span


# Functions.


@dataclass(frozen=True, slots=True)
class UpdateText:
    """`target = value`; `x += v` and `x++` are written out."""

    target: Expression
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Branch:
    """`if (condition) then else otherwise`."""

    condition: Expression
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Loop:
    """`while (condition) body`; behind each round comes what a `for` does then."""

    condition: Expression
    body: tuple[Statement, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Each:
    """`for (name : type) body`."""

    name: str
    type: TypeText
    body: tuple[Statement, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class ReturnText:
    """`return value`, or without a value."""

    value: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class Block:
    """Statements with names of their own."""

    statements: tuple[Statement, ...]
    span: Span


Statement = UpdateText | Call | Branch | Loop | Each | ReturnText | Block | Declaration


@dataclass(frozen=True, slots=True)
class FunctionText:
    """`type name(parameters) { … }`; `type` is `None` for `cannot_pass`."""

    type: TypeText | None
    name: str
    parameters: tuple[Parameter, ...]
    body: Block
    span: Span


@dataclass(frozen=True, slots=True)
class PrioritiesText:
    """`chan priority a, b < default`: channels of one priority together, from the lowest."""

    levels: tuple[tuple[Expression, ...], ...]
    span: Span


Named = Declaration | TypeDefinition | FunctionText
Declared = Named | PrioritiesText
