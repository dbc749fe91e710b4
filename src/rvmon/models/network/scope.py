"""Scopes: the names that are visible while a model is elaborated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from rvmon.diagnostics import Span
from rvmon.models.network.expressions import BaseType, Lookup, Slot

ConstantValue = int | tuple["ConstantValue", ...]  # a number, or an array of them


@dataclass(frozen=True, slots=True)
class ResolvedType:
    """A type with its constants evaluated. An int always has a range."""

    base: BaseType
    low: int = 0
    high: int = 1
    extents: tuple[range, ...] = ()  # the index range of each dimension; empty if not an array
    fields: tuple[tuple[str, ResolvedType], ...] = ()  # of a record, in order
    const: bool = False
    broadcast: bool = False
    urgent: bool = False

    @property
    def placed_as(self) -> BaseType:
        """The `kind` that a `PlacedSymbol` of this type has."""
        return self.base if self.base in (BaseType.CLOCK, BaseType.CHANNEL) else BaseType.INT


@dataclass(frozen=True, slots=True)
class ConstantSymbol:
    """A constant, a parameter's value, or a bound variable of a quantifier or `select`."""

    value: int
    is_real: bool = False  # whether the value is the bits of a double


@dataclass(frozen=True, slots=True)
class PlacedSymbol:
    """A variable, clock or channel. While the slot lacks indices, it is an array."""

    kind: BaseType  # `CLOCK`, `CHANNEL`, or `INT` for all variables
    slot: Slot
    is_real: bool = False  # whether its values are the bits of doubles


@dataclass(frozen=True, slots=True)
class TypeSymbol:
    """A typedef."""

    type: ResolvedType


@dataclass(frozen=True, slots=True)
class RecordSymbol:
    """A record, or an array of records: each field is declared as if it stood alone."""

    fields: tuple[tuple[str, Symbol], ...]


@dataclass(frozen=True, slots=True, eq=False)
class FunctionSymbol:
    """A function as written (`syntax.FunctionText`), and the scope that it sees."""

    written: Any
    scope: Scope


Symbol = ConstantSymbol | Lookup | PlacedSymbol | TypeSymbol | RecordSymbol | FunctionSymbol
"""What a name means. A `Lookup` is a constant array, or an element chosen by the variables."""


@dataclass(slots=True)
class Scope:
    """The names of one level, linked to the enclosing levels."""

    parent: Scope | None = None
    prefix: str = ""  # put before the names of what is declared here, such as `Train(1).`
    symbols: dict[str, Symbol] = field(default_factory=dict)
    places: dict[str, Span] = field(default_factory=dict)  # the declaration of each name
    families: set[str] = field(default_factory=set)  # names of automata, templates and instances

    def _levels(self) -> Iterator[Scope]:
        scope: Scope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def find(self, name: str) -> Symbol | None:
        """The innermost meaning of a name."""
        return next((s.symbols[name] for s in self._levels() if name in s.symbols), None)

    def declares(self, name: str) -> bool:
        """Whether a name is declared at this level or an enclosing one, even without a meaning."""
        return any(name in scope.places for scope in self._levels())

    def names_automaton(self, name: str) -> bool:
        """Whether a name without another meaning is the name of an automaton."""
        return any(name in scope.families for scope in self._levels())

    def names(self) -> list[str]:
        """All names visible from here."""
        return [name for scope in self._levels() for name in scope.symbols]

    def inner(self, symbols: Mapping[str, Symbol]) -> Scope:
        """A new level inside this one, with names of its own."""
        return Scope(self, self.prefix, dict(symbols))


@dataclass(frozen=True, slots=True)
class AutomatonSymbol:
    """An automaton as queries see it: its locations and its local names."""

    index: int
    locations: Mapping[str, int]
    scope: Scope


AutomatonKey = tuple[str, tuple[int, ...]]
"""The name of an automaton's template or instance, and the values of its parameters."""


@dataclass(frozen=True, slots=True)
class Names:
    """Everything that a query on a network may refer to."""

    top: Scope
    automata: Mapping[AutomatonKey, AutomatonSymbol]
    functions: Any
