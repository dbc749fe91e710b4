"""A specification whose names are known: what each is declared as, once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.diagnostics.span import Source, Span
from rvmon.spec.checked.specification import Role
from rvmon.spec.syntax.expressions import Expression, Ident
from rvmon.spec.syntax.items import (
    ConstItem,
    CoverItem,
    CoverpointItem,
    CrossItem,
    DefineItem,
    DelayItem,
    EventSyntax,
    Header,
    PropertyItem,
    RequirementItem,
    TimeItem,
    TypeSyntax,
)


@dataclass(frozen=True, slots=True)
class DeclaredSignal:
    """One signal of an item."""

    name: Ident
    type: TypeSyntax
    role: Role | None
    ignored: Span | None
    stale_after: Expression | None


@dataclass(frozen=True, slots=True)
class DeclaredEvent:
    """One event of an item."""

    name: Ident
    event: EventSyntax
    role: Role | None


Declared = DeclaredSignal | DeclaredEvent | DefineItem | ConstItem


@dataclass(frozen=True, slots=True)
class ResolvedSpec:
    """All items of a specification, each under its name.

    Attributes:
        sources: the main file, then those it imports.
        header: its `spec` line, if it has one.
        time: its `time` line, if it has one.
        delay: its `max delay` line, if it has one.
        declared: signals, events, macros and constants by name, in order.
        requirements: by id, in order.
        properties: that stand alone, by id, in order.
        covers: by id, in order.
        coverpoints: by name, in order.
        crosses: by name, in order.
        doubtful: words of items that could not be read.
    """

    sources: tuple[Source, ...]
    header: Header | None
    time: TimeItem | None
    delay: DelayItem | None
    declared: Mapping[str, Declared]
    requirements: Mapping[str, RequirementItem]
    properties: Mapping[str, PropertyItem]
    covers: Mapping[str, CoverItem]
    coverpoints: Mapping[str, CoverpointItem]
    crosses: Mapping[str, CrossItem]
    doubtful: frozenset[str]
