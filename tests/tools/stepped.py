"""Steps automata through their tables, for tests of what is built."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import FAILED, PASSED, Token
from rvmon.formula.residual import Residual
from rvmon.formula.state import UNKNOWN
from rvmon.trace.time import NEVER


class Table:
    """A deterministic timed automaton.

    A token is a location with, for each clock, the instant at which it was started. A row is a
    location with a region for each clock.

    Args:
        initial: the location before the position of the trigger.
        cuts: per location and clock, the ages at which it enters another region.
        bases: per location, its first row.
        strides: per location and clock, what a region adds to the row.
        class_of: the class of each letter.
        rows: per row and class the edge: its target, and for each clock of that the old clock it
            is, or `NOW`; `None` where no run comes.
        time_values: per row, the truth if time alone has come to it.
    """

    def __init__(
        self,
        initial: int,
        cuts: Sequence[tuple[tuple[int, ...], ...]],
        bases: Sequence[int],
        strides: Sequence[tuple[int, ...]],
        class_of: Sequence[int],
        rows: Sequence[Sequence[Any]],
        time_values: Sequence[int],
    ) -> None:
        self.start: Token = (initial, ())
        self.cuts_of = cuts
        self.bases = bases
        self.strides = strides
        self.class_of = class_of
        self.rows = rows
        self.time_values = time_values
        self.kept = [tuple(range(count)) for count in range(1 + max(map(len, cuts)))]
        self.bare: list[Token] = [(location, ()) for location in range(len(cuts))]

    def row(self, token: Token, t: int) -> int:
        """The row of a token at `t`."""
        location, anchors = token
        row = self.bases[location]
        if anchors:
            cuts = self.cuts_of[location]
            strides = self.strides[location]
            for clock, anchor in enumerate(anchors):
                row += bisect_right(cuts[clock], t - anchor) * strides[clock]
        return row

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        location, anchors = token
        row = self.bases[location]
        if anchors:
            cuts = self.cuts_of[location]
            strides = self.strides[location]
            for clock, anchor in enumerate(anchors):
                row += bisect_right(cuts[clock], t - anchor) * strides[clock]
        target: int
        target, sources = self.rows[row][self.class_of[letter]]
        if not sources:
            return self.bare[target]
        return target, tuple([t if source < 0 else anchors[source] for source in sources])

    def stays(self, token: Token, t: int, letter: int) -> bool:
        """Whether a token that was stepped at `t` stays as it is under the same letter."""
        location, anchors = token
        edge = self.rows[self.row(token, t)][self.class_of[letter]]
        return edge is not None and edge[0] == location and edge[1] == self.kept[len(anchors)]

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages from which on it acts differently."""
        return self.cuts_of[location]

    def time_value(self, token: Token, t: int) -> int:
        """The truth once time has come to `t` and no position came."""
        return self.time_values[self.row(token, t)]


class TableMachine(Table):
    """Steps an automaton through its tables, and knows what is owed."""

    def __init__(self, automaton: Automaton) -> None:
        super().__init__(*_layout(automaton, automaton.class_of))
        self.automaton = automaton

    def residual(self, location: int) -> Residual:
        """See `Machine`."""
        return self.automaton.locations[location].residual


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


def next_cut(machine: Any, token: Token, t: int) -> int:
    """The first instant after `t` at which a clock of the token enters another region."""
    location, anchors = token
    found = NEVER
    if anchors:
        cuts = machine.cuts(location)
        for clock, anchor in enumerate(anchors):
            for cut in cuts[clock]:
                if anchor + cut > t:
                    found = min(found, anchor + cut)
                    break
    return found


def settle(machine: Any, token: Token, t: int, until: int) -> tuple[Token, int]:
    """Let time pass from `t` to `until` without a position.

    Returns the token and the instant of its decision, or the next at which it might be decided.
    """
    cut = next_cut(machine, token, t)
    while cut <= until:
        truth = machine.time_value(token, cut)
        if truth != UNKNOWN:
            return (PASSED if truth else FAILED, ()), cut
        cut = next_cut(machine, token, cut)
    return token, cut


def run(
    machine: Any, token: Token, letter: int, first: int, last: int, period: int
) -> tuple[Token, int, bool]:
    """Step a token through equal letters, jumping where it only loops.

    Args:
        machine: the automaton.
        token: undecided; the last position before was `first - period`.
        letter: at all these positions.
        first: the first position.
        last: the instant that time comes to; the positions are each `period` ticks up to it.
        period: between two positions.

    Returns:
        The token; the instant of its decision, or the first after `last` at which it will not just
        loop on; whether a clock moves along while it loops.
    """
    position = first
    slides = False
    while True:
        if period > 1:
            token, cut = settle(machine, token, position - period, min(position - 1, last))
            if token[0] <= PASSED:
                return token, cut, False
        if position > last:
            return token, position if period == 1 else min(position, cut), True
        moved = machine.step(token, position, letter)
        if moved[0] <= PASSED:
            return moved, position, False
        same = moved == token
        loop = same or _loops(token, moved, period)
        before, token = token, moved
        if loop:
            cut = (
                next_cut(machine, token, position)
                if same
                else _kept_cut(machine, before, moved, position)
            )
            ahead = min(cut - 1 - position, last - position) // period * period
            slides = not same
            if ahead > 0:
                if slides:
                    token = _slide(before, token, ahead)
                position += ahead
            if cut > last:
                return token, cut, slides or period > 1
        position += period


def _loops(before: Token, behind: Token, period: int) -> bool:
    """Whether a step only looped: each clock was kept, or moved by a period."""
    if before[0] != behind[0]:
        return False
    return all(new in (old, old + period) for old, new in zip(before[1], behind[1], strict=True))


def _kept_cut(machine: Any, before: Token, behind: Token, t: int) -> int:
    found = NEVER
    cuts = machine.cuts(behind[0])
    for clock, anchor in enumerate(behind[1]):
        if anchor == before[1][clock]:
            for cut in cuts[clock]:
                if anchor + cut > t:
                    found = min(found, anchor + cut)
                    break
    return found


def _slide(before: Token, behind: Token, ticks: int) -> Token:
    return behind[0], tuple(
        [new if new == old else new + ticks for old, new in zip(before[1], behind[1], strict=True)]
    )
