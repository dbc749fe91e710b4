"""Which integers are positions, and what operators that count positions make of the others."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append, clip


class Positions:
    """The positions of a word.

    In held time and under a clock they are consecutive: ticks, or ticks of the clock. In sampled
    time they are the instants of samples, and what lies between is none.

    Args:
        gap: ticks between two positions; `None` if only samples are positions.
        stamps: those that have a letter, ascending; empty before there is one.

    Attributes:
        stamps: where they are sparse, all positions.
        gap: ticks between two integers, 1 in sampled time.
        slope: what a stamp grows by from one integer to the next.
        sparse: whether there are integers between positions.
        first: the first position; `FAR` before there is one.
        last: the last position; `FAR` while it is taken that they go on.
    """

    def __init__(self, gap: int | None, stamps: Sequence[int]) -> None:
        self.gap = gap or 1
        self.slope = 2 * self.gap
        self.sparse = not gap
        self.first = stamps[0] if stamps else FAR
        self.stamps = stamps if self.sparse else ()
        self.last = stamps[-1] if self.sparse and stamps else -FAR if self.sparse else FAR

    def ended(self, last: int) -> Positions:
        """The same, with no position behind `last`."""
        made = Positions(None if self.sparse else self.gap, [self.first])
        made.stamps = self.stamps[: bisect_right(self.stamps, last)]
        made.last = min(self.last, last)
        return made

    def following(self, integer: int) -> int:
        """The first position at or behind an integer, or the integer itself if there is none."""
        if not self.sparse:
            return max(integer, self.first) if self.first < FAR else integer
        index = bisect_left(self.stamps, integer)
        return self.stamps[index] if index < len(self.stamps) else max(integer, self.last + 1)

    def within(self, left: int, right: int) -> Sequence[int]:
        """The positions from `left` to `right` where they are sparse."""
        stamps = self.stamps
        return stamps[bisect_left(stamps, left) : bisect_right(stamps, right)]

    def held_on(self, pieces: Pieces) -> Pieces:
        """Of each piece its positions, where they are sparse with all integers up to others."""
        if not self.sparse:
            return pieces
        stamps = self.stamps
        made: list[Piece] = []
        for left, right, at, slope in pieces:
            append(made, left, min(right, self.first - 1), at, slope)
            for index in range(bisect_left(stamps, left), bisect_right(stamps, right)):
                position = stamps[index]
                end = stamps[index + 1] - 1 if index + 1 < len(stamps) else FAR
                append(made, position, end, at + slope * position, 0)
        return made

    def only(self, pieces: Pieces) -> Pieces:
        """Known at positions alone, for what has to be met at one of them."""
        found = clip(pieces, self.first, self.last)
        if not self.sparse:
            return found
        made: list[Piece] = []
        for first, last, at, slope in found:
            for position in self.within(first, last):
                append(made, position, position, at + slope * position, 0)
        return made

    def besides(self, pieces: Pieces) -> Pieces:
        """Known at all integers that are no positions as well, for what has to hold at each."""
        made: list[Piece] = []
        append(made, -FAR, self.first - 1, PAST, 0)
        behind = self.first
        for first, last, at, slope in clip(pieces, self.first, self.last):
            self._fill(made, behind, first - 1)
            start = first
            for position in self.within(first, last):
                append(made, start, position - 1, PAST, 0)
                append(made, position, position, at + slope * position, 0)
                start = position + 1
            append(made, start, last, *((PAST, 0) if self.sparse else (at, slope)))
            behind = last + 1
        self._fill(made, behind, self.last)
        append(made, max(self.last + 1, behind), FAR, PAST, 0)
        return made

    def _fill(self, made: list[Piece], left: int, right: int) -> None:
        """Append the integers from `left` to `right` that are no positions."""
        if not self.sparse:
            return
        for position in self.within(left, right):
            append(made, left, position - 1, PAST, 0)
            left = position + 1
        append(made, left, right, PAST, 0)
