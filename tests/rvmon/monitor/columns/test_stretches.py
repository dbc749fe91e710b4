"""Sets of places as toggles: what they say of each single place."""

import numpy as np
import pytest

from rvmon.monitor.columns.stretches import (
    between,
    clipped,
    complement,
    holds_at,
    in_at_least,
    joined,
)

PLACES = np.arange(3, 30)


def random_set(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Truth values of the places, and the same as toggles."""
    truth = np.repeat(rng.random(27) < 0.5, rng.integers(1, 4, 27))[: len(PLACES)]
    steps = np.diff(truth.astype(int), prepend=0, append=0)
    return truth, np.flatnonzero(steps) + PLACES[0]


@pytest.mark.parametrize("seed", range(40))
def test_operators_do_place_by_place_what_they_say(seed):
    """Complement, union, intersection and clipping agree with truth values."""
    rng = np.random.default_rng(seed)
    sets = [random_set(rng) for _ in range(rng.integers(1, 4))]
    truths = np.array([truth for truth, _ in sets])
    toggles = [own for _, own in sets]
    start, stop = int(PLACES[0]), int(PLACES[-1]) + 1
    for count in range(1, len(sets) + 1):
        found = in_at_least(count, toggles)
        assert (holds_at(found, PLACES) == (truths.sum(0) >= count)).all()
        assert (np.diff(found) > 0).all()
        assert len(found) % 2 == 0
    assert (holds_at(complement(toggles[0], start, stop), PLACES) == ~truths[0]).all()
    low, high = sorted(rng.integers(start, stop, 2).tolist())
    inside = (low <= PLACES) & (high > PLACES)
    assert (holds_at(clipped(toggles[0], low, high), PLACES) == (truths[0] & inside)).all()
    assert (holds_at(between(low, high), PLACES) == inside).all()


def test_stretches_that_touch_are_one():
    """What ascends is joined, whether it overlaps or only meets."""
    assert joined(np.array([0, 3, 9]), np.array([3, 5, 12])).tolist() == [0, 5, 9, 12]
