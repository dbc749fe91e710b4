"""Ranges and stretches of known pieces, point by point."""

import random

import pytest

from rvmon.dataflow.piecewise import FAR, PAST, append
from rvmon.dataflow.ranges import (
    add,
    around,
    drop,
    gaps,
    last_up_to,
    merged,
    outside,
    overlapping,
    stretch,
    within,
)

LAST = 25


@pytest.mark.parametrize("seed", range(60))
def test_a_stretch_is_as_long_as_nothing_changes(seed):
    """All its integers are in the same pieces, and those beside it are not."""
    rng = random.Random(seed)
    known = ([], [])
    left = rng.randint(0, 5)
    while left <= LAST:
        right = left + rng.randint(0, 4)
        if rng.random() < 0.7:
            append(known[rng.random() < 0.5], left, right, rng.choice([PAST, 3, 8]), 0)
        left = right + 1

    def pieces_at(integer):
        return [[p for p in pieces if p[0] <= integer <= p[1]] for pieces in known]

    for integer in range(-3, LAST + 9):
        start, end = stretch(known, integer)
        inside = range(max(start, -9), min(end, LAST + 15) + 1)
        assert integer in inside
        assert all(pieces_at(one) == pieces_at(integer) for one in inside)
        assert start == -FAR or pieces_at(start - 1) != pieces_at(integer)
        assert end == FAR or pieces_at(end + 1) != pieces_at(integer)


def ranges_of(integers):
    """The same integers in ranges."""
    return merged((one, one) for one in integers)


@pytest.mark.parametrize("seed", range(100))
def test_ranges_are_sets(seed):
    """What is added is in them, what is dropped is not, and no two of them touch."""
    rng = random.Random(seed)
    ranges, expected = [], set()
    for _ in range(12):
        left = rng.randint(0, LAST)
        right = left + rng.randint(0, 3)
        inside = set(range(left, right + 1))
        if not inside & expected:
            add(ranges, left, right)
            expected |= inside
        assert ranges == ranges_of(expected)
    for integer in range(-2, LAST + 6):
        found = around(ranges, integer)
        assert (found in ranges) is (integer in expected)
        assert found is None or found[0] <= integer <= found[1]
        assert last_up_to(ranges, integer) == max(
            (one for one in expected if one <= integer), default=-FAR - 1
        )
    first = rng.randint(0, LAST)
    last = first + rng.randint(0, 6)
    on = set(range(first, last + 1))
    assert list(overlapping(ranges, first, last)) == [
        (left, right) for left, right in ranges if left <= last and right >= first
    ]
    assert gaps(ranges, (first, last)) == ranges_of(on - expected)
    pieces = ((first, last, 7, 2),)
    assert [piece[:2] for piece in within(pieces, ranges)] == ranges_of(on & expected)
    assert [piece[:2] for piece in outside(pieces, ranges)] == ranges_of(on - expected)
    assert all(piece[2:] == (7, 2) for piece in (*within(pieces, ranges), *outside(pieces, ranges)))
    kept = [(left, right) for left, right in ranges if right >= first]
    drop(ranges, first)
    assert ranges == kept
