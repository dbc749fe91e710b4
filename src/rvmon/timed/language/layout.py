"""What arrays and records are made of: single things side by side, each field by itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Sized
from dataclasses import replace
from math import prod
from typing import Any, Protocol

from rvmon.diagnostics import Label, Span
from rvmon.texts import counted
from rvmon.timed.language import syntax
from rvmon.timed.model.expressions import Expression, Slot, Variable
from rvmon.timed.model.operators import BaseType
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import (
    ConstantSymbol,
    ConstantValue,
    FunctionSymbol,
    RecordSymbol,
    ResolvedType,
    Scope,
    Symbol,
)

MAX_VALUES = 10_000
"""The most values that a quantifier, a `select`, a parameter or an array may range over."""

INT16 = (-32768, 32767)
"""UPPAAL's `int` without a range."""

INT32 = (-(1 << 31), (1 << 31) - 1)
"""What a constant without a range may be."""

Extents = tuple[range, ...]
"""The indices of each dimension of an array, the outermost first."""

Value = ConstantValue | None
"""An initial value: of an array or record one for each part, in order; `None` without one."""


class Placer(Protocol):
    """Gives things their places."""

    def place(
        self, kind: ResolvedType, extents: Extents, names: Sequence[str], value: Value
    ) -> Symbol:
        """Make a symbol for things of one type, side by side."""
        ...


def laid_out(
    kind: ResolvedType,
    extents: Extents,
    names: Sequence[str],
    value: Value,
    placer: Placer,
    unnamed: Extents | None = None,
) -> Symbol:
    """The symbol of something declared; a record's fields are laid out one after the other.

    Args:
        kind: its type.
        extents: of the array, if it is one.
        names: what it is called.
        value: its initial value.
        placer: for single things and arrays of them.
        unnamed: the last dimensions, of which the names say nothing yet; default all.
    """
    suffixes = _suffixes(extents if unnamed is None else unnamed)
    names = [name + suffix for name in names for suffix in suffixes]
    if kind.base is not BaseType.RECORD:
        real = kind.base is BaseType.DOUBLE
        if kind.const and value is not None and not (real and extents):
            return ConstantSymbol(value, extents, real)
        return placer.place(kind, extents, names, value)
    fields = []
    for place, (field, written) in enumerate(kind.fields):
        own = replace(written, const=kind.const or written.const, extents=())
        inner = None if value is None else _field(value, len(extents), place)
        called = [f"{name}.{field}" for name in names]
        whole = (*extents, *written.extents)
        symbol = laid_out(own, whole, called, inner, placer, written.extents)
        fields.append((field, symbol))
    return RecordSymbol(tuple(fields))


def _field(value: ConstantValue, depth: int, place: int) -> ConstantValue:
    """The values of a field of all elements of an array of records."""
    assert isinstance(value, tuple), "a record's value has parts"
    if depth == 0:
        return value[place]
    return tuple(_field(element, depth - 1, place) for element in value)


def _suffixes(extents: Extents) -> list[str]:
    """The index of each element of an array, such as `[0]`; one empty text for a single thing."""
    if not extents:
        return [""]
    return [f"[{i}]{rest}" for i in extents[0] for rest in _suffixes(extents[1:])]


def variable_of(kind: ResolvedType, name: str, initial: int) -> Variable:
    """A variable of a type."""
    is_bool, is_real = kind.base is BaseType.BOOL, kind.base is BaseType.DOUBLE
    return Variable(name, kind.low, kind.high, initial, is_bool, is_real)


def default_of(kind: ResolvedType) -> int:
    """The value of a variable of a type that is given none."""
    return 0 if kind.low <= 0 <= kind.high else kind.low


def count_of(kind: ResolvedType, extents: Extents) -> int:
    """The single things that an array or record of a type has."""
    each = sum(count_of(field, field.extents) for _, field in kind.fields) if kind.fields else 1
    return prod(map(len, extents)) * each


Part = tuple[syntax.Initial, Extents, ResolvedType]
"""A part of an initial value: as written, the array that it is for, the type."""


def parts_of_initial(
    written: syntax.Initial, extents: Extents, kind: ResolvedType
) -> list[Part] | None:
    """The values for the elements of an array or the fields of a record; `None` of a single thing.

    Raises:
        ModelError: they are too few or too many, or a list stands where one value is expected.
    """
    if not isinstance(written, syntax.Values):
        if extents or kind.fields:
            fix = "write {a, b, …}"
            raise model_error("TA004", "an array needs a list of values", written.span, fix)
        return None
    expected = list(_expected(extents, kind))
    if len(expected) != len(written.items):
        count = f"{len(expected)} values" if expected else "one value"
        message = f"{count} expected, {len(written.items)} found"
        raise model_error("TA004", message, written.span)
    return [(item, *rest) for item, rest in zip(written.items, expected, strict=True)]


def _expected(extents: Extents, kind: ResolvedType) -> Iterator[tuple[Extents, ResolvedType]]:
    if extents:
        yield from [(extents[1:], kind)] * len(extents[0])
    for _, field in () if extents else kind.fields:
        yield field.extents, replace(field, extents=())


def values_of(kind: ResolvedType, span: Span) -> range:
    """All values of a finite type.

    Raises:
        ModelError: the type has none or too many.
    """
    if kind.base not in (BaseType.INT, BaseType.BOOL):
        raise model_error("TA004", "only int and bool types can be enumerated", span)
    if kind.high - kind.low >= MAX_VALUES:
        fix = "give a small range: int[low, high]"
        raise model_error("TA019", f"more than {MAX_VALUES:,} values", span, fix)
    return range(kind.low, kind.high + 1)


def check_count(name: str, parameters: Sized, arguments: Sized, span: Span) -> None:
    """Refuse too few or too many arguments."""
    count = len(parameters)
    if count != len(arguments):
        message = f"`{name}` takes {counted(count, 'argument')}, {len(arguments)} given"
        raise model_error("TA015", message, span)


def claim(name: str, span: Span, scope: Scope) -> None:
    """Note where a name is declared; refuse one that the same level already has."""
    if name in scope.places:
        first = Label(scope.places[name], "first declared here")
        raise model_error("TA003", f"two things named `{name}`", span, "rename one", others=[first])
    scope.places[name] = span


class Calls(Protocol):
    """Functions that can be called (`functions.Functions`)."""

    @property
    def locals(self) -> Sequence[Variable]:
        """The parameters and local variables; the first has slot −1."""
        ...

    def call(
        self, symbol: FunctionSymbol, written: syntax.Call, scope: Scope, resolver: Any
    ) -> Expression:
        """The value of a call."""
        ...

    def place(
        self, kind: ResolvedType, extents: Extents, names: Sequence[str], value: Value
    ) -> Symbol:
        """Make room for parameters or local variables."""
        ...

    def variable(self, slot: Slot) -> Variable:
        """The variable of a slot, or the first of its array."""
        ...
