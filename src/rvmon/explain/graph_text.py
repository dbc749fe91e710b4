"""An automaton for the terminal, and as DOT."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from rvmon.diagnostics.shown import shown
from rvmon.explain.graph import Edge, Graph, Place

WIDTH = 80
ENDS = {"P": "✓ P", "F": "✗ F"}


def graph_lines(graph: Graph) -> list[str]:
    """Each place with what is owed there, and below it the steps that lead on."""
    lines: list[str] = []
    for place in graph.places:
        edges = [edge for edge in graph.edges if edge.source == place.name]
        if edges:
            lines += [*_heading(place), *_steps(edges)]
    return lines


def _heading(place: Place) -> list[str]:
    if place.name == "start":
        return ["  start, at the trigger"]
    text = f"owed: {place.owed}"
    return textwrap.wrap(text, WIDTH, initial_indent=f"  {place.name}  ", subsequent_indent=" " * 6)


def _steps(edges: list[Edge]) -> Iterator[str]:
    for index, edge in enumerate(edges):
        last = index == len(edges) - 1
        target = ENDS.get(edge.target, edge.target)
        text = f"{label_of(edge)} ─▶ {target}" + (f"   ({edge.sets})" if edge.sets else "")
        yield from textwrap.wrap(
            text,
            WIDTH,
            initial_indent=f"     {'└' if last else '├'}─ ",
            subsequent_indent=f"     {' ' if last else '│'}     ",
        )


def label_of(edge: Edge) -> str:
    """The condition of an edge in one line."""
    return ", ".join(filter(None, (edge.when, edge.condition))) or "anything"


def graph_dot(graph: Graph, title: str) -> str:
    """The automaton as DOT, for Graphviz."""
    lines = [f"digraph {quoted(title)} {{", "  rankdir=LR;", '  node [fontname="sans-serif"];']
    for place in graph.places:
        shape = "doublecircle" if place.name in ENDS else "box"
        text = place.name if place.name in ENDS else f"{place.name}\n{place.owed}"
        lines.append(f"  {quoted(place.name)} [shape={shape}, label={quoted(text)}];")
    for edge in graph.edges:
        text = "\n".join(filter(None, (label_of(edge), edge.sets)))
        lines.append(f"  {quoted(edge.source)} -> {quoted(edge.target)} [label={quoted(text)}];")
    return "\n".join([*lines, "}"]) + "\n"


def quoted(text: str) -> str:
    r"""A string of DOT or HOA.

    >>> print(quoted('say "\\x1b"'))
    "say \"\\x1b\""
    """
    plain = shown(text).replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{plain}"'
