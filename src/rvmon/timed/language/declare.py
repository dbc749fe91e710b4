"""Declarations to the clocks, variables and channels of a network, and to names in a scope."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import prod
from typing import TypeVar, assert_never

from rvmon.diagnostics import Diagnostic, Label, Severity, Span
from rvmon.errors import ModelError
from rvmon.timed.language import syntax
from rvmon.timed.language.resolve import MAX_VALUES, Resolver, values_of
from rvmon.timed.model.expressions import Slot
from rvmon.timed.model.network import Channel, Clock, Variable
from rvmon.timed.model.operators import BaseType
from rvmon.timed.model.rules import finding, model_error, refusal
from rvmon.timed.model.scope import (
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

MAX_FINDINGS = 100
"""Behind so many, nothing more is looked for."""

MAX_CLOCKS = 255
"""The most clocks of a network: a zone has the square of it in numbers."""

MAX_PARTS = 100_000
"""The most variables, and the most channels, of a network with all elements of its arrays."""

WIDE = 1 << 16
"""A variable with more values gets a warning; UPPAAL's `int` has so many."""

Part = TypeVar("Part", Clock, Variable, Channel)
Read = TypeVar("Read")


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
        """Note a finding; template instances repeat those of their template.

        Raises:
            ModelError: there are so many that looking for more would help nobody.
        """
        start = diagnostic.spans[0].span.start if diagnostic.spans else -1
        self.found.setdefault((diagnostic.code, diagnostic.message, start), diagnostic)
        if len(self.found) >= MAX_FINDINGS:
            self.raise_errors()

    def has(self, code: str) -> bool:
        """Whether a finding of a code is among them."""
        return any(found == code for found, _, _ in self.found)

    def raise_errors(self) -> None:
        """Raise all errors found so far, if there are any."""
        errors = [d for d in self.found.values() if d.severity is Severity.ERROR]
        if errors:
            raise refusal(*errors)

    def attempt(self, read: Callable[[], Read], default: Read) -> Read:
        """What `read` returns, or the default if it finds something wrong, which is noted."""
        try:
            return read()
        except ModelError as error:
            for diagnostic in error.diagnostics:
                self.add(diagnostic)
            return default

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
            before = len(parts.variables)
            scope.symbols[item.name] = _symbol(item, scope, parts, resolver)
            if len(parts.variables) > before:
                _warn_of_range(parts.variables[before], item, findings)


def _warn_of_range(variable: Variable, item: syntax.Declared, findings: Findings) -> None:
    count = variable.high - variable.low + 1
    if count > WIDE:
        message = f"`{item.name}` has {count:,} values: each that it takes makes states of its own"
        fix = "give it the range that it needs, such as int[0, 10]"
        findings.add(finding("TA005", message, item.span, fix, severity=Severity.WARNING))


def refuse_double(name: str, span: Span, scope: Scope) -> None:
    """Refuse a name that the same level already has."""
    if name in scope.places:
        first = Label(scope.places[name], "first declared here")
        raise model_error("TA003", f"two things named `{name}`", span, "rename one", others=[first])


def _symbol(item: syntax.Declared, scope: Scope, parts: Parts, resolver: Resolver) -> Symbol:
    kind = resolver.type(item.type, scope)
    if isinstance(item, syntax.TypeDefinition):
        return TypeSymbol(kind)
    extents = tuple(array_extent(size, scope, resolver) for size in item.sizes)
    if prod(map(len, extents)) > MAX_VALUES:
        raise model_error("TA019", f"an array of more than {MAX_VALUES:,} elements", item.span)
    value = None if item.initial is None else _initial(item.initial, extents, kind, scope, resolver)
    name = scope.prefix + item.name
    if kind.const:
        if value is None:
            fix = f"write const {item.name} = …"
            raise model_error("TA006", f"the constant `{item.name}` has no value", item.span, fix)
        return ConstantSymbol(value, extents)
    match kind.base:
        case BaseType.CLOCK | BaseType.CHANNEL if value is not None:
            raise model_error("TA004", f"`{item.name}` cannot have an initial value", item.span)
        case BaseType.CLOCK:
            first = _room(parts.clocks, extents, MAX_CLOCKS, "clocks", item.span)
            parts.clocks += _spread(extents, lambda suffix: Clock(name + suffix))
            return ClockSymbol(Slot(first, extents))
        case BaseType.CHANNEL:
            first = _room(parts.channels, extents, MAX_PARTS, "channels", item.span)
            parts.channels += _spread(
                extents, lambda suffix: Channel(name + suffix, kind.broadcast, kind.urgent)
            )
            parts.channel_spans += [item.span] * prod(map(len, extents))
            return ChannelSymbol(Slot(first, extents))
        case BaseType.INT | BaseType.BOOL | BaseType.NAMED:
            first = _room(parts.variables, extents, MAX_PARTS, "variables", item.span)
            numbers = iter(_flatten(_default(kind, extents) if value is None else value))
            parts.variables += _spread(
                extents, lambda suffix: _variable(name + suffix, kind, next(numbers))
            )
            return VariableSymbol(Slot(first, extents))
        case _:
            assert_never(kind.base)


