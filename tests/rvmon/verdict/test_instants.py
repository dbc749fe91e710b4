"""Arrays of instants as text, against those of single ones."""

import random

import numpy as np
import pytest

from rvmon.trace.time import TIME_LIMIT, format_ticks
from rvmon.verdict.instants import formatted, seconds_of

EDGES = (0, 1, 999, 1_000, 9_999, 10_000, 10**9, 10**9 + 10, (1 << 53) - 1, 1 << 53)
LONG = 8_388_608 * 10**9


@pytest.mark.parametrize("seed", range(5))
def test_as_one_by_one(seed):
    """The same texts and the same floats, of all magnitudes and signs."""
    rng = random.Random(seed)
    ticks = [rng.randrange(TIME_LIMIT) >> rng.randrange(62) for _ in range(2_000)]
    ticks += [LONG - rng.randrange(1, 10**9) for _ in range(500)]
    ticks += [near + by for near in (*EDGES, LONG) for by in (-1, 0, 1)]
    ticks += [-one for one in ticks]
    origin = rng.choice([0, -5, 1_700_000_000 * 10**9])
    array = np.array(ticks)
    assert formatted(array) == [format_ticks(one) for one in ticks]
    for some in (ticks, [one for one in ticks if abs(one - origin) < 1 << 53]):
        assert seconds_of(np.array(some), origin) == [(one - origin) / 10**9 for one in some]


def test_none():
    """No instants have no texts."""
    assert formatted(np.array([], np.int64)) == []
    assert seconds_of(np.array([], np.int64), 0) == []
