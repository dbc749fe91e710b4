"""Functions from positions to the instants at which something becomes known, in pieces.

A *piece* `(left, right, at, slope)` says of each position i from `left` to `right` that a value is
known there from the stamp `at + slope * i` on. Positions that no piece covers are not known, or
not with that value. A set of known positions is such a function whose stamps are all `PAST`.

Stamps are twice the instant; one more if the letter of the position at that instant is needed. The
slope is 0 or twice the distance of two positions, so that the functions are closed under minima and
maxima over windows: this is what makes held time cheap, however long it is held.

Source: AUTOMATA 4; the two sets of intervals are those of Basin, Klaedtke and Zalinescu 2011.
"""

from __future__ import annotations

from bisect import bisect_right
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
