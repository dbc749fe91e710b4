"""Networks of timed automata drawn by Graphviz."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.analysis.graph import quoted
from rvmon.export.functions import updates_text
from rvmon.export.names import Names
from rvmon.export.uppaal import condition_text, sync_text
from rvmon.timed.model.network import Automaton, Network
from rvmon.timed.model.operators import LocationKind

_MARKS = {LocationKind.NORMAL: "", LocationKind.URGENT: "U ", LocationKind.COMMITTED: "C "}


def network_dot(network: Network) -> str:
    """One cluster for each automaton; urgent locations are marked U, committed ones C."""
    names = Names(network)
    lines = ["digraph network {", "  rankdir=LR;", "  node [shape=box, style=rounded];"]
    for index, automaton in enumerate(network.automata):
        lines += _cluster(names, index, automaton)
    return "\n".join([*lines, "}", ""])


def _cluster(names: Names, index: int, automaton: Automaton) -> Iterator[str]:
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
