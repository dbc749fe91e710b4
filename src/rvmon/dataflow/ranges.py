"""Ranges of integers in order, none touching another, and where pieces begin and end around one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from operator import itemgetter

from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append
from rvmon.dataflow.sweep import Known

Range = tuple[int, int]
"""First and last integer."""

Ranges = list[Range]

_left = itemgetter(0)


def merged(ranges: Iterable[Range]) -> Ranges:
    """The same integers, in ascending ranges that do not touch."""
    made: Ranges = []
    for first, last in sorted(ranges):
        if first > last:
            continue
        if made and first <= made[-1][1] + 1:
            made[-1] = (made[-1][0], max(made[-1][1], last))
        else:
            made.append((first, last))
    return made


def add(ranges: Ranges, left: int, right: int) -> None:
    """Add integers that are not in them yet."""
    if not ranges or ranges[-1][1] < left:
        if ranges and ranges[-1][1] == left - 1:
            ranges[-1] = (ranges[-1][0], right)
        else:
            ranges.append((left, right))
        return
    index = bisect_right(ranges, left, key=_left)
    start, end = index, index
    if index and ranges[index - 1][1] == left - 1:
        start, left = index - 1, ranges[index - 1][0]
    if index < len(ranges) and ranges[index][0] == right + 1:
        end, right = index + 1, ranges[index][1]
    ranges[start:end] = [(left, right)]


def drop(ranges: Ranges, before: int) -> None:
    """Drop those that lie wholly before an integer."""
    count = 0
    while count < len(ranges) and ranges[count][1] < before:
        count += 1
    if count:
        del ranges[:count]


def around(ranges: Ranges, integer: int) -> Range | None:
    """The range that holds an integer."""
    if not ranges or ranges[-1][1] < integer:
        return None
    if ranges[-1][0] <= integer:
        return ranges[-1]
    index = bisect_right(ranges, integer, key=_left) - 1
    return ranges[index] if index >= 0 and ranges[index][1] >= integer else None


def last_up_to(ranges: Ranges, integer: int) -> int:
    """The last integer in them that is not behind one; below `-FAR` if there is none."""
    index = bisect_right(ranges, integer, key=_left) - 1
    return min(ranges[index][1], integer) if index >= 0 else -FAR - 1


def overlapping(ranges: Ranges, left: int, right: int) -> Sequence[Range]:
    """Those that have an integer from `left` to `right`, whole."""
    if not ranges or ranges[-1][1] < left or left > right:
        return ()
    if ranges[-1][0] <= left:
        return ranges[-1:]
    start = max(bisect_right(ranges, left, key=_left) - 1, 0)
    if ranges[start][1] < left:
        start += 1
    return ranges[start : bisect_right(ranges, right, key=_left)]


def within(pieces: Pieces, ranges: Ranges) -> list[Piece]:
    """The parts of pieces that lie in some ranges."""
    made: list[Piece] = []
    for left, right, at, slope in pieces:
        for first, last in overlapping(ranges, left, right):
            append(made, max(left, first), min(right, last), at, slope)
    return made


def outside(pieces: Pieces, ranges: Ranges) -> Pieces:
    """The parts of pieces that lie in none of some ranges."""
    if not pieces or not ranges or ranges[-1][1] < pieces[0][0]:
        return pieces
    made: list[Piece] = []
    for left, right, at, slope in pieces:
        start = left
        for first, last in overlapping(ranges, left, right):
            append(made, start, first - 1, at, slope)
            start = last + 1
        append(made, start, right, at, slope)
    return made


def on_stretch(ranges: Ranges, news: Pieces, on: Range) -> Pieces:
    """Where on a stretch something is known, which is so since ever but for its news."""
    first, last = on
    if news and (news[-1][1] < first or news[0][0] > last):
        news = ()
    elif news and news[-1][0] <= first and last <= news[-1][1]:
        return ((first, last, news[-1][2], news[-1][3]),)
    made: list[Piece] = []
    for left, right in overlapping(ranges, first, last):
        start, end = max(left, first), min(right, last)
        for its_left, its_right, at, slope in news:
            if its_right >= start and its_left <= end:
                append(made, start, its_left - 1, PAST, 0)
                append(made, max(its_left, start), min(its_right, end), at, slope)
                start = its_right + 1
        append(made, start, end, PAST, 0)
    return made


def gaps(ranges: Ranges, on: Range) -> Ranges:
    """The parts of a stretch that lie in none of some ranges."""
    found: Ranges = []
    at, last = on
    for left, right in overlapping(ranges, *on):
        if at < left:
            found.append((at, left - 1))
        at = right + 1
    if at <= last:
        found.append((at, last))
    return found


def stretch(known: Known, integer: int) -> Range:
    """The stretch around an integer on which nothing changes."""
    start, end = -FAR, FAR
    for pieces in known:
        index = bisect_right(pieces, integer, key=_left) - 1
        if index >= 0:
            left, right, _, _ = pieces[index]
            start = max(start, left if right >= integer else right + 1)
            end = min(end, right) if right >= integer else end
        if index + 1 < len(pieces):
            end = min(end, pieces[index + 1][0] - 1)
    return start, end
