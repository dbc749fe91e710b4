"""Turns declarations into clocks, variables and channels of a network, and names in a scope."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from math import prod
from typing import TypeVar

from rvmon.diagnostics import Diagnostic, Label, Severity, Span
from rvmon.errors import ModelError
from rvmon.models import finding, model_error, refusal
from rvmon.models.language import symbols, syntax
from rvmon.models.language.resolve import Resolver
from rvmon.models.network import Channel, Clock
from rvmon.models.network import scope as sc
from rvmon.models.network.expressions import BaseType, Constant, Slot, Variable

MAX_FINDINGS = 100  # checking stops after so many
MOST_SHOWN = 2  # further places shown for a finding that occurs in many
MAX_CLOCKS = 4_999  # limit for the clocks of a network: a zone has the square of it in numbers

MAX_PARTS = 100_000
"""Limit for the variables, and for the channels, of a network, counting elements of arrays."""

WIDE = 1 << 16  # UPPAAL's `int` has so many values; a variable with more gets a warning

Part = TypeVar("Part", Clock, Variable, Channel)


@dataclass(slots=True)
class Parts:
    """The parts of a network declared so far."""

    clocks: list[Clock] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)
    channel_spans: list[Span] = field(default_factory=list)
    # the priority of each channel, if any are declared; `None` stands for all others
    levels: dict[int | None, int] = field(default_factory=dict)
    are_split: bool = False  # whether a guard with clocks under `or` was split into several edges


@dataclass(slots=True)
class Findings:
    """Collects findings without duplicates, so that all errors of a model are reported together."""

    diagnostics: dict[tuple[str, str, int], Diagnostic] = field(default_factory=dict)

    def add(self, diagnostic: Diagnostic) -> None:
        """Add a finding. Instances of one template repeat its findings, which count once."""
        start = diagnostic.spans[0].span.start if diagnostic.spans else -1
        self.diagnostics.setdefault((diagnostic.code, diagnostic.message, start), diagnostic)
        if len(self.diagnostics) >= MAX_FINDINGS:
            self.raise_errors()

    def has(self, code: str) -> bool:
        """Whether there is a finding with a code."""
        return any(known == code for known, _, _ in self.diagnostics)

    def raise_errors(self) -> None:
        """Raise all errors found so far, if there are any."""
        errors = [d for d in self.diagnostics.values() if d.severity is Severity.ERROR]
        if errors:
            raise refusal(*_counted(errors))

    @contextmanager
    def collect(self) -> Iterator[None]:
        """Collect the findings of a `ModelError` raised inside, and continue after the block."""
        try:
            yield
        except ModelError as error:
            for diagnostic in error.diagnostics:
                self.add(diagnostic)


def _counted(findings: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Merge equal findings about several places into one, with their number and a few places."""
    alike: dict[tuple[str, str, str], list[Diagnostic]] = {}
    for diagnostic in findings:
        key = diagnostic.code, diagnostic.message, diagnostic.help
        alike.setdefault(key, []).append(diagnostic)
    for first, *others in alike.values():
        if not others:
            yield first
            continue
        further = [Label(label.span) for other in others[:MOST_SHOWN] for label in other.spans[:1]]
        message = f"{first.message} ({1 + len(others)} places)"
        yield replace(first, message=message, spans=(*first.spans, *further))


def declare(
    declared: Sequence[syntax.Declared],
    scope: sc.Scope,
    parts: Parts,
    resolver: Resolver,
    findings: Findings,
) -> None:
    """Give all declared names a meaning in `scope`, and add what they declare to `parts`."""
    for item in declared:
        with findings.collect():
            if isinstance(item, syntax.PrioritiesText):
                _rank(item, scope, parts, resolver)
                continue
            symbols.claim(item.name, item.span, scope)
            before = len(parts.variables)
            scope.symbols[item.name] = _symbol(item, scope, parts, resolver)
            if len(parts.variables) > before:
                _warn_of_range(parts.variables[before], item, findings)


def _rank(
    written: syntax.PrioritiesText, scope: sc.Scope, parts: Parts, resolver: Resolver
) -> None:
    """Record the priorities of channels; `None` stands for all channels not named."""
    if parts.levels:
        fix = "write one list, from the lowest to the highest"
        raise model_error("TA003", "a second list of priorities", written.span, fix)
    for level, names in enumerate(written.levels):
        for name in names:
            for one in _ranked(name, scope, resolver):
                if one in parts.levels:
                    raise model_error("TA003", "a second priority of one channel", name.span)
                parts.levels[one] = level
    if None not in parts.levels:
        fix = "name `default` too: all other channels, and steps without any"
        raise model_error("TA004", "priorities without `default`", written.span, fix)


