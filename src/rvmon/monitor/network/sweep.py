"""`until` and `since` without bounds, by one pass over what is known of their operands."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rvmon.monitor.network.piecewise import (
    FAR,
    PAST,
    Line,
    Piece,
    Pieces,
    append,
    earliest,
    latest,
    stamp,
)

Known = tuple[Pieces, Pieces]
"""Where something is known to be true, and where to be false."""

Carried = tuple[bool, int] | None
"""What is known just outside of a stretch: the value and its stamp."""

_Side = tuple[bool, Line] | None
"""What is known of an operand all over a stretch."""


def until(left: Known, right: Known) -> Known:
    """`left U right` at all integers.

    U(i) = right(i) or (left(i) and U(i + 1)). As stamps do not fall within a stretch, its first
    position is the best witness it has, and its last one speaks for the way through it.

    Args:
        left: operand that has to hold on the way; known to at integers that are no positions.
        right: operand to be met; false at integers that are no positions.
    """
    found: list[Known] = []
    carried: Carried = None
    for first, last, stays, meets in reversed(list(_stretches(left, right))):
        true, false = _until_on(first, last, stays, meets, carried)
        found.append((true, false))
        carried = _value_at(first, true, false)
    return _joined(reversed(found))


def _until_on(first: int, last: int, stays: _Side, meets: _Side, beyond: Carried) -> Known:
    """`until` on a stretch on which neither operand changes."""
    true = _whole(first, last, meets, True)
    false: Pieces = ()
    if meets is not None and not meets[0]:
        false = latest(_whole(first, last, stays, False), _whole(first, last, meets, False))
    if beyond is not None:
        value, known = beyond
        side = stays if value else meets
        if side is not None and side[0] is value:
            way = ((first, last, max(_at(side[1], last), known), 0),)
            true, false = (earliest(true, way), false) if value else (true, earliest(false, way))
    return true, false


def since(left: Known, right: Known) -> Known:
    """`left S right` at all integers, false before all; the mirror image of `until`.

    Args:
        left: operand that has held ever since; known to at integers that are no positions.
        right: operand that was met; false at integers that are no positions.
    """
    found: list[Known] = []
    carried: Carried = (False, PAST)
    for first, last, stays, meets in _stretches(left, right):
        # True: met at the first position of the stretch or before, and so all the way since.
        # False: cut there or before, and not met all the way since.
        true = latest(_whole(first, last, stays, True), _from(first, last, meets, carried, True))
        true = earliest(true, _whole(first, last, meets, True))
        false = latest(_whole(first, last, meets, False), _from(first, last, stays, carried, False))
        found.append((true, false))
        carried = _value_at(last, true, false)
    return _joined(found)


def _whole(first: int, last: int, side: _Side, value: bool) -> Pieces:
    """Where a side has a value, in its stretch."""
    return ((first, last, *side[1]),) if side is not None and side[0] is value else ()


def _from(first: int, last: int, side: _Side, carried: Carried, value: bool) -> Pieces:
    """When a side had a value at the first position, or what was before had it."""
    stamps = []
    if side is not None and side[0] is value:
        stamps.append(_at(side[1], first))
    if carried is not None and carried[0] is value:
        stamps.append(carried[1])
    return ((first, last, min(stamps), 0),) if stamps else ()


def _at(line: Line, position: int) -> int:
    at, slope = line
    return at + slope * position if slope else at


def _value_at(position: int, true: Pieces, false: Pieces) -> Carried:
    if (found := stamp(true, position)) is not None:
        return True, found
    if (found := stamp(false, position)) is not None:
        return False, found
    return None


def _joined(parts: Iterable[Known]) -> Known:
    true: list[Piece] = []
    false: list[Piece] = []
    for its_true, its_false in parts:
        for piece in its_true:
            append(true, *piece)
        for piece in its_false:
            append(false, *piece)
    return true, false


def _stretches(left: Known, right: Known) -> Iterator[tuple[int, int, _Side, _Side]]:
    """What is known of both operands, in stretches on which neither changes."""
    ones, others = _sides(left), _sides(right)
    one, other = next(ones), next(others)
    first = -FAR
    while True:
        last = min(one[1], other[1])
        yield first, last, one[2], other[2]
        if last >= FAR:
            return
        first = last + 1
        if one[1] == last:
            one = next(ones)
        if other[1] == last:
            other = next(others)


def _sides(known: Known) -> Iterator[tuple[int, int, _Side]]:
    """An operand at all integers, without gaps."""
    at = -FAR
    sides = [
        (left, right, (value, (stamp_, slope)))
        for value, pieces in zip((True, False), known, strict=True)
        for left, right, stamp_, slope in pieces
    ]
    for left, right, side in sorted(sides):
        if left > at:
            yield at, left - 1, None
        yield left, right, side
        at = right + 1
    if at <= FAR:
        yield at, FAR, None
