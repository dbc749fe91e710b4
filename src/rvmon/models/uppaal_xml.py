"""A network as UPPAAL's XML, which `rvmon.models.language.load` reads back, and as a DOT drawing.

Each automaton becomes a template without parameters, and local names become global. Comments that
our reader understands hold what UPPAAL lacks: the unit of time, weights and labels of edges, ids of
queries. UPPAAL has no queries with a bound on the path operator or with nested path operators, so
their text is kept as a comment.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from xml.sax.saxutils import escape

from rvmon.models import network as nta
from rvmon.models.network.expressions import (
    OUTERMOST,
    TRUE,
    LocationKind,
    PathFormula,
    Slot,
    Variable,
)
from rvmon.models.network.fractions import number_of
from rvmon.models.network.guards import has_paths
from rvmon.models.uppaal_names import Names, Thing, function_lines, type_text, updates_text
from rvmon.texts import escaped, escaped_line, quoted
from rvmon.trace.time import TICKS_PER_UNIT

_HEAD = """<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.1//EN' \
'http://www.it.uu.se/research/group/darts/uppaal/flat-1_2.dtd'>
<nta>
"""
_GRID = (200, 150)  # distance between locations in the drawing, across and down


def uppaal_xml(network: nta.Network) -> str:
    """The text of the XML file for a network."""
    names = Names(network)
    templates = [
        line
        for index, automaton in enumerate(network.automata)
        for line in _template(names, index, automaton)
    ]
    lines = [f"  <system>system {_text(_system(names))};</system>", "  <queries>"]
    for query in network.queries:
        lines += _query(names, query)
    lines += ["  </queries>", "</nta>", ""]
    # The texts above collect the functions in use, so declarations are written last.
    declared = _text(_declarations(network, names))
    head = f"  <declaration>{declared}</declaration>"
    return _HEAD + "\n".join([head, *templates, *lines])


def left_out(network: nta.Network) -> list[nta.Query]:
    """The queries that UPPAAL does not have, of which only the text is kept."""
    names = Names(network)
    return [query for query in network.queries if not _formula(names, query.formula)]


def _system(names: Names) -> str:
    """All automata, ordered by priority."""
    priorities = names.network.priorities
    ranks = (0,) * len(names.automata) if priorities is None else priorities.automata
    text = names.automata[0]
    for (before, rank), name in zip(pairwise(ranks), names.automata[1:], strict=True):
        text += (" < " if rank > before else ", ") + name
    return text


def _channel_priorities(names: Names) -> Iterator[str]:
    priorities = names.network.priorities
    if priorities is None or {*priorities.channels} <= {priorities.internal}:
        return
    levels = {priorities.internal: ["default"]}
    for index, rank in enumerate(priorities.channels):
        if rank != priorities.internal:
            levels.setdefault(rank, []).append(names.slot(Slot(index), names.channels))
    yield f"chan priority {' < '.join(', '.join(levels[rank]) for rank in sorted(levels))};"


def _declarations(network: nta.Network, names: Names) -> str:
    lines = [escaped_line(f'// network {network.name} "{network.title}"')]
    if network.unit is not None:
        unit = max((u for u, t in TICKS_PER_UNIT.items() if network.unit % t == 0),
                   key=lambda name: TICKS_PER_UNIT[name])  # fmt: skip
        lines.append(f"// unit {network.unit // TICKS_PER_UNIT[unit]} {unit}")
    lines += [f"clock {thing.declarator};" for thing in names.clocks]
    for thing in names.channels:
        channel = network.channels[thing.first]
        kind = ("urgent " if channel.urgent else "") + ("broadcast " if channel.broadcast else "")
        lines.append(f"{kind}chan {thing.declarator};")
    lines += _channel_priorities(names)
    for thing in names.variables:
        members = network.variables[thing.first : thing.first + thing.length]
        lines.append(f"{type_text(members[0])} {thing.declarator} = {_initial(thing, members)};")
    return "\n".join([*lines, *function_lines(names), ""])


def _initial(thing: Thing, members: tuple[Variable, ...]) -> str:
    values = [str(number_of(v.initial) if v.is_real else v.initial) for v in members]
    for extent in reversed(thing.extents):
        size = len(extent)
        values = [
            "{" + ", ".join(values[start : start + size]) + "}"
            for start in range(0, len(values), size)
        ]
    return values[0]


def _template(names: Names, index: int, automaton: nta.Automaton) -> Iterator[str]:
    yield "  <template>"
    yield f"    <name>{names.automata[index]}</name>"
    columns = max(1, round(len(automaton.locations) ** 0.5))
    for place, location in enumerate(automaton.locations):
        row, column = divmod(place, columns)
        x, y = column * _GRID[0], row * _GRID[1]
        yield f'    <location id="id{index}_{place}" x="{x}" y="{y}">'
        yield f'      <name x="{x - 10}" y="{y - 30}">{names.location(index, place)}</name>'
        rates = [f"{names.clock(r.clock)}' == {names.expression(r.value)}" for r in location.rates]
        bounds = [condition_text(names, location.invariant)]
        if condition := " && ".join([*filter(None, bounds), *rates]):
            yield f'      <label kind="invariant" x="{x}" y="{y + 15}">{_text(condition)}</label>'
        if location.leaving is not None:
            share = " : ".join(map(names.expression, location.leaving))
            yield f'      <label kind="exponentialrate">{share}</label>'
        if location.kind is not LocationKind.NORMAL:
            yield f"      <{location.kind}/>"
        yield "    </location>"
    yield f'    <init ref="id{index}_{automaton.initial}"/>'
    for edge in automaton.edges:
        yield from _edge(names, index, edge)
    yield "  </template>"


def _edge(names: Names, index: int, edge: nta.Edge) -> Iterator[str]:
    yield "    <transition>"
    yield f'      <source ref="id{index}_{edge.source}"/>'
    yield f'      <target ref="id{index}_{edge.target}"/>'
    labels = {
        "guard": condition_text(names, edge.guard),
        "synchronisation": sync_text(names, edge),
        "assignment": updates_text(names, edge.updates),
    }
    comments = [f"weight {edge.weight}"] if edge.weight != 1 else []
    labels["comments"] = "\n".join([*comments, *([f"as {edge.label}"] if edge.label else [])])
    for kind, text in labels.items():
        if text:
            yield f'      <label kind="{kind}">{_text(text)}</label>'
    yield "    </transition>"


def condition_text(names: Names, guard: nta.Guard) -> str:
    """A guard or invariant; empty if it always holds."""
    parts = [names.expression(compare) for compare in guard.clocks]
    if guard != nta.Guard(clocks=guard.clocks):
        parts.append(names.expression(guard.data))
    return " && ".join(parts)


def sync_text(names: Names, edge: nta.Edge) -> str:
    """The synchronisation of an edge; empty if it has none."""
    if edge.sync is None:
        return ""
    channel = names.slot(edge.sync.slot, names.channels)
    return channel + ("!" if edge.sync.sends else "?")


def _query(names: Names, query: nta.Query) -> Iterator[str]:
    formula, comment = _formula(names, query.formula), query.remark
    if not formula:
        comment = f"not a query of UPPAAL: {query.text} {comment}".strip()
    if query.id:
        comment = f"query {query.id}\n{comment}".strip()
    yield "    <query>"
    yield f"      <formula>{_text(formula)}</formula>"
    yield f"      <comment>{_text(comment)}</comment>"
    yield "    </query>"


def _formula(names: Names, formula: nta.QueryFormula) -> str:
    """The text of a formula; empty if UPPAAL cannot express it."""
    match formula:
        case nta.LeadsToFormula(left, right, None) if not (has_paths(left) or has_paths(right)):
            return f"{names.expression(left)} --> {names.expression(right)}"
        case PathFormula(op, body, None, left) if (
            left == TRUE and op in OUTERMOST and not has_paths(body)
        ):
            return names.expression(formula)
        case nta.Extremes(ends, where, terms):
            word = "bounds" if len(ends) > 1 else "sup" if ends[0] else "inf"
            listed = ", ".join(
                names.expression(term.value) if term.clock is None else names.clock(term.clock)
                for term in terms
            )
            return f"{word}{{{names.expression(where)}}}: {listed}"
        case _:
            return ""


def _text(text: str) -> str:
    """The text, escaped for XML."""
    return escape(escaped(text))


_MARKS = {LocationKind.NORMAL: "", LocationKind.URGENT: "U ", LocationKind.COMMITTED: "C "}


def network_dot(network: nta.Network) -> str:
    """A DOT drawing: a cluster for each automaton; U marks urgent locations, C committed ones."""
    names = Names(network)
    lines = ["digraph network {", "  rankdir=LR;", "  node [shape=box, style=rounded];"]
    for index, automaton in enumerate(network.automata):
        lines += _cluster(names, index, automaton)
    return "\n".join([*lines, "}", ""])


def _cluster(names: Names, index: int, automaton: nta.Automaton) -> Iterator[str]:
    yield f"  subgraph cluster_{index} {{"
    yield f"    label={quoted(automaton.name)};"
    for place, location in enumerate(automaton.locations):
        invariant = condition_text(names, location.invariant)
        text = _MARKS[location.kind] + location.name + (f"\n{invariant}" if invariant else "")
        bold = ", penwidth=2" if place == automaton.initial else ""
        yield f"    l{index}_{place} [label={quoted(text)}{bold}];"
    for edge in automaton.edges:
        parts = [
            condition_text(names, edge.guard),
            sync_text(names, edge),
            updates_text(names, edge.updates),
            f"weight {edge.weight}" if edge.weight != 1 else "",
        ]
        text = "\n".join(filter(None, parts))
        yield f"    l{index}_{edge.source} -> l{index}_{edge.target} [label={quoted(text)}];"
    yield "  }"