def _ranked(name: syntax.Expression, scope: sc.Scope, resolver: Resolver) -> Iterator[int | None]:
    """The channels that a name in a list of priorities denotes; `None` for `default`."""
    if isinstance(name, syntax.Name) and name.name == "default":
        yield None
        return
    for leaf in symbols.leaves(resolver.symbol(name, scope)):
        match leaf:
            case sc.PlacedSymbol(BaseType.CHANNEL, Slot(first, ())):
                yield first
            case _:
                fix = "name channels, their arrays or elements, and `default`"
                raise model_error("TA004", "this is not a channel", name.span, fix)


def _warn_of_range(variable: Variable, item: syntax.Named, findings: Findings) -> None:
    count = variable.high - variable.low + 1
    if count > WIDE:
        message = f"`{item.name}` has {count:,} values; each one that occurs adds states"
        fix = "give it the range that it needs, such as int[0, 10]"
        findings.add(finding("TA005", message, item.span, fix, severity=Severity.WARNING))


def _symbol(item: syntax.Named, scope: sc.Scope, parts: Parts, resolver: Resolver) -> sc.Symbol:
    if isinstance(item, syntax.FunctionText):
        # A function sees itself and what is declared before it.
        seen = sc.Scope(scope.parent, scope.prefix, dict(scope.symbols), dict(scope.places))
        seen.symbols[item.name] = symbol = sc.FunctionSymbol(item, seen)
        return symbol
    kind = resolver.typed(item, scope)
    if isinstance(item, syntax.TypeDefinition):
        return sc.TypeSymbol(kind)
    symbols.check_size(prod(map(len, kind.extents)), item.span)
    value = None if item.initial is None else _initial(item.initial, kind, scope, resolver)
    if kind.const and value is None:
        fix = f"write const {item.name} = …"
        raise model_error("TA006", f"the constant `{item.name}` has no value", item.span, fix)
    return symbols.laid_out(kind, [scope.prefix + item.name], value, _Placer(parts, item.span))


@dataclass(frozen=True, slots=True)
class _Placer:
    """Adds declared things to the parts of a network."""

    parts: Parts
    span: Span

    def place(self, kind: sc.ResolvedType, names: Sequence[str], value: symbols.Value) -> int:
        """Append clocks, variables or channels with the given names; return the first index."""
        parts, span = self.parts, self.span
        match kind.base:
            case BaseType.CLOCK | BaseType.CHANNEL if value is not None:
                raise model_error("TA004", "a clock or channel has no initial value", span)
            case BaseType.CLOCK:
                first = _room(parts.clocks, len(names), MAX_CLOCKS, "clocks", span)
                parts.clocks += map(Clock, names)
            case BaseType.CHANNEL:
                first = _room(parts.channels, len(names), MAX_PARTS, "channels", span)
                parts.channels += [Channel(name, kind.broadcast, kind.urgent) for name in names]
                parts.channel_spans += [span] * len(names)
            case _:
                first = _room(parts.variables, len(names), MAX_PARTS, "variables", span)
                default = [symbols.default_of(kind)] * len(names)
                numbers = default if value is None else symbols.flat(value)
                parts.variables += map(partial(symbols.variable_of, kind), names, numbers)
        return first


def _room(parts: Sequence[Part], count: int, most: int, what: str, span: Span) -> int:
    """The index of the next part; refuses a declaration that would exceed the limit."""
    if len(parts) + count > most:
        fix = "declare smaller arrays, or fewer instances that have them"
        raise model_error("TA019", f"more than {most:,} {what}", span, fix)
    return len(parts)


def _initial(
    written: syntax.Initial, kind: sc.ResolvedType, scope: sc.Scope, resolver: Resolver
) -> sc.ConstantValue:
    has_parts = kind.extents or kind.fields
    if has_parts and isinstance(written, syntax.Name | syntax.Index | syntax.Member):
        return _copied(resolver.symbol(written, scope), kind, written.span)
    parts = symbols.parts_of_initial(written, kind)
    if parts is None:
        assert not isinstance(written, syntax.Values), "it would have parts"
        value = resolver.constant(written, scope, real=kind.base is BaseType.DOUBLE)
        symbols.check_range(value, kind, written.span)
        return value
    return tuple(_initial(*part, scope, resolver) for part in parts)


def _copied(symbol: sc.Symbol, kind: sc.ResolvedType, span: Span) -> sc.ConstantValue:
    """The values of a constant array or record."""
    if kind.extents:
        first, inner = kind.extents[0], replace(kind, extents=kind.extents[1:])
        elements = (symbols.element_of(symbol, Constant(index), span) for index in first)
        return tuple(_copied(element, inner, span) for element in elements)
    if kind.fields and isinstance(symbol, sc.RecordSymbol):
        pairs = zip(symbol.fields, kind.fields, strict=False)
        return tuple(_copied(own, field, span) for (_, own), (_, field) in pairs)
    match symbol:
        case sc.ConstantSymbol(value) if not kind.fields:
            symbols.check_range(value, kind, span)
            return value
        case _:
            fix = "name a constant array or record of the same type, or write {a, b, …}"
            raise model_error("TA004", "these are not the values of a constant", span, fix)
