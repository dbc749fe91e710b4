"""The syntax tree of a file: its items, in its own words and order."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.diagnostics import Source, Span
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import Mode, Role, TimeModel
from rvmon.language.syntax.expressions import Expression, Ident, Name, Number, Window


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
class ImportItem:
    """`import "file.rv"` or `import library`."""

    target: str
    library: bool
    span: Span


@dataclass(frozen=True, slots=True)
class SignalItem:
    """`signal a, b : TYPE ROLE ignore NaN stale after D`; `ignored` is where the words are."""

    names: tuple[Ident, ...]
    type: TypeSyntax
    role: Role | None
    ignored: Span | None
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
class WrittenMonitor:
    """`monitor as written`."""

    span: Span


@dataclass(frozen=True, slots=True)
class CoverMonitor:
    """`monitor as cover`."""

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


@dataclass(frozen=True, slots=True)
class ScopeClause:
    """`scope before (φ)`, `after (φ)`, `between (φ) and (ψ)`, `after (φ) until (ψ)`.

    Attributes:
        opening: the formula that opens the scope; `None`: it is open from the start.
        closing: the formula that closes the scope; `None`: nothing does.
        must_close: whether nothing is required unless the scope is closed.
        span: of the clause.
    """

    opening: Expression | None
    closing: Expression | None
    must_close: bool
    span: Span


@dataclass(frozen=True, slots=True)
class RunShareClause:
    """`in at least 95 % of runs`, `in at most 5 % of runs`."""

    at_least: bool
    share: Number
    span: Span


Clause = (
    TextClause
    | TagsClause
    | LetClause
    | ForEachClause
    | AtEndClause
    | PropertyClause
    | ScopeClause
    | RunShareClause
)


@dataclass(frozen=True, slots=True)
class RequirementItem:
    """A requirement with its clauses in the order of the file."""

    name: Ident
    text: str
    body: Bare | Triggered | ResponseMonitor | WrittenMonitor | CoverMonitor
    clauses: tuple[Clause, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class CoverItem:
    """`cover ID = formula`."""

    name: Ident
    formula: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class StepsSyntax:
    """`value => value => …`: the values that a coverpoint's expression takes in turn."""

    values: tuple[Expression, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class BinSyntax:
    """A bin: its values are those of a window, steps, an expression, or a label of its own name."""

    name: Ident
    values: Window | StepsSyntax | Expression | None
    kind: BinKind
    span: Span


@dataclass(frozen=True, slots=True)
class SampledClause:
    """`upon φ` of a coverpoint or cross."""

    trigger: Expression
    span: Span


@dataclass(frozen=True, slots=True)
class CountClause:
    """`goal N`, `weight N`."""

    word: str
    count: Number
    span: Span


@dataclass(frozen=True, slots=True)
class UnwantedClause:
    """`ignore φ` or `illegal φ` of a cross, over its coverpoints."""

    kind: BinKind
    condition: Expression
    span: Span


GoalClauses = SampledClause | CountClause | UnwantedClause


@dataclass(frozen=True, slots=True)
class CoverpointItem:
    """`coverpoint NAME = expression {bins}`."""

    name: Ident
    expression: Expression | None
    bins: tuple[BinSyntax, ...]
    clauses: tuple[GoalClauses, ...]
    span: Span


@dataclass(frozen=True, slots=True)
class CrossItem:
    """`cross NAME = points`."""

    name: Ident
    points: tuple[Ident, ...]
    clauses: tuple[GoalClauses, ...]
    span: Span


Item = (
    Header
    | TimeItem
    | DelayItem
    | ImportItem
    | SignalItem
    | EventItem
    | DefineItem
    | ConstItem
    | PropertyItem
    | RequirementItem
    | CoverItem
    | CoverpointItem
    | CrossItem
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
