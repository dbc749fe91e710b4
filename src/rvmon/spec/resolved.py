"""A specification whose names are known: what each is declared as, once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rvmon.diagnostics.span import Source
from rvmon.spec.checked import Role
from rvmon.spec.items import (
    ConstItem,
    DefineItem,
    DelayItem,
    EventSyntax,
    Header,
    PropertyItem,
    RequirementItem,
    TimeItem,
    TypeSyntax,
)
from rvmon.spec.syntax import Expression, Ident


@dataclass(frozen=True, slots=True)
class DeclaredSignal:
    """One signal of an item."""

    name: Ident
    type: TypeSyntax
    role: Role | None
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
        source: the main file.
        header: its `spec` line, if it has one.
        time: its `time` line, if it has one.
        delay: its `max delay` line, if it has one.
        declared: signals, events, macros and constants by name, in order.
        requirements: by id, in order.
        properties: that stand alone, by id, in order.
        doubtful: words of items that could not be read.
    """

    source: Source
    header: Header | None
    time: TimeItem | None
    delay: DelayItem | None
    declared: Mapping[str, Declared]
    requirements: Mapping[str, RequirementItem]
    properties: Mapping[str, PropertyItem]
    doubtful: frozenset[str]
