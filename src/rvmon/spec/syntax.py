"""The syntax tree: what a specification file says, in its own words and order."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rvmon.diagnostics.span import Source, Span
from rvmon.spec.checked import (
    BinaryOp,
    Bound,
    CompareOp,
    Mode,
    NumericOp,
    Role,
    TimeModel,
    UnaryOp,
)


@dataclass(frozen=True, slots=True)
class Ident:
    """A name where it is written; quotes are taken off."""

    text: str
    span: Span


# Expressions: formulas, numbers and durations alike.


@dataclass(frozen=True, slots=True)
class Number:
    """A number with its unit, "" if it has none; `value` is `None` if it is out of range."""

    value: Fraction | None
    unit: str
    span: Span


@dataclass(frozen=True, slots=True)
class Name:
    """A name of a signal, event, payload field, label, constant, macro or parameter."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Edge:
    """`start` or `end`."""

    bound: Bound
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """A built-in function or a macro with its arguments."""

    function: Ident
    args: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Group:
    """An expression in round brackets."""

    inner: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Window:
    """An interval of durations; `high` is `None` if it has no end."""

    low: Expression | None
    high: Expression | None
    low_open: bool
    high_open: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Prefix:
    """`not` or a temporal operator before a formula.

    `within D` is `eventually` and `for D` is `always` with a window from 0.
    """

    op: UnaryOp
    operand: Expression
    window: Window | None
    op_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Immediately:
    """`immediately φ`: φ itself, said on purpose."""

    operand: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Infix:
    """A connective or temporal operator between two formulas."""

    op: BinaryOp
    left: Expression
    right: Expression
    window: Window | None
    op_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Comparison:
    """A comparison of two expressions."""

    op: CompareOp
    left: Expression
    right: Expression
    op_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Operation:
    """Arithmetic on one or two expressions."""

    op: NumericOp
    args: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Path:
    """A path quantifier with a temporal operator: `AG p`, `E<> p`.

    Attributes:
        universal: whether it is `A`.
        reaching: whether it is written as `A[]`, which reaches to the end of the formula.
    """

    universal: bool
    op: UnaryOp
    operand: Expression
    window: Window | None
    reaching: bool
    op_span: Span
    span: Span


@dataclass(frozen=True, slots=True)
class Quantified:
    """`A[φ U ψ]`, `E[φ U ψ]`; `path` is what stands in the brackets."""

    universal: bool
    path: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class LeadsTo:
    """`φ --> ψ`: on all paths φ is always followed by ψ."""

    left: Expression
    right: Expression
    window: Window | None
    span: Span


Expression = (
    Number
    | Name
    | Truth
    | Edge
    | Call
    | Group
    | Prefix
    | Immediately
    | Infix
    | Comparison
    | Operation
    | Path
    | Quantified
    | LeadsTo
)


# Items.


@dataclass(frozen=True, slots=True)
class TypeSyntax:
    """A type as written: `name` is `bool`, `int`, `real` or `label`."""

    name: str
    unit: str
    labels: tuple[Ident, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Header:
    """`spec NAME "title"`."""

    name: Ident
    title: str
    span: Span


@dataclass(frozen=True, slots=True)
class TimeItem:
    """`time held`, `time sampled` or `time sampled every D`."""

    model: TimeModel
    period: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class DelayItem:
    """`max delay D`."""

    delay: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class SignalItem:
    """`signal a, b : TYPE ROLE stale after D`."""

    names: tuple[Ident, ...]
    type: TypeSyntax
    role: Role | None
    stale_after: Expression | None
    span: Span


@dataclass(frozen=True, slots=True)
class FieldSyntax:
    """A field of a payload."""

    name: Ident
    type: TypeSyntax


@dataclass(frozen=True, slots=True)
class EventSyntax:
    """One event of an item, with its payload's fields."""

    name: Ident
    fields: tuple[FieldSyntax, ...]


@dataclass(frozen=True, slots=True)
class EventItem:
    """`event a, pick(id: int) ROLE`."""

    events: tuple[EventSyntax, ...]
    role: Role | None
    span: Span


@dataclass(frozen=True, slots=True)
class DefineItem:
    """`define name = body`, `define name(p, d) = body`; no parameters is `None`."""

    name: Ident
    parameters: tuple[Ident, ...] | None
    body: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class ConstItem:
    """`const NAME = value`."""

    name: Ident
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class PropertyItem:
    """`property ID: CTL` alone."""

    name: Ident
    formula: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class Bare:
    """A requirement that is one formula."""

    formula: Expression


@dataclass(frozen=True, slots=True)
class Triggered:
    """`upon θ then ψ` or `whenever θ then ψ`."""

    mode: Mode
    trigger: Expression
    consequent: Expression


@dataclass(frozen=True, slots=True)
class ResponseMonitor:
    """`monitor as response within D`."""

    within: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class TextClause:
    """`source`, `rationale` or `severity` with its text."""

    word: str
    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class TagsClause:
    """`tags a, b`."""

    tags: tuple[str, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class LetClause:
    """`let v = expression`."""

    name: Ident
    value: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class ForEachClause:
    """`for each x in event.field`."""

    name: Ident
    field: Name
    span: Span


@dataclass(frozen=True, slots=True)
class AtEndClause:
    """`at end: policy`."""

    policy: Ident
    span: Span


@dataclass(frozen=True, slots=True)
class PropertyClause:
    """`property CTL` of a requirement."""

    formula: Expression
    span: Span


Clause = TextClause | TagsClause | LetClause | ForEachClause | AtEndClause | PropertyClause


@dataclass(frozen=True, slots=True)
class RequirementItem:
    """A requirement with its clauses in the order of the file."""

    name: Ident
    text: str
    body: Bare | Triggered | ResponseMonitor
    clauses: tuple[Clause, ...]
    span: Span


Item = (
    Header
    | TimeItem
    | DelayItem
    | SignalItem
    | EventItem
    | DefineItem
    | ConstItem
    | PropertyItem
    | RequirementItem
)


@dataclass(frozen=True, slots=True)
class ParsedSpec:
    """One file, item by item; its names are not looked at yet.

    Attributes:
        doubtful: words of items that could not be read; they may have declared any of these.
    """

    source: Source
    items: tuple[Item, ...]
    doubtful: frozenset[str] = frozenset()
