"""A model as written: names unresolved, templates not instantiated, each part with its place.

Both text forms, `.ta` and UPPAAL's XML, are read into these types, from which `elaborate` makes a
`Network`.
"""

from __future__ import annotations

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.models.network.expressions import BaseType, BinaryOp, PathOp, UnaryOp

# Expressions, as in guards, invariants, updates, declarations and queries.


class Number(Struct, frozen=True):
    """An integer, or `true` and `false` as 1 and 0."""

    value: int
    span: Span


class Decimal(Struct, frozen=True):
    """A number with a fraction."""

    value: float
    span: Span


class Name(Struct, frozen=True):
    """A name of anything."""

    name: str
    span: Span


class Index(Struct, frozen=True):
    """`base[index]`."""

    base: Expression
    index: Expression
    span: Span


class Member(Struct, frozen=True):
    """`base.name`: a location or a local variable of an automaton."""

    base: Expression
    name: str
    span: Span


class Rate(Struct, frozen=True):
    """`target'`: the rate of a clock."""

    target: Expression
    span: Span


class Call(Struct, frozen=True):
    """`name(arguments)`: the value of a function, or in a query an instance of a template."""

    name: str
    arguments: tuple[Expression, ...]
    span: Span


class Unary(Struct, frozen=True):
    """An operator on one operand."""

    op: UnaryOp
    operand: Expression
    span: Span


class Binary(Struct, frozen=True):
    """An operator on two operands."""

    op: BinaryOp
    left: Expression
    right: Expression
    span: Span


class Conditional(Struct, frozen=True):
    """`condition ? then : otherwise`."""

    condition: Expression
    then: Expression
    otherwise: Expression
    span: Span


class Quantified(Struct, frozen=True):
    """`forall (name : type) body`, `exists (…) …` or `sum (…) …` over a finite type."""

    op: BinaryOp
    name: str
    type: TypeText
    body: Expression
    span: Span


class Path(Struct, frozen=True):
    """A path operator on a formula; `bound` is the T of `[<=T]`, `left` the p of `[p U q]`."""

    op: PathOp
    body: Expression
    bound: Expression | None
    span: Span
    left: Expression | None = None


class LeadsTo(Struct, frozen=True):
    """`left --> right`, with `[<=T]` if bounded."""

    left: Expression
    right: Expression
    bound: Expression | None
    span: Span


class Assuming(Struct, frozen=True):
    """A query restricted to the runs that satisfy a formula."""

    query: Expression
    premise: Expression
    span: Span


class Chance(Struct, frozen=True):
    """`Pr[<=T; n](<> p)`, or with `[]`. A test compares it with a `level` by `op`."""

    op: PathOp
    body: Expression
    within: Expression
    runs: Expression | None
    sign: BinaryOp | None
    level: float
    span: Span


class Mean(Struct, frozen=True):
    """`E[<=T; n](max: e)`, or with `min`."""

    largest: bool
    value: Expression
    within: Expression
    runs: Expression | None
    span: Span


class Simulation(Struct, frozen=True):
    """`simulate [<=T; n] {e, …}`."""

    terms: tuple[Expression, ...]
    within: Expression
    runs: Expression | None
    span: Span


class Extremes(Struct, frozen=True):
    """`sup{where}: e, …`, `inf` or `bounds`; `ends` lists which (`True`: largest values)."""

    ends: tuple[bool, ...]
    where: Expression | None
    terms: tuple[Expression, ...]
    span: Span


Expression = (
    Number | Decimal | Name | Index | Member | Rate | Call | Unary | Binary | Conditional
    | Quantified | Path | LeadsTo | Assuming | Chance | Mean | Simulation | Extremes
)  # fmt: skip


# Declarations.


class TypeText(Struct, frozen=True):
    """A type as written."""

    base: BaseType
    span: Span
    # low, high: the range of an int; `None` if it has none
    low: Expression | None = None
    high: Expression | None = None
    name: str = ""  # of the typedef, for `NAMED`
    fields: tuple[Declaration, ...] = ()
    # const, broadcast, urgent: the prefixes
    const: bool = False
    broadcast: bool = False
    urgent: bool = False


class Values(Struct, frozen=True):
    """`{a, b, …}`: the initial values of an array."""

    items: tuple[Initial, ...]
    span: Span


Initial = Expression | Values

Size = Expression | TypeText
"""The size of an array: a number, or a type whose values are the indices."""


class Declaration(Struct, frozen=True):
    """One declared name."""

    type: TypeText
    name: str
    sizes: tuple[Size, ...]
    initial: Initial | None
    span: Span


class TypeDefinition(Struct, frozen=True):
    """`typedef type name`, or `typedef type name[size]…`."""

    name: str
    type: TypeText
    sizes: tuple[Size, ...]
    span: Span


class Parameter(Struct, frozen=True):
    """A parameter of a template or function; a `reference` stands for the argument itself."""

    type: TypeText
    name: str
    sizes: tuple[Size, ...]
    reference: bool
    span: Span


# Functions.


class UpdateText(Struct, frozen=True):
    """`target = value`. `x += v` and `x++` are expanded to this."""

    target: Expression
    value: Expression
    span: Span


class Branch(Struct, frozen=True):
    """`if (condition) then else otherwise`."""

    condition: Expression
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]
    span: Span


class Loop(Struct, frozen=True):
    """`while (condition) body`; the body includes the step of a `for`."""

    condition: Expression
    body: tuple[Statement, ...]
    span: Span


class Each(Struct, frozen=True):
    """`for (name : type) body`."""

    name: str
    type: TypeText
    body: tuple[Statement, ...]
    span: Span


class ReturnText(Struct, frozen=True):
    """`return value`, or without a value."""

    value: Expression | None
    span: Span


class Block(Struct, frozen=True):
    """Statements with a scope of their own."""

    statements: tuple[Statement, ...]
    span: Span


Statement = UpdateText | Call | Branch | Loop | Each | ReturnText | Block | Declaration


class FunctionText(Struct, frozen=True):
    """`type name(parameters) { … }`; `type` is `None` for `void`."""

    type: TypeText | None
    name: str
    parameters: tuple[Parameter, ...]
    body: Block
    span: Span


class PrioritiesText(Struct, frozen=True):
    """`chan priority a, b < default`: levels of channels of equal priority, lowest first."""

    levels: tuple[tuple[Expression, ...], ...]
    span: Span


Named = Declaration | TypeDefinition | FunctionText
Declared = Named | PrioritiesText
