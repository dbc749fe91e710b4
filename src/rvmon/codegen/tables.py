"""The tables of an automaton in the layout that generated code steps through."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.automaton import Automaton
from rvmon.formula.core import Release
from rvmon.formula.residual import NO_CLOCK, Residual

Edge = tuple[int, tuple[int, ...]]
"""Target, and for each of its clocks the old clock it is, or −1 for one started now."""

EndClause = tuple[tuple[int, int, bool], ...]
"""Clock (−1: none), least age, and whether the age is that at the end or as far as time came."""


@dataclass(frozen=True, slots=True)
class TableData:
    """See `rvmon.codegen.runtime.table.Table`, whose arguments these are, in its order."""

    initial: int
    cuts: tuple[tuple[tuple[int, ...], ...], ...]
    bases: tuple[int, ...]
    strides: tuple[tuple[int, ...], ...]
    class_of: tuple[int, ...]
    rows: tuple[tuple[Edge | None, ...], ...]
    time_values: tuple[int, ...]
    end_clauses: tuple[tuple[EndClause, ...], ...]


def tables_of(automaton: Automaton) -> TableData:
    """Lay an automaton out."""
    edges = [
        None if number < 0 else (automaton.targets[number], automaton.sources[number])
        for number in automaton.edges
    ]
    width = automaton.classes
    return TableData(
        automaton.initial,
        tuple(location.cuts for location in automaton.locations),
        automaton.bases,
        automaton.strides,
        tuple(automaton.class_of),
        tuple(tuple(edges[row : row + width]) for row in range(0, len(edges), width)),
        tuple(automaton.time_values),
        tuple(_end_clauses(location.residual) for location in automaton.locations),
    )


def _end_clauses(residual: Residual) -> tuple[EndClause, ...]:
    """When the end of a trace makes a residual true, whatever else is pending (SEMANTICS 3).

    A bounded `R` counts if its window is over as far as time has come, an unbounded one if its
    window has opened at the end; nothing else counts.
    """
    made = []
    for clause in residual:
        releases = [(node, clock) for node, clock in clause if isinstance(node, Release)]
        if len(releases) == len(clause):
            tests: list[tuple[int, int, bool]] = []
            for node, clock in releases:
                if node.high is not None:
                    tests.append((clock, node.high + 1, False))
                elif clock != NO_CLOCK and node.low:
                    tests.append((clock, node.low, True))
            made.append(tuple(sorted(tests)))
    return tuple(sorted(made))
