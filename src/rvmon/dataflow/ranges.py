"""Ranges of integers, and where pieces begin and end around one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from operator import itemgetter

from rvmon.dataflow.evaluate import Range
from rvmon.dataflow.piecewise import FAR, PAST, Piece, Pieces, append, span
from rvmon.dataflow.sweep import Known

_left = itemgetter(0)


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


def end_of(pieces: Pieces, integer: int, limit: int) -> int:
    """The end of what is known at a stamp of the piece that holds an integer.

    One less than the integer if nothing is known there.
    """
    index = bisect_right(pieces, integer, key=_left) - 1
    if index < 0:
        return integer - 1
    _, right, at, slope = pieces[index]
    if slope:
        right = min(right, (limit - at) // slope)
    elif at > limit:
        return integer - 1
    return max(right, integer - 1)


def settle(pieces: list[Piece], limit: int) -> None:
    """Forget the stamps of what is known at a stamp, and join it."""
    gone = retract(pieces, (-FAR, FAR), limit)
    insert(pieces, gone)


def retract(pieces: list[Piece], on: Range, limit: int) -> list[Piece]:
    """Take out of a stretch what is not known at a stamp; of the rest forget the stamps.

    Args:
        pieces: changed in place.
        on: the stretch.
        limit: the stamp.

    Returns:
        What was taken out.
    """
    first, last = on
    if not pieces or pieces[-1][1] < first or pieces[0][0] > last:
        return []
    start, end = span(pieces, first, last)
    if start == end:
        return []
    kept: list[Piece] = []
    gone: list[Piece] = []
    behind: list[Piece] = []
    for left, right, at, slope in pieces[start:end]:
        if left < first:
            kept.append((left, first - 1, at, slope))
            left = first
        if right > last:
            behind.append((last + 1, right, at, slope))
            right = last
        known = right if at <= limit else left - 1
        if slope:
            known = min(right, (limit - at) // slope)
        append(kept, left, known, PAST, 0)
        append(gone, max(left, known + 1), right, at, slope)
    pieces[start:end] = kept + behind
    return gone


def insert(pieces: list[Piece], fresh: Pieces) -> None:
    """Add pieces in place, in order, that lie where there are none."""
    if not fresh:
        return
    if not pieces or pieces[-1][0] < fresh[0][0]:
        pieces.extend(fresh)
        return
    start = bisect_right(pieces, fresh[0][0], key=_left)
    if start == len(pieces) or fresh[-1][0] < pieces[start][0]:
        pieces[start:start] = fresh
    else:
        pieces[start:] = sorted([*pieces[start:], *fresh])


def gaps(known: Known, on: Range) -> list[Range]:
    """The parts of a stretch of which nothing is known."""
    found: list[Range] = []
    at, last = on
    held = [
        piece
        for pieces in known
        if pieces and pieces[-1][1] >= at
        for piece in pieces[slice(*span(pieces, at, last))]
    ]
    if not held:
        return [on]
    for left, right, _, _ in sorted(held):
        if at < left:
            found.append((at, left - 1))
        at = max(at, right + 1)
    if at <= last:
        found.append((at, last))
    return found


def some_before(known: Known, integer: int, count: int) -> int:
    """How far back from an integer at most so many pieces of each side reach, whole ones."""
    found = -FAR
    for pieces in known:
        index = bisect_right(pieces, integer, key=_left) - count
        if index >= 0:
            found = max(found, pieces[index][0])
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
