"""The syntax tree of a file: its items, in its own words and order."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.diagnostics.span import Source, Span
from rvmon.spec.checked import Mode, Role, TimeModel
from rvmon.spec.syntax import Expression, Ident, Name


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
