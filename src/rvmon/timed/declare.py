"""Declarations to the clocks, variables and channels of a network, and to names in a scope."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import prod
from typing import TypeVar, assert_never

from rvmon.diagnostics import Diagnostic, Label, Span
from rvmon.errors import ModelError
from rvmon.timed import syntax
from rvmon.timed.model import Channel, Clock, Slot, Variable
from rvmon.timed.resolve import MAX_VALUES, Resolver, values_of
from rvmon.timed.rules import model_error
from rvmon.timed.scope import (
    ChannelSymbol,
    ClockSymbol,
    ConstantSymbol,
    ConstantValue,
    ResolvedType,
    Scope,
    Symbol,
    TypeSymbol,
    VariableSymbol,
)
from rvmon.timed.syntax import BaseType

Part = TypeVar("Part", Clock, Variable, Channel)


@dataclass(slots=True)
class Parts:
    """What the declarations of a model have made so far."""

    clocks: list[Clock] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)
    channel_spans: list[Span] = field(default_factory=list)


@dataclass(slots=True)
class Findings:
    """Collects what is wrong, each thing once, so that all errors of a model appear together."""

    found: dict[tuple[str, str, int], Diagnostic] = field(default_factory=dict)

    def add(self, diagnostic: Diagnostic) -> None:
        """Note a finding; template instances repeat those of their template."""
        start = diagnostic.spans[0].span.start if diagnostic.spans else -1
        self.found.setdefault((diagnostic.code, diagnostic.message, start), diagnostic)

    @contextmanager
    def collect(self) -> Iterator[None]:
        """Note the findings of a `ModelError` raised inside, and go on behind."""
        try:
            yield
        except ModelError as error:
            for diagnostic in error.diagnostics:
                self.add(diagnostic)


def declare(
    declared: Sequence[syntax.Declared],
    scope: Scope,
    parts: Parts,
    resolver: Resolver,
    findings: Findings,
) -> None:
    """Give all declared names a meaning in `scope`, and what they declare a place in `parts`."""
    for item in declared:
        with findings.collect():
            refuse_double(item.name, item.span, scope)
            scope.places[item.name] = item.span
            scope.symbols[item.name] = _symbol(item, scope, parts, resolver)


def refuse_double(name: str, span: Span, scope: Scope) -> None:
    """Refuse a name that the same level already has."""
    if name in scope.places:
        first = Label(scope.places[name], "first declared here")
        raise model_error("TA003", f"two things named `{name}`", span, "rename one", others=[first])


def _symbol(item: syntax.Declared, scope: Scope, parts: Parts, resolver: Resolver) -> Symbol:
    kind = resolver.type(item.type, scope)
    if isinstance(item, syntax.TypeDefinition):
        return TypeSymbol(kind)
    sizes = tuple(array_size(size, scope, resolver) for size in item.sizes)
    if prod(sizes) > MAX_VALUES:
        raise model_error("TA019", f"an array of more than {MAX_VALUES:,} elements", item.span)
    value = None if item.initial is None else _initial(item.initial, sizes, kind, scope, resolver)
    name = scope.prefix + item.name
    if kind.const:
        if value is None:
            mend = f"write const {item.name} = …"
            raise model_error("TA006", f"the constant `{item.name}` has no value", item.span, mend)
        return ConstantSymbol(value)
    match kind.base:
        case BaseType.CLOCK | BaseType.CHANNEL if value is not None:
            raise model_error("TA004", f"`{item.name}` cannot have an initial value", item.span)
        case BaseType.CLOCK:
            first = len(parts.clocks)
            parts.clocks += _spread(sizes, lambda suffix: Clock(name + suffix))
            return ClockSymbol(Slot(first, sizes))
        case BaseType.CHANNEL:
            first = len(parts.channels)
            parts.channels += _spread(
                sizes, lambda suffix: Channel(name + suffix, kind.broadcast, kind.urgent)
            )
            parts.channel_spans += [item.span] * prod(sizes)
            return ChannelSymbol(Slot(first, sizes))
        case BaseType.INT | BaseType.BOOL | BaseType.NAMED:
            first = len(parts.variables)
            numbers = iter(_flatten(_default(kind, sizes) if value is None else value))
            parts.variables += _spread(
                sizes, lambda suffix: _variable(name + suffix, kind, next(numbers))
            )
            return VariableSymbol(Slot(first, sizes))
        case _:
            assert_never(kind.base)


def _variable(name: str, kind: ResolvedType, initial: int) -> Variable:
    return Variable(name, kind.low, kind.high, initial, kind.base is BaseType.BOOL)


def array_size(size: syntax.Size, scope: Scope, resolver: Resolver) -> int:
    """The number of elements that a size gives; a type's values are the indices.

    Raises:
        ModelError: the size is not a constant above 0, or the type does not start at 0.
    """
    kind = _size_type(size, scope, resolver)
    if kind is not None:
        if kind.low != 0:
            mend = "array indices start at 0"
            raise model_error("TA007", "the index type does not start at 0", size.span, mend)
        return len(values_of(kind, size.span))
    assert not isinstance(size, syntax.TypeText)  # noqa: S101 - it would have a type
    number = resolver.constant(size, scope)
    if number < 1:
        raise model_error("TA007", f"an array of {number} elements", size.span)
    return number


def _size_type(size: syntax.Size, scope: Scope, resolver: Resolver) -> ResolvedType | None:
    if isinstance(size, syntax.TypeText):
        return resolver.type(size, scope)
    if isinstance(size, syntax.Name) and isinstance(symbol := scope.find(size.name), TypeSymbol):
        return symbol.type
    return None


def _initial(
    written: syntax.Initial,
    sizes: tuple[int, ...],
    kind: ResolvedType,
    scope: Scope,
    resolver: Resolver,
) -> ConstantValue:
    if not isinstance(written, syntax.Values):
        if sizes:
            mend = "write {a, b, …}"
            raise model_error("TA004", "an array needs a list of values", written.span, mend)
        value = resolver.constant(written, scope)
        check_range(value, kind, written.span)
        return value
    if not sizes or len(written.items) != sizes[0]:
        expected = f"{sizes[0]} values" if sizes else "one value"
        raise model_error("TA004", f"{expected} expected, {len(written.items)} found", written.span)
    return tuple(_initial(item, sizes[1:], kind, scope, resolver) for item in written.items)


def check_range(value: int, kind: ResolvedType, span: Span) -> None:
    """Refuse a constant that its type cannot hold."""
    if kind.base in (BaseType.INT, BaseType.BOOL) and not kind.low <= value <= kind.high:
        raise model_error("TA007", f"{value} is outside [{kind.low}, {kind.high}]", span)


def _default(kind: ResolvedType, sizes: tuple[int, ...]) -> ConstantValue:
    value: ConstantValue = 0 if kind.low <= 0 <= kind.high else kind.low
    for size in reversed(sizes):
        value = (value,) * size
    return value


def _flatten(value: ConstantValue) -> list[int]:
    if isinstance(value, int):
        return [value]
    return [number for item in value for number in _flatten(item)]


def _spread(sizes: tuple[int, ...], make: Callable[[str], Part]) -> list[Part]:
    return [make(suffix) for suffix in _suffixes(sizes)]


def _suffixes(sizes: tuple[int, ...]) -> list[str]:
    """`[0]`, `[1]`, … for each element of an array; one empty text for a single thing."""
    if not sizes:
        return [""]
    return [f"[{i}]{rest}" for i in range(sizes[0]) for rest in _suffixes(sizes[1:])]
