"""Which integers are positions, and what operators that count positions make of the others."""

from __future__ import annotations

from bisect import bisect_left, bisect_right

from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append, clip


class Positions:
    """The positions of a word.

    In held time and under a clock they are consecutive: ticks, or ticks of the clock. In sampled
    time they are the instants of samples, and what lies between is none.

    Args:
        gap: ticks between two positions; `None` if only samples are positions.

    Attributes:
        stamps: where they are sparse, those of which something may be asked.
        gap: ticks between two integers, 1 in sampled time.
        slope: what a stamp grows by from one integer to the next.
        sparse: whether there are integers between positions.
        first: the first position; `FAR` before there is one.
        last: the last position; `FAR` while it is taken that they go on.
    """

    def __init__(self, gap: int | None) -> None:
        self.gap = gap or 1
        self.slope = 2 * self.gap
        self.sparse = not gap
        self.first = FAR
        self.last = FAR if gap else -FAR
        self.stamps: list[int] = []

    @property
    def distance(self) -> int | None:
        """Ticks between two positions; `None` if only samples are positions."""
        return None if self.sparse else self.gap

    def copy(self) -> Positions:
        """The same, independent from now on."""
        made = Positions.__new__(Positions)
        made.gap, made.slope, made.sparse = self.gap, self.slope, self.sparse
        made.first, made.last = self.first, self.last
        made.stamps = list(self.stamps)
        return made

    def visit(self, position: int) -> int:
        """Come to a position; returns the integer behind the position before it.

        For the first one that is the position itself.
        """
        if self.first == FAR:
            self.first = position
        if not self.sparse:
            return position
        behind = self.last + 1 if self.last > -FAR else position
        if self.last < position:
            self.stamps.append(position)
            self.last = position
        return behind

    def end(self, last: int) -> None:
        """Learn that there is no position behind `last`."""
        self.last = min(self.last, last)

    def forget(self, before: int) -> None:
        """Drop the positions before `before`, of which nothing will be asked, but for the last."""
        if self.stamps:
            del self.stamps[: max(bisect_left(self.stamps, before) - 1, 0)]

    def following(self, integer: int) -> int:
        """The first position at or behind an integer, or the integer itself if there is none."""
        if not self.sparse:
            return max(integer, self.first) if self.first < FAR else integer
        index = bisect_left(self.stamps, integer)
        return self.stamps[index] if index < len(self.stamps) else max(integer, self.last + 1)

    def alike_from(self, integer: int) -> int:
        """The first integer of which no more can be known than of one: both lie before a position.

        Where that is still to come, the one behind the last position.
        """
        index = bisect_left(self.stamps, integer) if self.sparse else 0
        return self.stamps[index - 1] + 1 if index else integer

    def standing_at(self, integer: int) -> int:
        """The last position not behind an integer, or the integer itself if there is none."""
        if not self.sparse:
            return integer
        index = bisect_right(self.stamps, integer)
        return self.stamps[index - 1] if index else integer

    def within(self, left: int, right: int) -> list[int]:
        """The positions from `left` to `right` where they are sparse."""
        stamps = self.stamps
        return stamps[bisect_left(stamps, left) : bisect_right(stamps, right)]

    def cells(self, pieces: Pieces) -> Pieces:
        """Of each piece its positions, where they are sparse with all integers back to others."""
        if not self.sparse:
            return pieces
        stamps = self.stamps
        made: list[Piece] = []
        for left, right, at, slope in pieces:
            index, end = bisect_left(stamps, left), bisect_right(stamps, right)
            while index < end:
                until = index + 1 if slope else end
                start = stamps[index - 1] + 1 if index else stamps[0]
                append(made, start, stamps[until - 1], at + slope * stamps[until - 1], 0)
                index = until
        return made

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

    def only(self, pieces: Pieces, left: int, right: int) -> Pieces:
        """Known at positions alone, for what has to be met at one of them.

        Args:
            pieces: what is known.
            left: the first integer that matters.
            right: the last one.
        """
        found = clip(pieces, max(left, self.first), min(right, self.last))
        if not self.sparse:
            return found
        made: list[Piece] = []
        for first, last, at, slope in found:
            for position in self.within(first, last):
                append(made, position, position, at + slope * position, 0)
        return made

    def besides(self, pieces: Pieces, left: int, right: int) -> Pieces:
        """Known at all integers that are no positions as well, for what has to hold at each.

        Args:
            pieces: what is known.
            left: the first integer that matters.
            right: the last one.
        """
        if not self.sparse and left >= self.first and right <= self.last:
            return clip(pieces, left, right)
        made: list[Piece] = []
        append(made, left, min(right, self.first - 1), PAST, 0)
        behind = max(left, self.first)
        for first, last, at, slope in clip(pieces, behind, min(right, self.last)):
            self._fill(made, behind, first - 1)
            if not self.sparse or at == PAST:
                append(made, first, last, at, slope)
            else:
                start = first
                for position in self.within(first, last):
                    append(made, start, position - 1, PAST, 0)
                    append(made, position, position, at + slope * position, 0)
                    start = position + 1
                append(made, start, last, PAST, 0)
            behind = last + 1
        self._fill(made, behind, min(right, self.last))
        append(made, max(left, self.last + 1, behind), right, PAST, 0)
        return made

    def _fill(self, made: list[Piece], left: int, right: int) -> None:
        """Append the integers from `left` to `right` that are no positions."""
        if not self.sparse:
            return
        for position in self.within(left, right):
            append(made, left, position - 1, PAST, 0)
            left = position + 1
        append(made, left, right, PAST, 0)
