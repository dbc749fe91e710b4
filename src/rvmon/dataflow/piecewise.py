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

_SHORT = 4
"""So few pieces are looked at one by one."""

_left = itemgetter(0)


def stamp(pieces: Pieces, position: int) -> int | None:
    """The stamp of a position; `None` if it is not known."""
    index = bisect_right(pieces, position, key=_left) - 1
    if index < 0:
        return None
    _, right, at, slope = pieces[index]
    return at + slope * position if position <= right else None


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
    start, end = span(pieces, left, right)
    found = list(pieces[start:end])
    if found:
        first, last, at, slope = found[0]
        if first < left:
            found[0] = (left, last, at, slope)
        first, last, at, slope = found[-1]
        if last > right:
            found[-1] = (first, right, at, slope)
    return found


def span(pieces: Pieces, left: int, right: int) -> tuple[int, int]:
    """The indices of the pieces between two positions: the first, and that behind the last.

    There are none if the positions are the wrong way round, also where one piece holds both.
    """
    count = len(pieces)
    if left > right:
        return count, count
    if count <= _SHORT:
        start = 0
        while start < count and pieces[start][1] < left:
            start += 1
        end = start
        while end < count and pieces[end][0] <= right:
            end += 1
        return start, end
    start = max(bisect_right(pieces, left, key=_left) - 1, 0)
    if pieces[start][1] < left:
        start += 1
    return start, max(bisect_right(pieces, right, key=_left), start)


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


def soonest(one: Pieces, other: Pieces) -> Pieces:
    """Known if either is, as soon as the first is."""
    if not one or not other:
        return one or other
    if one[0][0] > other[0][0]:
        one, other = other, one
    if one[-1][1] < other[0][0]:
        return [*one, *other]
    made: list[Piece] = []
    for left, right, first, second in _refined(one, other):
        if first is None or second is None:
            at, slope = first or second or (PAST, 0)
            append(made, left, right, at, slope)
        else:
            _choose(made, left, right, first, second, least=True)
    return made


def latest(one: Pieces, other: Pieces) -> Pieces:
    """Known if both are, as soon as the second is."""
    made: list[Piece] = []
    ones, others = iter(one), iter(other)
    first, second = next(ones, None), next(others, None)
    while first is not None and second is not None:
        left, right, at, slope = first
        its_left, its_right, its_at, its_slope = second
        start = left if left > its_left else its_left
        end = right if right < its_right else its_right
        if start <= end:
            if slope == its_slope:
                append(made, start, end, at if at > its_at else its_at, slope)
            else:
                _choose(made, start, end, (at, slope), (its_at, its_slope), least=False)
        if right <= its_right:
            first = next(ones, None)
        if its_right <= right:
            second = next(others, None)
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
    ones, others = list(one), list(other)
    i = j = 0
    at = -FAR
    while i < len(ones) or j < len(others):
        here = ones[i] if i < len(ones) else None
        there = others[j] if j < len(others) else None
        starts = [max(piece[0], at) for piece in (here, there) if piece is not None]
        left = min(starts)
        first = second = None
        ends = []
        for piece, is_first in ((here, True), (there, False)):
            if piece is None:
                continue
            if max(piece[0], at) > left:
                ends.append(piece[0] - 1)
                continue
            ends.append(piece[1])
            if is_first:
                first = piece[2:]
            else:
                second = piece[2:]
        right = min(ends)
        yield left, right, first, second
        at = right + 1
        if here is not None and here[1] < at:
            i += 1
        if there is not None and there[1] < at:
            j += 1


def some_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """Known at i if it is at some position from i + low to i + high, as soon as at the first.

    As stamps do not fall within a piece, the least stamp in a window is that at its first position,
    or at the left end of a piece within it: those are met by a sliding minimum.
    """
    if low > high or not pieces:
        return ()
    if rises(pieces):
        return _soonest_first(pieces, low, high)
    ends = [(left, at + slope * left if slope else at) for left, _, at, slope in pieces]
    entered = _sliding(ends, low, high, keeps=lambda old, new: old < new)
    return soonest(shift(pieces, low), entered)


def rises(pieces: Pieces) -> bool:
    """Whether no stamp is before one further left."""
    if len(pieces) == 1:
        return True
    before = PAST
    for left, right, at, slope in pieces:
        if at + slope * left < before:
            return False
        before = at + slope * right
    return True


def _soonest_first(pieces: Pieces, low: int, high: int) -> Pieces:
    """`some_of_window` where stamps rise: the first position of a window is the soonest."""
    made: list[Piece] = []
    end = -FAR
    for left, right, at, slope in pieces:
        if left > -FAR:
            start = max(end, left - high)
            append(made, start, left - low - 1, at + slope * left, 0)
            left -= low
        right = right - low if right < FAR else FAR
        append(made, left, right, at + slope * low, slope)
        end = right + 1
    return made


def all_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """Known at i if it is at all positions from i + low to i + high, as soon as at the last."""
    if low > high:
        return EVER
    made: list[Piece] = []
    if rises(pieces):
        # The last position of a window is the latest.
        moved = shift(pieces, high)
        for first, last in _runs(pieces):
            made += clip(
                moved, first - low if first > -FAR else first, FAR if last >= FAR else last - high
            )
        return made
    ends = [
        (right, at + slope * right if slope else at)
        for _, right, at, slope in pieces
        if right < FAR
    ]
    left_of = _sliding(ends, low, high, keeps=lambda old, new: old > new)
    floor = filled(left_of)
    for first, last in _runs(pieces):
        start = first - low if first > -FAR else first
        end = last - high if last < FAR else last
        if start <= end:
            made += latest(clip(shift(pieces, high), start, end), clip(floor, start, end))
    return made


def filled(pieces: Pieces) -> Pieces:
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
