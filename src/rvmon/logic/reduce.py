"""Minimises automata: fewer locations, age regions and classes of letters.

Source: partition refinement after Moore 1956.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import product

from msgspec import Struct

from rvmon.logic.alphabet import LetterDiagram
from rvmon.logic.automaton import PASSED, Automaton, Location, end_clauses, layout_of
from rvmon.logic.residual import Residual

Label = Callable[[Residual], Hashable]
"""Gives the part of a residual that is reported: locations that differ in it are not merged."""

Edge = tuple[int, tuple[int, ...]]
Row = tuple[tuple[Edge | None, ...], int, int]
"""The edge per class of letters (`None`: unreachable), then the time value and the end value."""

Regions = tuple[int, ...]


class _DraftLocation(Struct):
    """A location under minimisation: its residual, clock regions and outgoing edges."""

    residual: Residual
    cuts: tuple[tuple[int, ...], ...]
    rows: dict[Regions, Row]


def reduce(automaton: Automaton, label: Label) -> Automaton:
    """Minimise an automaton; the result decides the same attempts at the same instants.

    Only locations with equal labels are merged, so that explanations stay right.
    """
    draft = _Draft(automaton)
    # Repeat both, as each enables the other: merged targets make rows equal, and joined regions
    # make locations equal.
    while draft.merge(label) or draft.drop_cuts():
        pass
    return draft.tables()


def refined(keys: Sequence[Hashable], moves: Callable[[int, list[int]], Hashable]) -> list[int]:
    """The block of each place in the coarsest partition that respects keys and moves.

    All places of a block have the same key and move to the same blocks. `moves` returns the blocks
    of the successors of a place.

    Source: partition refinement after Moore 1956.
    """
    blocks = _numbered(keys)
    while True:
        finer = _numbered([(block, moves(place, blocks)) for place, block in enumerate(blocks)])
        if max(finer) == max(blocks):
            return blocks
        blocks = finer


def _numbered(keys: Sequence[Hashable]) -> list[int]:
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys]


class _Draft:
    def __init__(self, automaton: Automaton) -> None:
        self.source = automaton
        self.initial = automaton.initial
        edges = [*zip(automaton.targets, automaton.sources, strict=True), None]  # for −1
        width = automaton.classes
        self.drafts: list[_DraftLocation] = []
        for location, base in zip(automaton.locations, automaton.bases, strict=True):
            rows: dict[Regions, Row] = {}
            for row, regions in enumerate(_vectors(location.cuts), base):
                numbers = automaton.edges[row * width : (row + 1) * width]
                values = automaton.time_values[row], automaton.end_values[row]
                rows[regions] = (tuple(map(edges.__getitem__, numbers)), *values)
            self.drafts.append(_DraftLocation(location.residual, location.cuts, rows))

    # Locations.

    def merge(self, label: Label) -> bool:
        """Merge equivalent locations; returns whether there were any."""
        keys = [self._key(index, label) for index in range(len(self.drafts))]
        blocks = refined(keys, self._moves)
        # The first location of each block represents it.
        kept = [index for index, block in enumerate(blocks) if blocks.index(block) == index]
        if len(kept) == len(self.drafts):
            return False
        renamed = {blocks[index]: new for new, index in enumerate(kept)}
        self.initial = renamed[blocks[self.initial]]
        self.drafts = [self.drafts[index] for index in kept]
        for draft in self.drafts:
            for regions, (edges, time_value, end_value) in draft.rows.items():
                moved = tuple(edge and (renamed[blocks[edge[0]]], edge[1]) for edge in edges)
                draft.rows[regions] = (moved, time_value, end_value)
        return True

    def _key(self, index: int, label: Label) -> Hashable:
        """The initial key of partition refinement."""
        # These stay alone: the core knows FAILED and PASSED by number, and starts attempts in the
        # initial location.
        if index <= PASSED or index == self.initial:
            return index
        draft = self.drafts[index]
        values = tuple(row[1:] for row in draft.rows.values())
        return draft.cuts, values, end_clauses(draft.residual), label(draft.residual)

    def _moves(self, index: int, blocks: list[int]) -> Hashable:
        """The successors of a location, up to the current partition."""
        return tuple(
            tuple(edge and (blocks[edge[0]], edge[1]) for edge in edges)
            for edges, _, _ in self.drafts[index].rows.values()
        )

    # Regions.

    def drop_cuts(self) -> bool:
        """Merge neighbouring regions with equal rows; returns whether there were any."""
        found = False
        for draft in self.drafts:
            for clock in range(len(draft.cuts)):
                cut = 0
                while cut < len(draft.cuts[clock]):
                    joined = _rows_without(draft, clock, cut)
                    if joined is None:
                        cut += 1
                    else:
                        draft.cuts = _without(draft.cuts, clock, cut)
                        draft.rows = joined
                        found = True
        return found

    # Tables.

    def tables(self) -> Automaton:
        """The minimised automaton, with letter classes merged that no row distinguishes."""
        rows = [draft.rows[regions] for draft in self.drafts for regions in _vectors(draft.cuts)]
        columns: dict[tuple[Edge | None, ...], int] = {}
        new_class = [
            columns.setdefault(column, len(columns))
            for column in zip(*(edges for edges, _, _ in rows), strict=True)
        ]
        number: dict[Edge | None, int] = {}
        edges = array("i")
        for place_row in zip(*columns, strict=True):
            for edge in place_row:
                edges.append(-1 if edge is None else number.setdefault(edge, len(number)))
        locations = tuple(Location(draft.residual, draft.cuts) for draft in self.drafts)
        bases, strides, _ = layout_of(locations)
        source, class_of = self.source, self.source.class_of
        return Automaton(
            source.alphabet, locations, self.initial, len(columns),
            class_of.renamed(new_class) if isinstance(class_of, LetterDiagram)
            else array("H", map(new_class.__getitem__, class_of)), bases, strides, edges,
            tuple(edge[0] for edge in number if edge is not None),
            tuple(edge[1] for edge in number if edge is not None),
            bytes(time_value for _, time_value, _ in rows),
            bytes(end_value for _, _, end_value in rows),
        )  # fmt: skip


def _vectors(cuts: tuple[tuple[int, ...], ...]) -> Iterator[Regions]:
    return product(*(range(len(own) + 1) for own in cuts))


def _without(
    cuts: tuple[tuple[int, ...], ...], clock: int, cut: int
) -> tuple[tuple[int, ...], ...]:
    own = cuts[clock]
    return (*cuts[:clock], own[:cut] + own[cut + 1 :], *cuts[clock + 1 :])


def _rows_without(draft: _DraftLocation, clock: int, cut: int) -> dict[Regions, Row] | None:
    """The rows without a cut; `None` if the regions on its two sides differ."""
    made: dict[Regions, Row] = {}
    for regions, row in draft.rows.items():
        region = regions[clock]
        key = (*regions[:clock], region - (region > cut), *regions[clock + 1 :])
        known = made.get(key)
        both = row if known is None else _merged_row(known, row)
        if both is None:
            return None
        made[key] = both
    return made


def _merged_row(row: Row, other: Row) -> Row | None:
    """A row that replaces both; `None` if they differ. An unreachable entry matches any edge."""
    if row == other:
        return row
    if row[1:] != other[1:]:
        return None
    edges = []
    for mine, its in zip(row[0], other[0], strict=True):
        if mine != its and None not in (mine, its):
            return None
        # No run takes an unreachable entry, so any edge will do, which lets more regions merge.
        edges.append(its if mine is None else mine)
    return (tuple(edges), *row[1:])
