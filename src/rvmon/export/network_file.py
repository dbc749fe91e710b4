"""Networks written to files: UPPAAL's XML, and drawings."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

from rvmon.errors import RvmonError
from rvmon.explain.graph import quoted
from rvmon.export.functions import updates_text
from rvmon.export.names import Names
from rvmon.export.uppaal import condition_text, sync_text, uppaal_xml
from rvmon.timed.model.network import Automaton, Network
from rvmon.timed.model.operators import LocationKind
from rvmon.writing import write_whole

PATIENCE_S = 120
"""Seconds that a drawing may take."""


def write_network(network: Network, path: str | Path) -> None:
    """Write a network in the form that the file's name ends with: `.xml`, `.dot` or `.svg`.

    Raises:
        RvmonError: the name ends otherwise, the file cannot be written, or there is no Graphviz to
            draw with.
    """
    match Path(path).suffix.lower():
        case ".xml":
            text = uppaal_xml(network)
        case ".dot":
            text = network_dot(network)
        case ".svg":
            text = svg_of(network_dot(network))
        case _:
            raise RvmonError(f"{path}: end the name in .xml (for UPPAAL), .dot or .svg")
    try:
        write_whole(path, text)
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror or error}") from None


def svg_of(dot: str) -> str:
    """A drawing in DOT, laid out by Graphviz.

    Raises:
        RvmonError: its program `dot` is not installed, or fails.
    """
    program = shutil.which("dot")
    if program is None:
        fix = "install Graphviz (such as: apt-get install graphviz), or write a .dot file"
        raise RvmonError(f"there is no program `dot` to draw with: {fix}")
    try:
        drawn = subprocess.run(  # noqa: S603 - the drawing is its input, never an argument
            [program, "-Tsvg"],
            input=dot.encode("utf-8"),
            capture_output=True,
            check=True,
            timeout=PATIENCE_S,
        )
    except subprocess.TimeoutExpired:
        fix = "write a .dot file and lay it out by another program"
        raise RvmonError(f"drawing took more than {PATIENCE_S} s: {fix}") from None
    except subprocess.CalledProcessError as error:
        reason = error.stderr.decode("utf-8", errors="replace").strip()
        raise RvmonError(f"`dot` cannot draw this: {reason}") from None
    return drawn.stdout.decode("utf-8")


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
