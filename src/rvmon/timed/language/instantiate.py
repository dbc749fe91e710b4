"""Templates with their parameters bound: the processes that the system line names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.texts import did_you_mean
from rvmon.timed.language import automaton_syntax, syntax
from rvmon.timed.language.automaton_syntax import Document
from rvmon.timed.language.declare import Findings, check_range
from rvmon.timed.language.layout import MAX_VALUES, check_count, claim, count_of, values_of
from rvmon.timed.language.resolve import Resolver
from rvmon.timed.language.symbols import leaves
from rvmon.timed.model.operators import BaseType
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import (
    ConstantSymbol,
    PlacedSymbol,
    RecordSymbol,
    Scope,
    Symbol,
)

Family = automaton_syntax.Template | automaton_syntax.Instance
"""What a name in the system line may mean."""


@dataclass(frozen=True, slots=True)
class Process:
    """A template with all its parameters bound: an automaton to be."""

    family: str
    arguments: tuple[int, ...]
    template: automaton_syntax.Template
    scope: Scope
    priority: int


def processes_of(
    document: Document, top: Scope, resolver: Resolver, findings: Findings
) -> list[Process]:
    """All processes of the system, in its order; what is wrong goes to `findings`."""
    families: dict[str, Family] = {}
    declared: tuple[Family, ...] = (*document.templates, *document.instances)
    for family in declared:
        with findings.collect():
            claim(family.name, family.span, top)
            top.families.add(family.name)
            families[family.name] = family
    used = {instance.template.name for instance in document.instances}
    system = document.system
    if system is None:
        system = tuple(
            (syntax.Name(name, family.span), 0)
            for name, family in families.items()
            if name not in used
        )
    processes: list[Process] = []
    for name, priority in system:
        with findings.collect():
            if name.name not in families:
                fix = did_you_mean(name.name, list(families))
                raise model_error("TA002", f"no automaton `{name.name}`", name.span, fix)
            processes += _instances(families[name.name], families, top, resolver, priority)
    return processes


def _instances(
    family: Family,
    families: Mapping[str, Family],
    top: Scope,
    resolver: Resolver,
    priority: int,
) -> Iterator[Process]:
    """One process for each choice of the parameters' values."""
    _refuse_circle(family, families)
    ranges = []
    for parameter in family.parameters:
        if parameter.reference or parameter.sizes:
            fix = f"write instance = {family.name}(…)"
            message = f"the parameter `{parameter.name}` needs an argument"
            raise model_error("TA015", message, parameter.span, fix)
        ranges.append(values_of(resolver.type(parameter.type, top), parameter.type.span))
    for count, arguments in enumerate(product(*ranges)):
        if count >= MAX_VALUES:
            fix = "narrow the types of its parameters"
            raise model_error("TA019", f"more than {MAX_VALUES:,} instances", family.span, fix)
        bound = [ConstantSymbol(value) for value in arguments]
        template, scope = _bind(family, bound, families, top, resolver)
        listed = f"({', '.join(map(str, arguments))})" if arguments else ""
        scope.prefix = f"{family.name}{listed}."
        yield Process(family.name, arguments, template, scope, priority)


def _refuse_circle(family: Family, families: Mapping[str, Family]) -> None:
    """Refuse an instance of an instance of … itself."""
    seen: set[str] = set()
    current: Family | None = family
    while isinstance(current, automaton_syntax.Instance):
        if current.name in seen:
            fix = "make it an instance of an automaton"
            message = f"`{current.name}` is an instance of itself"
            raise model_error("TA015", message, current.span, fix)
        seen.add(current.name)
        current = families.get(current.template.name)


def _bind(
    family: Family,
    arguments: Sequence[Symbol],
    families: Mapping[str, Family],
    top: Scope,
    resolver: Resolver,
) -> tuple[automaton_syntax.Template, Scope]:
    scope = Scope(top)
    for parameter, argument in zip(family.parameters, arguments, strict=True):
        claim(parameter.name, parameter.span, scope)
        scope.symbols[parameter.name] = argument
    if isinstance(family, automaton_syntax.Template):
        return family, scope
    target = families.get(family.template.name)
    if target is None:
        fix = did_you_mean(family.template.name, list(families))
        message = f"no template `{family.template.name}`"
        raise model_error("TA002", message, family.template.span, fix)
    check_count(target.name, target.parameters, family.arguments, family.span)
    bound: list[Symbol] = []
    own = Scope(top)  # a parameter's type may speak of the parameters before it
    for parameter, written in zip(target.parameters, family.arguments, strict=True):
        bound.append(_argument(parameter, written, scope, own, resolver))
        own.symbols[parameter.name] = bound[-1]
    return _bind(target, bound, families, top, resolver)


def _argument(
    parameter: syntax.Parameter,
    written: syntax.Expression,
    scope: Scope,
    own: Scope,
    resolver: Resolver,
) -> Symbol:
    """What an argument stands for; its type has the names of `own`, itself those of `scope`."""
    kind = resolver.type(parameter.type, own)
    extents = (*resolver.extents(parameter.sizes, own), *kind.extents)
    if not parameter.reference and kind.base in (BaseType.INT, BaseType.BOOL) and not extents:
        value = resolver.constant(written, scope)
        check_range(value, kind, written.span)
        return ConstantSymbol(value)
    symbol = resolver.symbol(written, scope)
    match symbol:
        case PlacedSymbol(place, slot):
            fits = place is kind.placed_as and slot.extents[len(slot.indices) :] == extents
        case RecordSymbol():
            fits = bool(kind.fields) and len(leaves(symbol)) == count_of(kind, extents)
        case _:
            fits = isinstance(symbol, ConstantSymbol) and (kind.const or not parameter.reference)
    if not fits:
        fix = f"`{parameter.name}` is declared as {parameter.type.span.text}"
        raise model_error("TA015", "this argument is of the wrong kind", written.span, fix)
    return symbol
