"""The algebra of pieces, and the two sweeps, against their definitions point by point."""

import random

import pytest

from rvmon.monitor.network.piecewise import (
    FAR,
    PAST,
    all_of_window,
    append,
    clip,
    earliest,
    latest,
    shift,
    some_of_window,
    stamp,
    up_to,
)
from rvmon.monitor.network.sweep import since, until

NEVER = 1 << 100
LAST = 25
CASES = range(60)


def random_known(rng):
    """Random intervals of true and of false on 0 … LAST, with gaps."""
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
    """The stamp of a position; later than all others if it is unknown."""
    found = stamp(pieces, position)
    return NEVER if found is None else found


@pytest.mark.slow
def test_points_and_windows():
    for seed in CASES:
        rng = random.Random(seed)
        one, other = random_known(rng)[0], random_known(rng)[0]
        low = rng.randint(-6, 4)
        high = low + rng.randint(0, 7)
        some, every = some_of_window(one, low, high), all_of_window(one, low, high)
        offset, first, last = rng.randint(-5, 5), rng.randint(0, 10), rng.randint(4, 20)
        assert all(left <= right for left, right, _, _ in clip(one, first, last))
        for i in range(-12, LAST + 12):
            assert at(earliest(one, other), i) == min(at(one, i), at(other, i))
            assert at(latest(one, other), i) == max(at(one, i), at(other, i))
            assert at(shift(one, offset), i) == at(one, i + offset)
            assert at(clip(one, first, last), i) == (at(one, i) if first <= i <= last else NEVER)
            assert at(up_to(one, 15), i) == (at(one, i) if at(one, i) <= 15 else NEVER)
            stamps = [at(one, j) for j in range(i + low, i + high + 1)]
            assert (at(some, i), at(every, i)) == (min(stamps), max(stamps))
    assert some_of_window(((0, 5, PAST, 0),), 3, 2) == ()
    assert at(all_of_window((), 3, 2), -FAR) == PAST


def step(left, right, k, true, false):
    """One step of `right or (left and next)` on the stamps of true and of false."""
    return (
        min(at(right[0], k), max(at(left[0], k), true)),
        max(at(right[1], k), min(at(left[1], k), false)),
    )


def test_sweeps():
    """`until` and `since` agree with their recursion; before the first position they are false."""
    for seed in CASES:
        rng = random.Random(seed)
        left, right = random_known(rng), random_known(rng)
        for known in (left, right)[: rng.randint(0, 2)]:
            for pieces in known:
                if pieces and pieces[0][0] == 0:
                    pieces[0] = (-FAR, pieces[0][1], PAST, 0)
        for sweep, order, value in (
            (until, range(LAST + 5, -6, -1), (NEVER, NEVER)),
            (since, range(-5, LAST + 6), (NEVER, PAST)),
        ):
            found = sweep(left, right)
            for i in order:
                value = step(left, right, i, *value)
                assert (at(found[0], i), at(found[1], i)) == value
