"""Stretches of known pieces, point by point."""

import random

import pytest

from rvmon.dataflow.piecewise import FAR, PAST, append
from rvmon.dataflow.ranges import stretch

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
