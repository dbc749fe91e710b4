"""Turns a written model into a network, pass by pass; resolves queries on the result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from msgspec import structs

from rvmon.diagnostics import Severity, Source, Span
from rvmon.models import finding, model_error, skipped_query
from rvmon.models import network as nta
from rvmon.models.language import automaton_syntax, syntax
from rvmon.models.language.automaton_syntax import Document, SignalText
from rvmon.models.language.declare import Findings, Parts, declare
from rvmon.models.language.diagonals import Diagonals, without_lower_bounds
from rvmon.models.language.functions import Functions
from rvmon.models.language.instantiate import automaton_of, location_names, processes_of
from rvmon.models.language.operations import assuming
from rvmon.models.language.parse import parse_query
from rvmon.models.language.resolve import Resolver
from rvmon.models.language.symbols import INT32, claim
from rvmon.models.network import scope as sc
from rvmon.models.network.expressions import FALSE, TRUE, BaseType, Expression
from rvmon.models.network.guards import is_discrete, is_plain
from rvmon.texts import did_you_mean

MAX_EDGES = 100_000
"""Limit for the edges of a network after templates and selections are unrolled."""

MOST_RUNS = 10_000_000  # limit for the runs that a query may simulate


def elaborate(document: Document, constants: Mapping[str, int] | None = None) -> nta.Network:
    """Make the network that a model describes.

    Raises:
        ModelError: with everything that is wrong with the model.
    """
    findings, parts = Findings(), Parts()
    document = _with_constants(document, constants or {}, findings)
    functions = Functions(parts.variables)
    diagonals = Diagonals(parts.clocks, parts.variables)
    resolver = Resolver(functions, open_ints=document.open_ints, diagonals=diagonals)
    top = sc.Scope(_known() if document.open_ints else None)
    declare(document.declarations, top, parts, resolver, findings)
    automata, ranks, edges = list[nta.Automaton](), list[int](), 0
    symbols: dict[sc.AutomatonKey, sc.AutomatonSymbol] = {}
    for process in processes_of(document, top, resolver, findings):
        declare(process.template.declarations, process.scope, parts, resolver, findings)
        locations = location_names(process.template, findings)
        key = (process.family, process.arguments)
        symbols[key] = sc.AutomatonSymbol(len(automata), locations, process.scope)
        automata.append(automaton_of(process, locations, parts, resolver, findings))
        ranks.append(process.priority)
        edges += len(automata[-1].edges)
        if edges > MAX_EDGES:
            fix = "narrow the types of parameters and selections"
            findings.add(finding("TA019", f"more than {MAX_EDGES:,} edges", None, fix))
        if findings.has("TA019"):
            break
    if not automata and not findings.diagnostics:
        findings.add(finding("TA021", "there is no automaton", None, "add `automaton name { … }`"))
    names = sc.Names(top, symbols, functions)
    # A network with missing automata is an error itself; its queries have no meaning.
    complete = bool(symbols) and not findings.has("TA019")
    queries = _queries(
        document.queries if complete else (), names, findings, diagonals, lenient=document.open_ints
    )
    signals = _signals(document.signals if complete else (), names, findings)
    _check_channels(parts, automata, findings)
    findings.raise_errors()
    with findings.collect():
        automata = list(diagonals.kept_up(without_lower_bounds(automata, parts.channels)))
    findings.raise_errors()
    if sum(len(automaton.edges) for automaton in automata) > MAX_EDGES:
        fix = "compare fewer differences of clocks"
        raise model_error("TA019", f"more than {MAX_EDGES:,} edges", None, fix)
    return nta.Network(
        document.name, document.title, document.unit,
        tuple(parts.clocks), tuple(parts.variables), tuple(parts.channels), tuple(automata),
        queries, signals, tuple(findings.diagnostics.values()), names, _priorities(parts, ranks),
        has_split_edges=bool(diagonals.places) or parts.are_split, fraction=resolver.fraction,
    )  # fmt: skip


def _known() -> sc.Scope:
    """The names that UPPAAL predeclares."""
    scope = sc.Scope()
    for bits in (8, 16, 32):
        high = (1 << bits - 1) - 1
        ranges = {f"int{bits}": (-high - 1, high), f"uint{bits}": (0, 2 * high + 1)}
        for name, (low, high) in ranges.items():
            if high <= INT32[1]:
                scope.symbols[f"{name}_t"] = sc.TypeSymbol(sc.ResolvedType(BaseType.INT, low, high))
                scope.symbols[f"{name.upper()}_MIN"] = sc.ConstantSymbol(low)
                scope.symbols[f"{name.upper()}_MAX"] = sc.ConstantSymbol(high)
    return scope


def _priorities(parts: Parts, automata: Sequence[int]) -> nta.Priorities | None:
    levels, above = parts.levels, 1 + max(automata)
    if len({*levels.values()}) <= 1 and above == 1:
        return None
    # Multiples of `above` outweigh the ranks of automata, so that channels decide first.
    default = above * levels.get(None, 0)
    channels = (above * levels.get(c, levels.get(None, 0)) for c in range(len(parts.channels)))
    return nta.Priorities(tuple(automata), default, tuple(channels))


def _with_constants(
    document: Document, constants: Mapping[str, int], findings: Findings
) -> Document:
    known = {
        item.name
        for item in document.declarations
        if isinstance(item, syntax.Declaration) and item.type.const and not item.sizes
    }
    for name in constants.keys() - known:
        fix = did_you_mean(name, sorted(known))
        findings.add(finding("TA002", f"no constant `{name}` to set", None, fix))
    changed: list[syntax.Declared] = []
    for item in document.declarations:
        if isinstance(item, syntax.Declaration) and item.name in constants.keys() & known:
            value = syntax.Number(constants[item.name], item.span)
            changed.append(structs.replace(item, initial=value))
        else:
            changed.append(item)
    return structs.replace(document, declarations=tuple(changed))


def query_on(network: nta.Network, text: str) -> tuple[nta.Network, nta.Query]:
    """Resolve a query on a network, which is extended if the query compares differences of clocks.

    Raises:
        ModelError: the text is no query, uses unknown names, or compares a difference of clocks
            that edges cannot keep up to date.

    >>> from rvmon.models.language.load import loads_network
    >>> plain = loads_network("clock x, y automaton a { location l start l edge l -> l do x = 0 }")
    >>> network, query = query_on(plain, "E<> y - x > 3")
    >>> network.variables[-1].name
    'y - x <= 3'
    """
    findings, diagonals = Findings(), Diagonals(network.clocks, [*network.variables])
    queries = _queries([parse_query(text)], network.names, findings, diagonals)
    findings.raise_errors()
    if diagonals.places:
        with findings.collect():
            network = replace(
                network,
                variables=tuple(diagonals.variables),
                automata=tuple(diagonals.kept_up(network.automata)),
                has_split_edges=True,
            )
        findings.raise_errors()
    return network, queries[0]


def _queries(
    written: Iterable[automaton_syntax.QueryText],
    names: sc.Names,
    findings: Findings,
    diagonals: Diagonals | None = None,
    *,
    lenient: bool = False,
) -> tuple[nta.Query, ...]:
    """Resolve queries. If `lenient`, a query without a meaning is skipped with a warning."""
    resolver, top = Resolver(names.functions, names.automata, diagonals=diagonals), names.top
    queries, ids = [], sc.Scope()
    for query in written:
        own, resolver.fraction = Findings(), None
        with own.collect() if lenient else findings.collect():
            if query.id:
                claim(query.id, query.span, ids)
            meaning = _formula(query.formula, resolver, top)
            queries.append(nta.Query(query.id, query.remark, query.text, meaning, query.span))
        for found in own.diagnostics.values():
            findings.add(skipped_query(query.text, found))
    return tuple(queries)


def signal_on(network: nta.Network, name: str, text: str) -> nta.Signal:
    """Resolve an expression as a signal of a network, for specifications."""
    findings = Findings()
    written = SignalText(name, parse_query(text).formula, Span(Source(name, text), 0, len(text)))
    signals = _signals([written], network.names, findings)
    findings.raise_errors()
    return signals[0]


def _signals(
    written: Iterable[SignalText], names: sc.Names, findings: Findings
) -> tuple[nta.Signal, ...]:
    resolver = Resolver(names.functions, names.automata)
    signals, taken = list[nta.Signal](), sc.Scope()
    for signal in written:
        with findings.collect():
            claim(signal.name, signal.span, taken)
            value = resolver.condition(signal.value, names.top)
            if not is_discrete(value):
                fix = "use locations and variables only"
                raise model_error("TA009", "a signal with clocks or runs", signal.span, fix)
            signals.append(nta.Signal(signal.name, value))
    return tuple(signals)


def _formula(written: syntax.Expression, resolver: Resolver, top: sc.Scope) -> nta.QueryFormula:
    match written:
        case syntax.Chance(op, body, within, runs, sign, level):
            holds = resolver.expression(body, top)
            horizon = resolver.limit(within, top) or 0
            return nta.Chance(op, holds, horizon, _runs(runs, resolver, top), sign, level)
        case syntax.Mean(largest, value, within, runs):
            horizon = resolver.limit(within, top) or 0
            number = _number(value, resolver, top)
            return nta.Mean(largest, number, horizon, _runs(runs, resolver, top))
        case syntax.Simulation(terms, within, runs):
            horizon = resolver.limit(within, top) or 0
            shown = tuple(_term(term, resolver, top) for term in terms)
            return nta.Simulation(shown, horizon, _runs(runs, resolver, top, least=1) or 1)
        case syntax.Extremes(ends, where, terms):
            condition = TRUE if where is None else resolver.condition(where, top)
            if not is_plain(condition):
                fix = "write a condition on the state: sup{p}: e"
                raise model_error("TA020", "a condition on runs", written.span, fix)
            shown = tuple(_term(term, resolver, top) for term in terms)
            extremes = nta.Extremes(ends, condition, shown)
            nta.refuse_fraction(resolver.fraction)
            return extremes
        case _:
            decided = _decided(written, resolver, top)
            nta.refuse_fraction(resolver.fraction)
            return decided


def _number(written: syntax.Expression, resolver: Resolver, top: sc.Scope) -> Expression:
    number = resolver.condition(written, top)
    if not is_discrete(number):
        fix = "use locations and variables only"
        raise model_error("TA020", "the value of a clock or of runs", written.span, fix)
    return number


def _term(written: syntax.Expression, resolver: Resolver, top: sc.Scope) -> nta.Term:
    clock, text = resolver.clock(written, top), written.span.text
    if clock is not None:
        return nta.Term(text, FALSE, clock)
    return nta.Term(text, _number(written, resolver, top))


def _runs(
    written: syntax.Expression | None, resolver: Resolver, top: sc.Scope, least: int = 2
) -> int | None:
    if written is None:
        return None
    runs = resolver.constant(written, top)
    if not least <= runs <= MOST_RUNS:
        fix = f"simulate from {least} to {MOST_RUNS:,} runs"
        raise model_error("TA007", f"{runs} runs", written.span, fix)
    return runs


def _decided(
    written: syntax.Expression, resolver: Resolver, top: sc.Scope
) -> Expression | nta.LeadsToFormula:
    if isinstance(written, syntax.Assuming):
        query = _decided(written.query, resolver, top)
        return assuming(query, resolver.expression(written.premise, top), written.span)
    if not isinstance(written, syntax.LeadsTo):
        return resolver.condition(written, top)
    left, right = resolver.condition(written.left, top), resolver.condition(written.right, top)
    return nta.LeadsToFormula(left, right, resolver.limit(written.bound, top))


def _check_channels(parts: Parts, automata: Iterable[nta.Automaton], findings: Findings) -> None:
    senders, receivers = set[int](), set[int]()
    for edge in (edge for automaton in automata for edge in automaton.edges):
        if edge.sync is not None:
            slot = edge.sync.slot
            used = range(slot.first, slot.first + slot.size)
            (senders if edge.sync.sends else receivers).update(used)
    for index, (channel, span) in enumerate(zip(parts.channels, parts.channel_spans, strict=True)):
        match index in senders, index in receivers:
            case False, False:
                problem, fix = "is never used", "remove it, or use it on an edge"
            case True, False if not channel.broadcast:
                problem, fix = "is never received", f"add an edge with {channel.name}?"
            case False, True:
                problem, fix = "is never sent", f"add an edge with {channel.name}!"
            case _:
                continue
        message = f"the channel `{channel.name}` {problem}: edges with it are never taken"
        findings.add(finding("TA010", message, span, fix, severity=Severity.WARNING))


def chosen_queries(
    network: nta.Network, texts: Sequence[str] | None
) -> list[tuple[nta.Network, nta.Query]]:
    """The queries of a model, or those requested by id or text, each with its network.

    Raises:
        ModelError: the model has none, or a requested text is neither an id nor a query.
    """
    if texts is None:
        if not network.queries:
            fix = "give one with --query, or write `query: …` into the model"
            raise model_error("TA020", "the model has no query", None, fix)
        return [(network, query) for query in network.queries]
    by_id = {query.id: query for query in network.queries if query.id}
    for text in texts:
        parts = [part.strip() for part in text.split(",")]
        if text.isidentifier() and text not in by_id and by_id:
            own = ", ".join(by_id)
            raise model_error("TA002", f"the model has no query `{text}`", None, f"it has {own}")
        if len(parts) > 1 and all(part in by_id for part in parts):
            several = " ".join(f"--query {part}" for part in parts)
            raise model_error("TA020", f"`{text}` is not a query", None, f"write {several}")
    return [(network, by_id[text]) if text in by_id else query_on(network, text) for text in texts]
