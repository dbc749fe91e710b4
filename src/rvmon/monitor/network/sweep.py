"""Unbounded `until` and `since`, in one pass over the known values of their operands."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rvmon.monitor.network import piecewise as pw

Known = tuple[pw.Pieces, pw.Pieces]
"""The pieces on which a formula is known to be true, and those on which it is known to be false."""

Carried = tuple[bool, int] | None
"""The value at the neighbouring position outside a stretch, with its stamp; `None`: unknown."""

_Side = tuple[bool, pw.Line] | None
"""The value of an operand throughout a stretch, with its stamps; `None`: unknown."""


def until(left: Known, right: Known) -> Known:
    """`left U right` at all integers.

    U(i) = right(i) or (left(i) and U(i + 1)). Stamps do not decrease within a stretch, so its first
    position is the earliest witness, and its last one decides when a value passes through it.

    Args:
        left: the operand that has to hold until then; true at integers that are not positions.
        right: the operand to be met; false at integers that are not positions.
    """
    found: list[Known] = []
    carried: Carried = None
    # Backwards, as `until` depends on the next position; each stretch then needs only one value
    # from its right neighbour.
    for first, last, stays, meets in reversed(list(_stretches(left, right))):
        true, false = _until_on(first, last, stays, meets, carried)
        found.append((true, false))
        carried = _value_at(first, true, false)
    return _joined(reversed(found))


def _until_on(first: int, last: int, stays: _Side, meets: _Side, beyond: Carried) -> Known:
    """`until` on a stretch on which neither operand changes."""
    true = _whole(first, last, meets, True)
    false: pw.Pieces = ()
    # Where both are false, `until` is false whatever follows.
    if meets is not None and not meets[0]:
        false = pw.latest(_whole(first, last, stays, False), _whole(first, last, meets, False))
    if beyond is not None:
        value, known = beyond
        side = stays if value else meets
        if side is not None and side[0] is value:
            way = ((first, last, max(_at(side[1], last), known), 0),)
            true, false = (
                (pw.earliest(true, way), false) if value else (true, pw.earliest(false, way))
            )
    return true, false


def since(left: Known, right: Known) -> Known:
    """`left S right` at all integers, false before the first; the mirror image of `until`."""
    found: list[Known] = []
    carried: Carried = (False, pw.PAST)
    for first, last, stays, meets in _stretches(left, right):
        # True: right met at the first position of the stretch or before it, left true since.
        # False: left false there or before it, right not met since.
        true = pw.latest(_whole(first, last, stays, True), _from(first, last, meets, carried, True))
        true = pw.earliest(true, _whole(first, last, meets, True))
        false = pw.latest(
            _whole(first, last, meets, False), _from(first, last, stays, carried, False)
        )
        found.append((true, false))
        carried = _value_at(last, true, false)
    return _joined(found)


def _whole(first: int, last: int, side: _Side, value: bool) -> pw.Pieces:
    """A stretch as one piece if its side has this value; else nothing."""
    return ((first, last, *side[1]),) if side is not None and side[0] is value else ()


def _from(first: int, last: int, side: _Side, carried: Carried, value: bool) -> pw.Pieces:
    """A stretch with one stamp: that of the value at its first position, or carried from before."""
    stamps = []
    if side is not None and side[0] is value:
        stamps.append(_at(side[1], first))
    if carried is not None and carried[0] is value:
        stamps.append(carried[1])
    return ((first, last, min(stamps), 0),) if stamps else ()


def _at(line: pw.Line, position: int) -> int:
    at, slope = line
    return at + slope * position if slope else at


def _value_at(position: int, true: pw.Pieces, false: pw.Pieces) -> Carried:
    if (found := pw.stamp(true, position)) is not None:
        return True, found
    if (found := pw.stamp(false, position)) is not None:
        return False, found
    return None


def _joined(parts: Iterable[Known]) -> Known:
    true: list[pw.Piece] = []
    false: list[pw.Piece] = []
    for its_true, its_false in parts:
        for piece in its_true:
            pw.append(true, *piece)
        for piece in its_false:
            pw.append(false, *piece)
    return true, false


def _stretches(left: Known, right: Known) -> Iterator[tuple[int, int, _Side, _Side]]:
    """The values of both operands, in maximal stretches on which neither changes."""
    ones, others = _sides(left), _sides(right)
    one, other = next(ones), next(others)
    first = -pw.FAR
    while True:
        last = min(one[1], other[1])
        yield first, last, one[2], other[2]
        if last >= pw.FAR:
            return
        first = last + 1
        if one[1] == last:
            one = next(ones)
        if other[1] == last:
            other = next(others)


def _sides(known: Known) -> Iterator[tuple[int, int, _Side]]:
    """The value of an operand over all integers, in stretches without gaps."""
    at = -pw.FAR
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
    if at <= pw.FAR:
        yield at, pw.FAR, None
