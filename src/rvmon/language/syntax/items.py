"""The syntax tree of a file: its items as written, in the order of the file."""

from __future__ import annotations

from typing import ClassVar

from msgspec import Struct

from rvmon.diagnostics import Source, Span
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import Mode, Role, TimeModel
from rvmon.language.syntax.expressions import Expression, Ident, Name, Number, Window


class TypeSyntax(Struct, frozen=True):
    """A type as written: `name` is `bool`, `int`, `real` or `label`."""

    name: str
    unit: str
    labels: tuple[Ident, ...]
    span: Span


class Header(Struct, frozen=True):
    """`spec NAME "title"`."""

    name: Ident
    title: str
    span: Span


class TimeItem(Struct, frozen=True):
    """`time held`, `time sampled` or `time sampled every D`."""

    model: TimeModel
    period: Expression | None
    span: Span


class DelayItem(Struct, frozen=True):
    """`max delay D`."""

    delay: Expression
    span: Span


class ImportItem(Struct, frozen=True):
    """`import "file.rv"` or `import library`."""

    target: str
    library: bool
    span: Span


class SignalSyntax(Struct, frozen=True):
    """One signal of a declaration; `ignored` is the place of its `ignore NaN`."""

    word: ClassVar = "signal"
    name: Ident
    type: TypeSyntax
    role: Role | None
    ignored: Span | None
    stale_after: Expression | None


class FieldSyntax(Struct, frozen=True):
    """A field of a payload."""

    name: Ident
    type: TypeSyntax


class EventSyntax(Struct, frozen=True):
    """One event of a declaration, with the fields of its payload."""

    word: ClassVar = "event"
    name: Ident
    fields: tuple[FieldSyntax, ...]
    role: Role | None


class Declarations(Struct, frozen=True):
    """`signal a, b : TYPE ROLE ignore NaN stale after D`, `event a, pick(id: int) ROLE`."""

    each: tuple[SignalSyntax | EventSyntax, ...]
    span: Span


class DefineItem(Struct, frozen=True):
    """`define name = body` (`parameters` is `None`) or `define name(p, d) = body`."""

    word: ClassVar = "define"
    name: Ident
    parameters: tuple[Ident, ...] | None
    body: Expression
    span: Span


class ConstItem(Struct, frozen=True):
    """`const NAME = value`."""

    word: ClassVar = "const"
    name: Ident
    value: Expression
    span: Span


class PropertyItem(Struct, frozen=True):
    """`property ID: CTL` as an item of its own."""

    name: Ident
    formula: Expression
    span: Span


class Bare(Struct, frozen=True):
    """A requirement that is one formula."""

    formula: Expression


class Triggered(Struct, frozen=True):
    """`upon θ then ψ` or `whenever θ then ψ`."""

    mode: Mode
    trigger: Expression
    consequent: Expression


class ResponseMonitor(Struct, frozen=True):
    """`monitor as response within D`."""

    within: Expression
    span: Span


class WrittenMonitor(Struct, frozen=True):
    """`monitor as written`."""

    span: Span


class CoverMonitor(Struct, frozen=True):
    """`monitor as cover`."""

    span: Span


class TextClause(Struct, frozen=True):
    """`source`, `rationale` or `severity` with its text."""

    word: str
    text: str
    span: Span


class TagsClause(Struct, frozen=True):
    """`tags a, b`."""

    tags: tuple[str, ...]
    span: Span


class LetClause(Struct, frozen=True):
    """`let v = expression`."""

    name: Ident
    value: Expression
    span: Span


class ForEachClause(Struct, frozen=True):
    """`for each x in event.field`."""

    name: Ident
    field: Name
    span: Span


class AtEndClause(Struct, frozen=True):
    """`at end: policy`."""

    policy: Ident
    span: Span


class PropertyClause(Struct, frozen=True):
    """`property CTL` of a requirement."""

    formula: Expression
    span: Span


class ScopeClause(Struct, frozen=True):
    """`scope before (φ)`, `after (φ)`, `between (φ) and (ψ)`, `after (φ) until (ψ)`."""

    # the formula that opens the scope; `None`: the scope is open from the start
    opening: Expression | None
    closing: Expression | None  # the formula that closes the scope; `None`: it never closes
    must_close: bool  # whether nothing is required if the scope is never closed
    span: Span


class RunShareClause(Struct, frozen=True):
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


class RequirementItem(Struct, frozen=True):
    """A requirement with its clauses in the order of the file."""

    name: Ident
    text: str
    body: Bare | Triggered | ResponseMonitor | WrittenMonitor | CoverMonitor
    clauses: tuple[Clause, ...]
    span: Span


class CoverItem(Struct, frozen=True):
    """`cover ID = formula`."""

    name: Ident
    formula: Expression
    span: Span


class StepsSyntax(Struct, frozen=True):
    """`value => value => …`: the values that a coverpoint's expression takes in turn."""

    values: tuple[Expression, ...]
    span: Span


class BinSyntax(Struct, frozen=True):
    """A bin with the values that hit it; `None`: the label with the name of the bin."""

    name: Ident
    values: Window | StepsSyntax | Expression | None
    kind: BinKind
    span: Span


class SampledClause(Struct, frozen=True):
    """`upon φ` of a coverpoint or cross."""

    trigger: Expression
    span: Span


class CountClause(Struct, frozen=True):
    """`goal N`, `weight N`."""

    word: str
    count: Number
    span: Span


class UnwantedClause(Struct, frozen=True):
    """`ignore φ` or `illegal φ` of a cross; φ compares its coverpoints with bins."""

    kind: BinKind
    condition: Expression
    span: Span


GoalClauses = SampledClause | CountClause | UnwantedClause


class CoverpointItem(Struct, frozen=True):
    """`coverpoint NAME = expression {bins}`."""

    name: Ident
    expression: Expression | None
    bins: tuple[BinSyntax, ...]
    clauses: tuple[GoalClauses, ...]
    span: Span


class CrossItem(Struct, frozen=True):
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
    | Declarations
    | DefineItem
    | ConstItem
    | PropertyItem
    | RequirementItem
    | CoverItem
    | CoverpointItem
    | CrossItem
)


class ParsedSpec(Struct, frozen=True):
    """The items of one file, before names are resolved.

    `doubtful` are all words of items with syntax errors, any of which may be a declared name.
    """

    source: Source
    items: tuple[Item, ...]
    doubtful: frozenset[str] = frozenset()
