"""Functions from positions to the instants at which something becomes known, in pieces.

A *piece* `(left, right, at, slope)` says of each position i from `left` to `right` that a value is
known there from the stamp `at + slope * i` on. Positions that no piece covers are not known, or
not with that value. A set of known positions is such a function whose stamps are all `PAST`.

Stamps are twice the instant; one more if the letter of the position at that instant is needed. The
slope is 0 or twice the distance of two positions, so that the functions are closed under minima and
maxima over windows: this is what makes held time cheap, however long it is held.

`Positions` says which integers are positions, and what operators that count them make of others.

Source: AUTOMATA 4; the two sets of intervals are those of Basin, Klaedtke and Zalinescu 2011.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter

Piece = tuple[int, int, int, int]
Pieces = Sequence[Piece]
"""In order of position, none touching another."""

FAR = 1 << 80
"""Beyond all positions, as `-FAR` is before them."""

PAST = -(1 << 90)
"""The stamp of what was known before."""

EVER: Pieces = ((-FAR, FAR, PAST, 0),)
"""Known everywhere, from the first."""

_left = itemgetter(0)


def stamp(pieces: Pieces, position: int) -> int | None:
    """The stamp of a position; `None` if it is not known."""
    index = bisect_right(pieces, position, key=_left) - 1
    if index < 0:
        return None
    _, right, at, slope = pieces[index]
    return at + slope * position if position <= right else None


def unchanged_until(known: tuple[Pieces, Pieces], integer: int) -> int:
    """The last integer up to which what is known stays as it is at one."""
    end = FAR
    for pieces in known:
        index = bisect_right(pieces, integer, key=_left) - 1
        if index >= 0 and pieces[index][1] >= integer:
            end = min(end, pieces[index][1])
        if index + 1 < len(pieces):
            end = min(end, pieces[index + 1][0] - 1)
    return end


def append(pieces: list[Piece], left: int, right: int, at: int, slope: int) -> None:
    """Add a piece behind all others; an empty one is left out, one that goes on is joined."""
    if left > right:
        return
    if pieces:
        start, end, its_at, its_slope = pieces[-1]
        if end + 1 == left and its_at == at and its_slope == slope:
            pieces[-1] = (start, right, at, slope)
            return
    pieces.append((left, right, at, slope))


def clip(pieces: Pieces, left: int, right: int = FAR) -> Pieces:
    """What lies between two positions, both included; it may be the very same pieces."""
    if not pieces or (pieces[0][0] >= left and pieces[-1][1] <= right):
        return pieces
    made: list[Piece] = []
    for first, last, at, slope in pieces[max(bisect_right(pieces, left, key=_left) - 1, 0) :]:
        if first > right:
            break
        append(made, max(first, left), min(last, right), at, slope)
    return made


def shift(pieces: Pieces, offset: int) -> Pieces:
    """At each position what is known of the one `offset` further on."""
    if not offset:
        return pieces
    return [
        (
            left - offset if left > -FAR else left,
            right - offset if right < FAR else right,
            at + slope * offset,
            slope,
        )
        for left, right, at, slope in pieces
    ]


def up_to(pieces: Pieces, limit: int) -> Pieces:
    """What is known at the stamp `limit`."""
    found: list[Piece] = []
    for left, right, at, slope in pieces:
        if slope:
            append(found, left, min(right, (limit - at) // slope), at, slope)
        elif at <= limit:
            append(found, left, right, at, slope)
    return found


def not_before(pieces: Pieces, at: int, slope: int) -> Pieces:
    """With stamps of at least `at + slope * i`."""
    return latest(pieces, ((-FAR, FAR, at, slope),))


def earliest(one: Pieces, other: Pieces) -> Pieces:
    """Known if either is, as soon as the first is."""
    if not one or not other:
        return one or other
    made: list[Piece] = []
    for left, right, first, second in _refined(one, other):
        if first is not None and second is not None:
            _choose(made, left, right, first, second, least=True)
        elif line := first or second:
            append(made, left, right, *line)
    return made


def latest(one: Pieces, other: Pieces) -> Pieces:
    """Known if both are, as soon as the second is."""
    if not one or not other:
        return ()
    made: list[Piece] = []
    for left, right, first, second in _refined(one, other):
        if first is not None and second is not None:
            _choose(made, left, right, first, second, least=False)
    return made


Line = tuple[int, int]
"""Stamp at position 0, and slope."""


def _choose(
    made: list[Piece], left: int, right: int, one: Line, other: Line, *, least: bool
) -> None:
    """Append the lesser (or the greater) of two lines."""
    if one[1] > other[1]:
        one, other = other, one
    (flat, low_slope), (steep, high_slope) = one, other
    if low_slope == high_slope:
        at = min(flat, steep) if least else max(flat, steep)
        append(made, left, right, at, low_slope)
        return
    # Up to `cross` the steeper line is not above the other.
    cross = (flat - steep) // (high_slope - low_slope)
    lower = (steep, high_slope) if least else (flat, low_slope)
    upper = (flat, low_slope) if least else (steep, high_slope)
    append(made, left, min(right, cross), *lower)
    append(made, max(left, cross + 1), right, *upper)


def _refined(one: Pieces, other: Pieces) -> Iterable[tuple[int, int, Line | None, Line | None]]:
    """The stretches on which either has one line, in order; without those where neither has one."""
    i = j = 0
    at = -FAR
    while i < len(one) or j < len(other):
        start, end, *line = one[i] if i < len(one) else _NO_MORE
        its_start, its_end, *its_line = other[j] if j < len(other) else _NO_MORE
        left = max(at, min(start, its_start))
        right = min(
            end if start <= left else start - 1, its_end if its_start <= left else its_start - 1
        )
        first = (line[0], line[1]) if start <= left else None
        second = (its_line[0], its_line[1]) if its_start <= left else None
        yield left, right, first, second
        at = right + 1
        i += end < at
        j += its_end < at


_NO_MORE: Piece = (FAR + 1, FAR + 1, 0, 0)
"""Behind all pieces."""


def some_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """Known at i if it is at some position from i + low to i + high, as soon as at the first.

    As stamps do not fall within a piece, the least stamp in a window is that at its first position,
    or at the left end of a piece within it: those are met by a sliding minimum.
    """
    if low > high or not pieces:
        return ()
    ends = [(left, at + slope * left if slope else at) for left, _, at, slope in pieces]
    entered = _sliding(ends, low, high, keeps=lambda old, new: old < new)
    return earliest(shift(pieces, low), entered)


def all_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """Known at i if it is at all positions from i + low to i + high, as soon as at the last."""
    if low > high:
        return EVER
    made: list[Piece] = []
    ends = [
        (right, at + slope * right if slope else at)
        for _, right, at, slope in pieces
        if right < FAR
    ]
    left_of = _sliding(ends, low, high, keeps=lambda old, new: old > new)
    floor = _filled(left_of)
    for first, last in _runs(pieces):
        start = first - low if first > -FAR else first
        end = last - high if last < FAR else last
        if start <= end:
            made += latest(clip(shift(pieces, high), start, end), clip(floor, start, end))
    return made


def _filled(pieces: Pieces) -> Pieces:
    """The same, and `PAST` wherever it is not known."""
    made: list[Piece] = []
    at = -FAR
    for left, right, stamp_, slope in pieces:
        append(made, at, left - 1, PAST, 0)
        append(made, left, right, stamp_, slope)
        at = right + 1
    append(made, at, FAR, PAST, 0)
    return made


def _runs(pieces: Pieces) -> Iterable[tuple[int, int]]:
    """The stretches without a gap."""
    start: int | None = None
    end = 0
    for left, right, _, _ in pieces:
        if start is None:
            start = left
        elif left > end + 1:
            yield start, end
            start = left
        end = right
    if start is not None:
        yield start, end


def _sliding(
    points: Sequence[tuple[int, int]], low: int, high: int, *, keeps: Callable[[int, int], bool]
) -> Pieces:
    """The best stamp of the points within the window of each position.

    Args:
        points: positions, ascending, with their stamps.
        low: where the window of i begins, less i.
        high: where it ends, less i.
        keeps: whether an older point is better than a newer one.
    """
    made: list[Piece] = []
    best: deque[tuple[int, int]] = deque()
    done = -FAR

    def settle(until: int) -> None:
        """Append the best stamps of the positions up to `until`."""
        nonlocal done
        while best and done <= until:
            position, value = best[0]
            last = min(position - low, until)
            append(made, done, last, value, 0)
            done = max(done, last + 1)
            if position - low > until:
                return
            best.popleft()
        done = max(done, until + 1)

    for position, value in points:
        if position <= -FAR:
            continue
        settle(position - high - 1)
        while best and not keeps(best[-1][1], value):
            best.pop()
        best.append((position, value))
    settle(FAR)
    return made


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
