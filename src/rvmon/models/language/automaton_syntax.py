"""Automata as they were written, and the queries on them."""

from __future__ import annotations

from msgspec import Struct

from rvmon.diagnostics import Source, Span
from rvmon.models.language.syntax import (
    Call,
    Declared,
    Expression,
    Name,
    Parameter,
    TypeText,
    UpdateText,
)
from rvmon.models.network.expressions import LocationKind


class LocationText(Struct, frozen=True):
    """A location of a template; `leaving` is a rate, as a share."""

    name: str
    kind: LocationKind
    invariant: Expression | None
    span: Span
    leaving: tuple[Expression, Expression] | None = None


class SyncText(Struct, frozen=True):
    """`channel!` or `channel?`."""

    channel: Expression
    sends: bool
    span: Span


class Selection(Struct, frozen=True):
    """`name : type` of an edge: one edge for each value."""

    name: str
    type: TypeText
    span: Span


class EdgeText(Struct, frozen=True):
    """An edge of a template; `label` names the action for people and recordings.

    Attributes:
        shares: of a branch: its weight, and that of all branches together with it.
    """

    source: Name
    target: Name
    span: Span
    selections: tuple[Selection, ...] = ()
    guard: Expression | None = None
    sync: SyncText | None = None
    updates: tuple[UpdateText | Call, ...] = ()
    weight: float = 1.0
    label: str = ""
    shares: tuple[Expression, tuple[Expression, ...]] | None = None


class Template(Struct, frozen=True):
    """A template; without parameters it is an automaton by itself."""

    name: str
    parameters: tuple[Parameter, ...]
    declarations: tuple[Declared, ...]
    locations: tuple[LocationText, ...]
    initial: Name | None
    edges: tuple[EdgeText, ...]
    span: Span


class Instance(Struct, frozen=True):
    """`name(parameters) = template(arguments)`."""

    name: str
    parameters: tuple[Parameter, ...]
    template: Name
    arguments: tuple[Expression, ...]
    span: Span


class QueryText(Struct, frozen=True):
    """A query with its id and its sentence for people, either may be empty, and its own text."""

    id: str
    remark: str
    text: str
    formula: Expression
    span: Span


class SignalText(Struct, frozen=True):
    """`signal name = value`: what a specification calls something of the model."""

    name: str
    value: Expression
    span: Span


class Document(Struct, frozen=True):
    """A whole model as written.

    Attributes:
        unit: ticks of one unit of the model's time; `None` if it says nothing.
        system: the automata and templates that run, each with its priority; `None`: all that are
            there.
        open_ints: whether `int` without a range is allowed, as UPPAAL's 16 bits.
    """

    source: Source
    name: str
    title: str
    unit: int | None
    declarations: tuple[Declared, ...]
    templates: tuple[Template, ...]
    instances: tuple[Instance, ...]
    system: tuple[tuple[Name, int], ...] | None
    queries: tuple[QueryText, ...]
    signals: tuple[SignalText, ...] = ()
    open_ints: bool = False
