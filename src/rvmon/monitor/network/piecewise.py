"""Piecewise linear functions from positions to the stamps at which a value becomes known.

A *piece* `(left, right, at, slope)` states that at each position i from `left` to `right` a value
is known from the stamp `at + slope * i` on. At a position without a piece the value is not known,
or it is the other one. A set of known positions is such a function with all stamps `PAST`.

A stamp is twice an instant in ticks, plus one if the letter of the position at that instant is
needed. The slope is 0 or twice the distance of two positions, so the functions are closed under
minima and maxima over windows. A held letter costs one piece, however long it is held.

`Positions` defines which integers are positions, and how operators treat the others.

Source: AUTOMATA 4; the two sets of intervals are those of Basin, Klaedtke and Zalinescu 2011.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter

Piece = tuple[int, int, int, int]
Pieces = Sequence[Piece]  # in order of position, none touching another
FAR = 1 << 80  # greater than all positions; `-FAR` is less than all
PAST = -(1 << 90)  # a stamp before all others
EVER: Pieces = ((-FAR, FAR, PAST, 0),)  # known at every position from the beginning

_left = itemgetter(0)


def stamp(pieces: Pieces, position: int) -> int | None:
    """The stamp of a position; `None` if it is not known."""
    index = bisect_right(pieces, position, key=_left) - 1
    if index < 0:
        return None
    _, right, at, slope = pieces[index]
    return at + slope * position if position <= right else None


def unchanged_until(known: tuple[Pieces, Pieces], integer: int) -> int:
    """The last integer up to which both functions keep the piece, or none, of `integer`."""
    end = FAR
    for pieces in known:
        index = bisect_right(pieces, integer, key=_left) - 1
        if index >= 0 and pieces[index][1] >= integer:
            end = min(end, pieces[index][1])
        if index + 1 < len(pieces):
            end = min(end, pieces[index + 1][0] - 1)
    return end


def append(pieces: list[Piece], left: int, right: int, at: int, slope: int) -> None:
    """Append a piece; drop it if it is empty, merge it if it continues the last one."""
    if left > right:
        return
    if pieces:
        start, end, its_at, its_slope = pieces[-1]
        if end + 1 == left and its_at == at and its_slope == slope:
            pieces[-1] = (start, right, at, slope)
            return
    pieces.append((left, right, at, slope))


def clip(pieces: Pieces, left: int, right: int = FAR) -> Pieces:
    """The function restricted to positions from `left` to `right`; may return `pieces` itself."""
    if not pieces or (pieces[0][0] >= left and pieces[-1][1] <= right):
        return pieces
    made: list[Piece] = []
    for first, last, at, slope in pieces[max(bisect_right(pieces, left, key=_left) - 1, 0) :]:
        if first > right:
            break
        append(made, max(first, left), min(last, right), at, slope)
    return made


def shift(pieces: Pieces, offset: int) -> Pieces:
    """The function whose value at i is that of `pieces` at i + offset."""
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
    """The function restricted to the positions known by the stamp `limit`."""
    found: list[Piece] = []
    for left, right, at, slope in pieces:
        if slope:
            append(found, left, min(right, (limit - at) // slope), at, slope)
        elif at <= limit:
            append(found, left, right, at, slope)
    return found


def not_before(pieces: Pieces, at: int, slope: int) -> Pieces:
    """The function with each stamp raised to at least `at + slope * i`."""
    return latest(pieces, ((-FAR, FAR, at, slope),))


def earliest(pieces: Pieces, other: Pieces) -> Pieces:
    """The pointwise minimum: known as soon as one of the two is."""
    if not pieces or not other:
        return pieces or other
    made: list[Piece] = []
    for left, right, first, second in _refined(pieces, other):
        if first is not None and second is not None:
            _choose(made, left, right, first, second, least=True)
        elif line := first or second:
            append(made, left, right, *line)
    return made


def latest(pieces: Pieces, other: Pieces) -> Pieces:
    """The pointwise maximum: known once both are."""
    if not pieces or not other:
        return ()
    made: list[Piece] = []
    for left, right, first, second in _refined(pieces, other):
        if first is not None and second is not None:
            _choose(made, left, right, first, second, least=False)
    return made


Line = tuple[int, int]  # stamp at position 0, and slope


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


def _refined(pieces: Pieces, other: Pieces) -> Iterable[tuple[int, int, Line | None, Line | None]]:
    """The stretches on which each function has one line or none, in order; skips empty ones."""
    i = j = 0
    at = -FAR
    while i < len(pieces) or j < len(other):
        start, end, *line = pieces[i] if i < len(pieces) else _NO_MORE
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


_NO_MORE: Piece = (FAR + 1, FAR + 1, 0, 0)  # a sentinel after all pieces


def some_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """The minimum over the window [i + low, i + high]: known as soon as one position is known.

    Stamps do not decrease within a piece, so the least stamp in a window is at its first position,
    or at the left end of a piece within it; a sliding minimum gives the latter.
    """
    if low > high or not pieces:
        return ()
    ends = [(left, at + slope * left if slope else at) for left, _, at, slope in pieces]
    entered = _sliding(ends, low, high, keeps=lambda old, new: old < new)
    return earliest(shift(pieces, low), entered)


def all_of_window(pieces: Pieces, low: int, high: int) -> Pieces:
    """The maximum over the window [i + low, i + high]: known once all its positions are known."""
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
    """The function extended by `PAST` wherever it has no piece."""
    made: list[Piece] = []
    at = -FAR
    for left, right, stamp_, slope in pieces:
        append(made, at, left - 1, PAST, 0)
        append(made, left, right, stamp_, slope)
        at = right + 1
    append(made, at, FAR, PAST, 0)
    return made


def _runs(pieces: Pieces) -> Iterable[tuple[int, int]]:
    """The maximal stretches of positions covered by pieces."""
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

    Points are positions, ascending, with their stamps; `low` and `high` are the window's offsets;
    `keeps`: whether the stamp of an older point is better than that of a newer one.
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
        # Monotone queue: a point can never be the best again once a newer one is better, as the
        # newer one stays longer in the window.
        while best and not keeps(best[-1][1], value):
            best.pop()
        best.append((position, value))
    settle(FAR)
    return made


class Positions:
    """The positions of a word.

    In held and clocked time they are consecutive integers: ticks, or multiples of the period. In
    sampled time they are the instants of samples in ticks; other integers are not positions.

    Args:
        gap: ticks between two positions; `None` if only samples are positions.
        stamps: the positions that have a letter, ascending.
    """

    def __init__(self, gap: int | None, stamps: Sequence[int]) -> None:
        self.gap = gap or 1  # ticks between two integers; 1 in sampled time
        self.slope = 2 * self.gap  # the increase of the stamp from one integer to the next
        self.sparse = not gap  # whether there are integers between positions (sampled time)
        self.first = stamps[0] if stamps else FAR  # the first position; `FAR` if there is none
        self.stamps = stamps if self.sparse else ()  # in sampled time, all positions; else empty
        # the last position; `FAR` if they continue without end
        self.last = stamps[-1] if self.sparse and stamps else -FAR if self.sparse else FAR

    def ended(self, last: int) -> Positions:
        """The same positions, without those after `last`."""
        made = Positions(None if self.sparse else self.gap, [self.first])
        made.stamps = self.stamps[: bisect_right(self.stamps, last)]
        made.last = min(self.last, last)
        return made

    def following(self, integer: int) -> int:
        """The first position at or after an integer; if none, an integer after all positions."""
        if not self.sparse:
            return max(integer, self.first) if self.first < FAR else integer
        index = bisect_left(self.stamps, integer)
        return self.stamps[index] if index < len(self.stamps) else max(integer, self.last + 1)

    def within(self, left: int, right: int) -> Sequence[int]:
        """In sampled time, the positions from `left` to `right`."""
        stamps = self.stamps
        return stamps[bisect_left(stamps, left) : bisect_right(stamps, right)]

    def extended(self, pieces: Pieces) -> Pieces:
        """In sampled time, extend the value at each position to the integers up to the next."""
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

    def at_positions(self, pieces: Pieces) -> Pieces:
        """Restrict to positions, for an operand that must be met at some position."""
        found = clip(pieces, self.first, self.last)
        if not self.sparse:
            return found
        made: list[Piece] = []
        for first, last, at, slope in found:
            for position in self.within(first, last):
                append(made, position, position, at + slope * position, 0)
        return made

    def or_no_position(self, pieces: Pieces) -> Pieces:
        """Extend to integers that are not positions, for an operand that must hold throughout."""
        made: list[Piece] = []
        append(made, -FAR, self.first - 1, PAST, 0)
        next_start = self.first
        for first, last, at, slope in clip(pieces, self.first, self.last):
            self._fill(made, next_start, first - 1)
            start = first
            for position in self.within(first, last):
                append(made, start, position - 1, PAST, 0)
                append(made, position, position, at + slope * position, 0)
                start = position + 1
            append(made, start, last, *((PAST, 0) if self.sparse else (at, slope)))
            next_start = last + 1
        self._fill(made, next_start, self.last)
        append(made, max(self.last + 1, next_start), FAR, PAST, 0)
        return made

    def _fill(self, made: list[Piece], left: int, right: int) -> None:
        """Append the integers from `left` to `right` that are not positions."""
        if not self.sparse:
            return
        for position in self.within(left, right):
            append(made, left, position - 1, PAST, 0)
            left = position + 1
        append(made, left, right, PAST, 0)
