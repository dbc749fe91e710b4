"""Turns templates into automata: binds parameters, resolves locations, unrolls `select`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, product

from rvmon.models import model_error, unknown
from rvmon.models import network as nta
from rvmon.models.language import automaton_syntax, symbols, syntax
from rvmon.models.language.automaton_syntax import Document
from rvmon.models.language.declare import Findings, Parts
from rvmon.models.language.operations import binary, refuse_clocks
from rvmon.models.language.resolve import Resolver
from rvmon.models.language.statements import is_price, updates_of
from rvmon.models.network import scope as sc
from rvmon.models.network.expressions import TRUE, BaseType, BinaryOp, Expression, Lookup
from rvmon.models.network.guards import guards_of, refuse_changes, split_guard

Family = automaton_syntax.Template | automaton_syntax.Instance
"""What a name in the system line may denote."""


@dataclass(frozen=True, slots=True)
class Process:
    """A template with all its parameters bound, which becomes an automaton."""

    family: str
    arguments: tuple[int, ...]
    template: automaton_syntax.Template
    scope: sc.Scope
    priority: int


def processes_of(
    document: Document, top: sc.Scope, resolver: Resolver, findings: Findings
) -> list[Process]:
    """All processes of the system, in its order; errors go to `findings`."""
    families: dict[str, Family] = {}
    declared: tuple[Family, ...] = (*document.templates, *document.instances)
    for family in declared:
        with findings.collect():
            symbols.claim(family.name, family.span, top)
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
                raise unknown("automaton", name.name, name.span, families)
            processes += _instances(families[name.name], families, top, resolver, priority)
    return processes


def _instances(
    family: Family, families: Mapping[str, Family], top: sc.Scope, resolver: Resolver, priority: int
) -> Iterator[Process]:
    """One process for each combination of values of the parameters."""
    _refuse_circle(family, families)
    ranges = []
    for parameter in family.parameters:
        if parameter.reference or parameter.sizes:
            fix = f"write instance = {family.name}(…)"
            message = f"the parameter `{parameter.name}` needs an argument"
            raise model_error("TA015", message, parameter.span, fix)
        ranges.append(symbols.values_of(resolver.type(parameter.type, top), parameter.type.span))
    for count, arguments in enumerate(product(*ranges)):
        if count >= symbols.MAX_VALUES:
            fix = "narrow the types of its parameters"
            message = f"more than {symbols.MAX_VALUES:,} instances"
            raise model_error("TA019", message, family.span, fix)
        bound = [sc.ConstantSymbol(value) for value in arguments]
        template, scope = _bind(family, bound, families, top, resolver)
        listed = f"({', '.join(map(str, arguments))})" if arguments else ""
        scope.prefix = f"{family.name}{listed}."
        yield Process(family.name, arguments, template, scope, priority)


def _refuse_circle(family: Family, families: Mapping[str, Family]) -> None:
    """Refuse an instance that is directly or indirectly an instance of itself."""
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
    arguments: Sequence[sc.Symbol],
    families: Mapping[str, Family],
    top: sc.Scope,
    resolver: Resolver,
) -> tuple[automaton_syntax.Template, sc.Scope]:
    scope = sc.Scope(top)
    for parameter, argument in zip(family.parameters, arguments, strict=True):
        symbols.claim(parameter.name, parameter.span, scope)
        scope.symbols[parameter.name] = argument
    if isinstance(family, automaton_syntax.Template):
        return family, scope
    target = families.get(family.template.name)
    if target is None:
        raise unknown("template", family.template.name, family.template.span, families)
    symbols.check_count(target.name, target.parameters, family.arguments, family.span)
    bound: list[sc.Symbol] = []
    own = sc.Scope(top)  # the type of a parameter may use the parameters before it
    for parameter, written in zip(target.parameters, family.arguments, strict=True):
        bound.append(_argument(parameter, written, scope, own, resolver))
        own.symbols[parameter.name] = bound[-1]
    return _bind(target, bound, families, top, resolver)


def _argument(
    parameter: syntax.Parameter,
    written: syntax.Expression,
    scope: sc.Scope,
    own: sc.Scope,
    resolver: Resolver,
) -> sc.Symbol:
    """The symbol of an argument. Its type is resolved in scope `own`, its expression in `scope`."""
    kind = resolver.typed(parameter, own)
    is_number = kind.placed_as is BaseType.INT and not (kind.extents or kind.fields)
    if is_number and not parameter.reference:
        return _constant(written, kind, scope, resolver)
    symbol = resolver.symbol(written, scope)
    match symbol:
        case sc.PlacedSymbol(place, slot, is_real):
            has_shape = slot.extents[len(slot.indices) :] == kind.extents
            is_alike = is_real == (kind.base is BaseType.DOUBLE)
            fits = place is kind.placed_as and has_shape and is_alike
        case sc.ConstantSymbol() if is_number and kind.const:
            return _constant(written, kind, scope, resolver)
        case sc.RecordSymbol():
            fits = bool(kind.fields) and len(symbols.leaves(symbol)) == symbols.count_of(kind)
        case _:
            is_constant = isinstance(symbol, sc.ConstantSymbol) or (
                isinstance(symbol, Lookup) and not symbol.slot.indices
            )
            fits = is_constant and (kind.const or not parameter.reference)
    if not fits:
        fix = f"`{parameter.name}` is declared as {parameter.type.span.text}"
        raise model_error("TA015", "this argument is of the wrong kind", written.span, fix)
    return symbol


def _constant(
    written: syntax.Expression, kind: sc.ResolvedType, scope: sc.Scope, resolver: Resolver
) -> sc.ConstantSymbol:
    """The value of an argument, converted to the type of its parameter."""
    real = kind.base is BaseType.DOUBLE
    value = resolver.constant(written, scope, real=real)
    symbols.check_range(value, kind, written.span)
    return sc.ConstantSymbol(value, real)


MAX_CASES = 16  # limit for the cases, each an edge, of a guard with clocks under `or`


def location_names(template: automaton_syntax.Template, findings: Findings) -> dict[str, int]:
    """The index of each location of a template; errors go to `findings`."""
    names: dict[str, int] = {}
    scope = sc.Scope()
    for index, location in enumerate(template.locations):
        with findings.collect():
            symbols.claim(location.name, location.span, scope)
            names[location.name] = index
    return names


def automaton_of(
    process: Process, names: Mapping[str, int], parts: Parts, resolver: Resolver, findings: Findings
) -> nta.Automaton:
    """Build the automaton of a process; errors go to `findings`."""
    template, scope = process.template, process.scope
    locations = []
    for written in template.locations:
        place = nta.Location(written.name, written.kind, nta.Guard(), written.span)
        with findings.collect():
            place = _place(written, scope, resolver)
        locations.append(place)
    edges: list[nta.Edge] = []
    for edge in template.edges:
        with findings.collect():
            edges += _edges(edge, names, scope, parts, resolver)
    initial = 0
    with findings.collect():
        if template.initial is None:
            fix = "write `start` and the location's name"
            message = f"`{template.name}` has no initial location"
            raise model_error("TA013", message, template.span, fix)
        initial = _location(template.initial, names)
    return nta.Automaton(
        scope.prefix.removesuffix("."), tuple(locations), tuple(edges), initial, template.span
    )


def _place(
    written: automaton_syntax.LocationText, scope: sc.Scope, resolver: Resolver
) -> nta.Location:
    """A location with its invariant, from which rates of clocks are separated."""
    condition: Expression = TRUE
    rates, leaving = list[nta.Rate](), None
    parts = [] if written.invariant is None else _parts(written.invariant, scope, resolver)
    for part, inner in parts:
        match part:
            case syntax.Binary(BinaryOp.EQ, syntax.Rate(target), value):
                if is_price(target, inner):
                    continue
                clock = resolver.clock(target, inner)
                if clock is None:
                    raise model_error("TA004", "this is not a clock", target.span, "declare it")
                rates.append(nta.Rate(clock, _number(value, inner, resolver)))
            case _:
                more = resolver.condition(part, inner)
                condition = binary(BinaryOp.AND, condition, more, part.span)
    if written.leaving is not None:
        one, other = (_number(share, scope, resolver) for share in written.leaving)
        leaving = (one, other)
    guard = split_guard(condition, (written.invariant or written).span)
    return nta.Location(written.name, written.kind, guard, written.span, tuple(rates), leaving)


def _number(written: syntax.Expression, scope: sc.Scope, resolver: Resolver) -> Expression:
    number = resolver.condition(written, scope)
    refuse_clocks(number, written.span)
    return number


def _has_rate(written: syntax.Expression) -> bool:
    match written:
        case syntax.Binary(BinaryOp.AND, left, right):
            return _has_rate(left) or _has_rate(right)
        case syntax.Quantified(BinaryOp.AND, body=body):
            return _has_rate(body)
        case syntax.Binary(BinaryOp.EQ, syntax.Rate(), _):
            return True
        case _:
            return False


def _parts(
    written: syntax.Expression, scope: sc.Scope, resolver: Resolver
) -> Iterator[tuple[syntax.Expression, sc.Scope]]:
    """The conjuncts of an invariant, split as far as needed to separate rates."""
    match written:
        case syntax.Binary(BinaryOp.AND, left, right) if _has_rate(written):
            yield from _parts(left, scope, resolver)
            yield from _parts(right, scope, resolver)
        case syntax.Quantified(BinaryOp.AND, name, kind, body) if _has_rate(body):
            for value in symbols.values_of(resolver.type(kind, scope), kind.span):
                inner = scope.inner({name: sc.ConstantSymbol(value)})
                yield from _parts(body, inner, resolver)
        case _:
            yield written, scope


def _location(name: syntax.Name, names: Mapping[str, int]) -> int:
    if name.name not in names:
        raise unknown("location", name.name, name.span, names)
    return names[name.name]


def _edges(
    written: automaton_syntax.EdgeText,
    names: Mapping[str, int],
    scope: sc.Scope,
    parts: Parts,
    resolver: Resolver,
) -> Iterator[nta.Edge]:
    """One edge for each combination of selected values and each case of a guard with clocks."""
    source, target = _location(written.source, names), _location(written.target, names)
    ranges, selected_names = [], sc.Scope()
    for selection in written.selections:
        symbols.claim(selection.name, selection.span, selected_names)
        ranges.append(symbols.values_of(resolver.type(selection.type, scope), selection.span))
    for count, chosen in enumerate(product(*ranges)):
        if count >= symbols.MAX_VALUES:
            message = f"more than {symbols.MAX_VALUES:,} edges in one"
            raise model_error("TA019", message, written.span)
        selected = {
            selection.name: sc.ConstantSymbol(value)
            for selection, value in zip(written.selections, chosen, strict=True)
        }
        inner = scope.inner(selected) if selected else scope
        guards = [nta.Guard()]
        if written.guard is not None:
            condition = resolver.condition(written.guard, inner)
            guards = [*islice(guards_of(condition), MAX_CASES + 1)]
        if len(guards) > MAX_CASES:
            message = f"a guard of more than {MAX_CASES} cases with clocks"
            raise model_error("TA019", message, written.span, "write several edges")
        sync = None if written.sync is None else _sync(written.sync, inner, resolver)
        if sync is not None:
            channel = parts.channels[sync.slot.first]
            joins = channel.urgent and (sync.sends or not channel.broadcast)
            if joins and any(guard.clocks for guard in guards):
                fix = "move the clock guard to an edge before, or make the channel not urgent"
                raise model_error("TA011", "a clock guard on an urgent channel", written.span, fix)
        updates = updates_of(written.updates, inner, resolver)
        weight = _weight(written, inner, resolver)
        if weight == 0:  # a branch that is never taken
            continue
        parts.are_split |= len(guards) > 1
        for guard in guards:
            yield nta.Edge(
                source, target, guard, sync, updates, weight, written.label,
                _edge_text(written, selected), written.span,
            )  # fmt: skip


def _weight(written: automaton_syntax.EdgeText, scope: sc.Scope, resolver: Resolver) -> float:
    """The share of the runs that take an edge: written on the edge, or from its branches."""
    if written.shares is None:
        return written.weight
    own, *every = (
        w.value if isinstance(w, syntax.Decimal) else resolver.constant(w, scope)
        for w in (written.shares[0], *written.shares[1])
    )
    if min(every) < 0 or max(every) == 0:
        fix = "weights are numbers, one of them above 0"
        raise model_error("TA017", "the branches of this edge have no share", written.span, fix)
    return own / sum(every)


def _edge_text(
    written: automaton_syntax.EdgeText, selected: Mapping[str, sc.ConstantSymbol]
) -> str:
    text = f"{written.source.name} → {written.target.name}"
    if written.sync is not None:
        text += f" on {written.sync.span.text}"
    chosen = [f"{name} = {symbol.value}" for name, symbol in selected.items()]
    return text + (f" with {', '.join(chosen)}" if chosen else "")


def _sync(written: automaton_syntax.SyncText, scope: sc.Scope, resolver: Resolver) -> nta.Sync:
    match resolver.symbol(written.channel, scope):
        case sc.PlacedSymbol(BaseType.CHANNEL, slot) if slot.is_single:
            for index in slot.indices:
                refuse_changes(index, written.span)
            return nta.Sync(slot, written.sends)
        case sc.PlacedSymbol(BaseType.CHANNEL):
            raise model_error("TA004", "an array of channels", written.span, "give an index")
        case _:
            fix = f"declare it: chan {written.channel.span.text}"
            raise model_error("TA004", "this is not a channel", written.span, fix)
