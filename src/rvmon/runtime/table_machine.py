"""The tables of an automaton in the layout that monitors step through."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from typing import Any

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.letter_classes import LetterClasses, LetterDiagram
from rvmon.formula.residual import Residual
from rvmon.runtime.table import Table

Edge = tuple[int, tuple[int, ...]]
"""Target, and for each of its clocks the old clock it is, or −1 for one started now."""


class TableMachine(Table):
    """Steps an automaton through its tables, and knows what is owed."""

    def __init__(self, automaton: Automaton) -> None:
        super().__init__(*_layout(automaton, automaton.class_of))
        self.automaton = automaton

    def residual(self, location: int) -> Residual:
        """See `Machine`."""
        return self.automaton.locations[location].residual


@dataclass(frozen=True, slots=True)
class TableData:
    """The arguments of `rvmon.runtime.table.Table`."""

    initial: int
    cuts: tuple[tuple[tuple[int, ...], ...], ...]
    bases: tuple[int, ...]
    strides: tuple[tuple[int, ...], ...]
    class_of: tuple[int, ...]
    rows: tuple[tuple[Edge | None, ...], ...]
    time_values: tuple[int, ...]


def tables_of(automaton: Automaton) -> TableData:
    """Lay an automaton out; the classes of its letters have to stand in a table."""
    return TableData(*_layout(automaton, tuple(_table(automaton.class_of))))


def _layout(automaton: Automaton, class_of: Any) -> tuple[Any, ...]:
    edges = [
        None if number < 0 else (automaton.targets[number], automaton.sources[number])
        for number in automaton.edges
    ]
    width = automaton.classes
    return (
        automaton.initial,
        tuple(location.cuts for location in automaton.locations),
        automaton.bases,
        automaton.strides,
        class_of,
        tuple(tuple(edges[row : row + width]) for row in range(0, len(edges), width)),
        tuple(automaton.time_values),
    )


def _table(class_of: LetterClasses) -> array[int]:
    if isinstance(class_of, LetterDiagram):
        raise TypeError("too many letters for a table: the plan should have refused them")
    return class_of