def _room(
    parts: Sequence[Part], extents: tuple[range, ...], most: int, what: str, span: Span
) -> int:
    """The index of the next part, if as many as a declaration makes may be added."""
    if len(parts) + prod(map(len, extents)) > most:
        fix = "declare smaller arrays, or fewer instances of what has them"
        raise model_error("TA019", f"more than {most:,} {what}", span, fix)
    return len(parts)


def _variable(name: str, kind: ResolvedType, initial: int) -> Variable:
    return Variable(name, kind.low, kind.high, initial, kind.base is BaseType.BOOL)


def array_extent(size: syntax.Size, scope: Scope, resolver: Resolver) -> range:
    """The indices that a size gives: those below a number, or a type's values.

    Raises:
        ModelError: the size is not a constant above 0, or the type has too many values.
    """
    kind = _size_type(size, scope, resolver)
    if kind is not None:
        return values_of(kind, size.span)
    assert not isinstance(size, syntax.TypeText)  # noqa: S101 - it would have a type
    number = resolver.constant(size, scope)
    if number < 1:
        raise model_error("TA007", f"an array of {number} elements", size.span)
    if number > MAX_VALUES:
        raise model_error("TA019", f"an array of more than {MAX_VALUES:,} elements", size.span)
    return range(number)


def _size_type(size: syntax.Size, scope: Scope, resolver: Resolver) -> ResolvedType | None:
    if isinstance(size, syntax.TypeText):
        return resolver.type(size, scope)
    if isinstance(size, syntax.Name) and isinstance(symbol := scope.find(size.name), TypeSymbol):
        return symbol.type
    return None


def _initial(
    written: syntax.Initial,
    extents: tuple[range, ...],
    kind: ResolvedType,
    scope: Scope,
    resolver: Resolver,
) -> ConstantValue:
    if not isinstance(written, syntax.Values):
        if extents:
            fix = "write {a, b, …}"
            raise model_error("TA004", "an array needs a list of values", written.span, fix)
        value = resolver.constant(written, scope)
        check_range(value, kind, written.span)
        return value
    if not extents or len(written.items) != len(extents[0]):
        expected = f"{len(extents[0])} values" if extents else "one value"
        raise model_error("TA004", f"{expected} expected, {len(written.items)} found", written.span)
    return tuple(_initial(item, extents[1:], kind, scope, resolver) for item in written.items)


def check_range(value: int, kind: ResolvedType, span: Span) -> None:
    """Refuse a constant that its type cannot hold."""
    if kind.base in (BaseType.INT, BaseType.BOOL) and not kind.low <= value <= kind.high:
        raise model_error("TA007", f"{value} is outside [{kind.low}, {kind.high}]", span)


def _default(kind: ResolvedType, extents: tuple[range, ...]) -> ConstantValue:
    value: ConstantValue = 0 if kind.low <= 0 <= kind.high else kind.low
    for extent in reversed(extents):
        value = (value,) * len(extent)
    return value


def _flatten(value: ConstantValue) -> list[int]:
    if isinstance(value, int):
        return [value]
    return [number for item in value for number in _flatten(item)]


def _spread(extents: tuple[range, ...], make: Callable[[str], Part]) -> list[Part]:
    return [make(suffix) for suffix in _suffixes(extents)]


def _suffixes(extents: tuple[range, ...]) -> list[str]:
    """The index of each element of an array, such as `[0]`; one empty text for a single thing."""
    if not extents:
        return [""]
    return [f"[{i}]{rest}" for i in extents[0] for rest in _suffixes(extents[1:])]
