"""Automata and queries as written."""

from __future__ import annotations

from msgspec import Struct

from rvmon.diagnostics import Source, Span
from rvmon.models.language import syntax
from rvmon.models.network.expressions import LocationKind


class LocationText(Struct, frozen=True):
    """A location of a template; `leaving` is the exponential rate `a : b`."""

    name: str
    kind: LocationKind
    invariant: syntax.Expression | None
    span: Span
    leaving: tuple[syntax.Expression, syntax.Expression] | None = None


class SyncText(Struct, frozen=True):
    """`channel!` or `channel?`."""

    channel: syntax.Expression
    sends: bool
    span: Span


class Selection(Struct, frozen=True):
    """`name : type` of an edge, which stands for one edge per value."""

    name: str
    type: syntax.TypeText
    span: Span


class EdgeText(Struct, frozen=True):
    """An edge of a template; `label` is the name of its action for people and recordings."""

    source: syntax.Name
    target: syntax.Name
    span: Span
    selections: tuple[Selection, ...] = ()
    guard: syntax.Expression | None = None
    sync: SyncText | None = None
    updates: tuple[syntax.UpdateText | syntax.Call, ...] = ()
    weight: float = 1.0
    label: str = ""
    # of a branch of a branch point: its own weight, and the weights of all branches
    shares: tuple[syntax.Expression, tuple[syntax.Expression, ...]] | None = None


class Template(Struct, frozen=True):
    """A template. Without parameters it is itself an automaton."""

    name: str
    parameters: tuple[syntax.Parameter, ...]
    declarations: tuple[syntax.Declared, ...]
    locations: tuple[LocationText, ...]
    initial: syntax.Name | None
    edges: tuple[EdgeText, ...]
    span: Span


class Instance(Struct, frozen=True):
    """`name(parameters) = template(arguments)`."""

    name: str
    parameters: tuple[syntax.Parameter, ...]
    template: syntax.Name
    arguments: tuple[syntax.Expression, ...]
    span: Span


class QueryText(Struct, frozen=True):
    """A query with its id, a remark for people (both may be empty), and its text."""

    id: str
    remark: str
    text: str
    formula: syntax.Expression
    span: Span


class SignalText(Struct, frozen=True):
    """`signal name = value`: a name that specifications may use for something of the model."""

    name: str
    value: syntax.Expression
    span: Span


class Document(Struct, frozen=True):
    """A whole model as written."""

    source: Source
    name: str
    title: str
    unit: int | None  # ticks of one unit of time; `None` if the model names none
    declarations: tuple[syntax.Declared, ...]
    templates: tuple[Template, ...]
    instances: tuple[Instance, ...]
    # the automata and templates that run, each with its priority; `None`: all of them
    system: tuple[tuple[syntax.Name, int], ...] | None
    queries: tuple[QueryText, ...]
    signals: tuple[SignalText, ...] = ()
    open_ints: bool = False  # whether `int` may lack a range; it then has 16 bits as in UPPAAL
