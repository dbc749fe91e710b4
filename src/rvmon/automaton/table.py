"""An automaton as a machine: steps are look-ups in its tables."""

from __future__ import annotations

from bisect import bisect_right

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.location import NOW
from rvmon.automaton.machine import Token
from rvmon.formula.residual import Residual


class TableMachine:
    """Runs an automaton."""

    def __init__(self, automaton: Automaton) -> None:
        self.automaton = automaton
        self.start: Token = (automaton.initial, ())
        self._cuts = tuple(location.cuts for location in automaton.locations)

    def _row(self, token: Token, t: int) -> int:
        location, anchors = token
        row = self.automaton.bases[location]
        if anchors:
            strides = self.automaton.strides[location]
            for anchor, cuts, stride in zip(anchors, self._cuts[location], strides, strict=True):
                row += bisect_right(cuts, t - anchor) * stride
        return row

    def step(self, token: Token, t: int, letter: int) -> Token:
        """See `Machine`."""
        automaton = self.automaton
        row = self._row(token, t)
        edge = automaton.edges[row * automaton.classes + automaton.class_of[letter]]
        sources = automaton.sources[edge]
        if not sources:
            return automaton.targets[edge], ()
        anchors = token[1]
        moved = tuple([t if source == NOW else anchors[source] for source in sources])
        return automaton.targets[edge], moved

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """See `Machine`."""
        return self._cuts[location]

    def time_value(self, token: Token, t: int) -> int:
        """See `Machine`."""
        return self.automaton.time_values[self._row(token, t)]

    def residual(self, location: int) -> Residual:
        """See `Machine`."""
        return self.automaton.locations[location].residual
