"""The algebra of pieces, and the two sweeps, against their definitions point by point."""

import random

import pytest

from rvmon.dataflow.piecewise import (
    FAR,
    PAST,
    all_of_window,
    append,
    as_past,
    clip,
    latest,
    shift,
    some_of_window,
    soonest,
    stamp,
    up_to,
    without,
)
from rvmon.dataflow.ranges import end_of, gaps, holds, insert, retract, settle
from rvmon.dataflow.sweep import since, until

NEVER = 1 << 100
LAST = 25
CASES = range(150)


def random_known(rng):
    """Where something is true and where false, on 0 … LAST, with gaps."""
    true, false = [], []
    left = 0
    while left <= LAST:
        right = min(LAST, left + rng.randint(0, 4))
        line = rng.choice([(PAST, 0), (rng.randint(-10, 30), 0), (rng.choice([1, 4, 9]), 2)])
        kind = rng.random()
        if kind < 0.8:
            append(true if kind < 0.4 else false, left, right, *line)
        left = right + 1
    return true, false


def at(pieces, position):
    """The stamp of a position; later than all if it is not known."""
    found = stamp(pieces, position)
    return NEVER if found is None else found


@pytest.mark.parametrize("seed", CASES)
def test_points(seed):
    """Minima, maxima, shifts and limits are what they are at each position."""
    rng = random.Random(seed)
    one, other = random_known(rng)[0], random_known(rng)[0]
    offset, first, last = rng.randint(-5, 5), rng.randint(0, 10), rng.randint(4, 20)
    assert all(left <= right for left, right, _, _ in clip(one, first, last))
    for i in range(-8, LAST + 9):
        assert at(soonest(one, other), i) == min(at(one, i), at(other, i))
        assert at(latest(one, other), i) == max(at(one, i), at(other, i))
        assert at(shift(one, offset), i) == at(one, i + offset)
        assert at(clip(one, first, last), i) == (at(one, i) if first <= i <= last else NEVER)
        assert at(up_to(one, 15), i) == (at(one, i) if at(one, i) <= 15 else NEVER)
        assert at(as_past(one), i) == (PAST if at(one, i) < NEVER else NEVER)
        fresh = without(one, other)
        assert at(fresh, i) == (at(one, i) if at(other, i) == NEVER else NEVER)


@pytest.mark.parametrize("seed", CASES)
def test_what_is_known_stays_and_the_rest_is_taken_out(seed):
    """Of a stretch what is not known at a stamp goes, and can be put back; the rest is settled."""
    rng = random.Random(seed)
    known = random_known(rng)
    first, last, limit = rng.randint(-2, 10), rng.randint(10, LAST + 2), rng.randint(-5, 40)
    left = [list(side) for side in known]
    gone = [retract(side, (first, last), limit) for side in left]
    free = gaps(left, (first, last))
    for side, own, out in zip(left, known, gone, strict=True):
        back = list(side)
        insert(back, out)
        settled = list(own)
        settle(settled, limit)
        for i in range(-8, LAST + 9):
            before = at(own, i)
            inside = first <= i <= last
            after = PAST if inside and before <= limit else before
            assert at(side, i) == (NEVER if inside and before > limit else after)
            assert at(back, i) == after
            assert at(settled, i) == (PAST if before <= limit else before)
            end = end_of(own, i, limit)
            assert (end >= i) is (before <= limit)
            assert all(at(own, k) <= limit for k in range(i, end + 1))
    for i in range(first, last + 1):
        assert holds(free, i) is all(at(side, i) == NEVER for side in left)


@pytest.mark.parametrize("seed", CASES)
def test_windows(seed):
    """A window knows of some as of the first, of all as of the last."""
    rng = random.Random(seed)
    pieces = random_known(rng)[0]
    low = rng.randint(-6, 4)
    high = low + rng.randint(0, 7)
    some, every = some_of_window(pieces, low, high), all_of_window(pieces, low, high)
    for i in range(-12, LAST + 12):
        stamps = [at(pieces, j) for j in range(i + low, i + high + 1)]
        assert at(some, i) == min(stamps)
        assert at(every, i) == max(stamps)


def test_an_empty_window():
    """Of nothing, none is known and all are."""
    assert some_of_window(((0, 5, PAST, 0),), 3, 2) == ()
    assert at(all_of_window((), 3, 2), -FAR) == PAST


def step(left, right, k, true, false):
    """Right or (left and what comes next), of the stamps of true and of false."""
    return (
        min(at(right[0], k), max(at(left[0], k), true)),
        max(at(right[1], k), min(at(left[1], k), false)),
    )


@pytest.mark.parametrize("seed", CASES)
def test_sweeps(seed):
    """`until` and `since` are what their recursion gives, on any stretch, from any edge."""
    rng = random.Random(seed)
    left, right = random_known(rng), random_known(rng)
    edge = rng.choice([None, (True, 12), (False, 7), (False, PAST)])
    first, last = rng.randint(0, 8), rng.randint(10, LAST)
    outside = (
        edge[1] if edge and edge[0] else NEVER,
        edge[1] if edge and not edge[0] else NEVER,
    )
    for sweep, order in (
        (until, range(last, first - 1, -1)),
        (since, range(first, last + 1)),
    ):
        found = sweep(left, right, first, last, edge)
        value = outside
        for i in order:
            value = step(left, right, i, *value)
            assert (at(found[0], i), at(found[1], i)) == value
