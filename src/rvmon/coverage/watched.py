"""Coverpoints and crosses at a position: which bins are hit, given the truth of their formulas.

A hit is counted where it is sure. A coverpoint that is looked at `upon` something is hit where an
attempt of a requirement `upon` it would start: each bin that is true there. Any other is looked at
everywhere: a bin is hit at each position where it is true if it is a pulse, and else once for each
stretch on which it is true; that a bin is unknown in between ends no stretch, as it may have been
true. A combination of bins is true where all of them are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rvmon.coverage.hits import Hit
from rvmon.runtime.values import FALSE, TRUE


@dataclass(frozen=True, slots=True)
class WatchedBin:
    """A bin of a coverpoint.

    Attributes:
        name: of the bin.
        place: of its formula among the values.
        pulse: whether that is a pulse.
    """

    name: str
    place: int
    pulse: bool


@dataclass(frozen=True, slots=True)
class Occasion:
    """Where something is looked at that is not looked at everywhere.

    Attributes:
        place: of its formula among the values.
        pulse: whether that is a pulse.
    """

    place: int
    pulse: bool


class Watched:
    """A coverpoint, or a cross, on a run.

    Args:
        name: of its group in the model.
        axes: of a coverpoint its bins, of a cross those of each coverpoint.
        items: by combination of bins, the name of its item; what is not there is not counted.
        occasion: where it is looked at; `None`: everywhere.

    Attributes:
        hits: by item, how often it was hit.
    """

    def __init__(
        self,
        name: str,
        axes: Sequence[Sequence[WatchedBin]],
        items: Mapping[tuple[str, ...], str],
        occasion: Occasion | None,
    ) -> None:
        self.name = name
        self.axes = axes
        self.hits: dict[str, Hit] = {}
        self._items = items
        self._occasion = occasion
        self._before = FALSE
        self._standing: set[tuple[WatchedBin, ...]] = set()

    def look(self, t: int, values: Sequence[int]) -> None:
        """See a position.

        Args:
            t: its instant.
            values: the truth of all formulas there.
        """
        occasion = self._occasion
        if occasion is not None:
            before, self._before = self._before, values[occasion.place]
            if self._before != TRUE or not (occasion.pulse or before == FALSE):
                return
            for bins in self._true(values):
                self._hit(bins, t)
            return
        standing: set[tuple[WatchedBin, ...]] = set()
        for bins in self._true(values):
            if any(one.pulse for one in bins):
                self._hit(bins, t)
                continue
            standing.add(bins)
            if bins not in self._standing:
                self._hit(bins, t)
        for bins in self._standing - standing:
            if all(values[one.place] != FALSE for one in bins):
                standing.add(bins)
        self._standing = standing

    def _true(self, values: Sequence[int]) -> product[tuple[WatchedBin, ...]]:
        """The combinations of bins that are true."""
        return product(*([one for one in axis if values[one.place] == TRUE] for axis in self.axes))

    def _hit(self, bins: tuple[WatchedBin, ...], t: int) -> None:
        item = self._items.get(tuple(one.name for one in bins))
        if item is not None:
            known = self.hits.get(item)
            self.hits[item] = Hit(1, t) if known is None else Hit(known.count + 1, known.first)
