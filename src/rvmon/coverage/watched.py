"""Coverpoints and crosses at a position: which bins are hit, given the truth of their formulas.

A hit is counted where it is sure. A coverpoint that is looked at `upon` something is hit where an
attempt of a requirement `upon` it would start: each bin that is true there. Any other is looked at
everywhere: a bin is hit at each position where it is true if it is a pulse, and else once for each
stretch on which it is true; that a bin is unknown in between ends no stretch, as it may have been
true. A combination of bins is true where all of them are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from itertools import product

from rvmon.coverage.hits import Hit
from rvmon.runtime.values import FALSE, TRUE

Bins = tuple[int, ...]
"""A combination of bins, one of each axis, by their numbers."""


class Watched:
    """A coverpoint, or a cross, on a run.

    Args:
        name: of its group in the model.
        axes: of a coverpoint its bins, of a cross those of each coverpoint, by number.
        items: by combination of bins, the name of its item.
        places: by number, where the formula of a bin, or of an occasion, stands among the values.
        pulses: the numbers of those that are pulses.
        occasion: the number of what says where it is looked at; `None`: everywhere.
    """

    def __init__(
        self,
        name: str,
        axes: Sequence[Sequence[int]],
        items: Mapping[Bins, str],
        places: Sequence[int],
        pulses: Set[int],
        occasion: int | None,
    ) -> None:
        self.name = name
        self._axes = [[(number, places[number]) for number in axis] for axis in axes]
        self._items = items
        self._places = places
        self._pulses = pulses
        self._occasion = occasion
        self._before = FALSE
        self._standing: set[Bins] = set()
        self._counts: dict[Bins, int] = {}
        self._firsts: dict[Bins, int] = {}

    @property
    def hits(self) -> dict[str, Hit]:
        """By item, how often it was hit."""
        return {
            self._items[bins]: Hit(count, self._firsts[bins])
            for bins, count in self._counts.items()
        }

    def look(self, t: int, values: Sequence[int]) -> None:
        """See a position."""
        occasion = self._occasion
        if occasion is not None:
            before, self._before = self._before, values[self._places[occasion]]
            if self._before != TRUE or not (occasion in self._pulses or before == FALSE):
                return
            for bins in self._true(values):
                self._hit(bins, t)
            return
        now = self._true(values)
        standing = self._standing
        for bins in now:
            if bins not in standing:
                self._hit(bins, t)
        # A pulse is over at the next position; what is unknown may be true.
        self._standing = {bins for bins in now if self._pulses.isdisjoint(bins)}
        for bins in standing.difference(now):
            if all(values[self._places[number]] != FALSE for number in bins):
                self._standing.add(bins)

    def _true(self, values: Sequence[int]) -> list[Bins]:
        """The combinations of bins that are true."""
        axes = [[number for number, place in axis if values[place] == TRUE] for axis in self._axes]
        return [*product(*axes)]

    def _hit(self, bins: Bins, t: int) -> None:
        known = self._counts.get(bins)
        if known is None:
            self._counts[bins] = 1
            self._firsts[bins] = t
        else:
            self._counts[bins] = known + 1
