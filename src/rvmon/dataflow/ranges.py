"""Ranges of integers, and where pieces begin and end around one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from operator import itemgetter

from rvmon.dataflow.evaluate import Range
from rvmon.dataflow.pieces import FAR, Piece, Pieces
from rvmon.dataflow.sweep import Known


def holds(ranges: Iterable[Range], integer: int) -> bool:
    """Whether an integer lies in one of them."""
    return any(first <= integer <= last for first, last in ranges)


def merged(ranges: Iterable[Range]) -> list[Range]:
    """The same integers, in ascending ranges that do not touch."""
    made: list[Range] = []
    for first, last in sorted(ranges):
        if made and first <= made[-1][1] + 1:
            made[-1] = (made[-1][0], max(made[-1][1], last))
        elif first <= last:
            made.append((first, last))
    return made


def drop(pieces: list[Piece], before: int) -> None:
    """Drop the pieces that lie wholly before an integer."""
    count = 0
    while count < len(pieces) and pieces[count][1] < before:
        count += 1
    if count:
        del pieces[:count]


def end_of(pieces: Pieces, integer: int) -> int:
    """The end of the piece that holds an integer; one less than that if none does."""
    index = bisect_right(pieces, integer, key=itemgetter(0)) - 1
    return pieces[index][1] if index >= 0 and pieces[index][1] >= integer else integer - 1


def stretch(known: Known, integer: int) -> Range:
    """The stretch around an integer on which nothing changes."""
    start, end = -FAR, FAR
    for pieces in known:
        index = bisect_right(pieces, integer, key=itemgetter(0)) - 1
        if index >= 0:
            left, right, _, _ = pieces[index]
            start = max(start, left if right >= integer else right + 1)
            end = min(end, right) if right >= integer else end
        if index + 1 < len(pieces):
            end = min(end, pieces[index + 1][0] - 1)
    return start, end
