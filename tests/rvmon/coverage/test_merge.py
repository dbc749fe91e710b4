"""Merging databases is commutative, associative and idempotent."""

import random

import pytest
from tests.rvmon.coverage.merged import merged, random_database
from tests.tools.covered import dump

ORDERS = 80


@pytest.mark.slow
def test_merging_is_commutative_associative_and_idempotent():
    rng = random.Random(5)
    pools = []
    for pool in range(15):
        some = [random_database(10 * pool + one) for one in range(rng.randint(2, 4))]
        pools.append((some, dump(merged(some))))
    for _ in range(ORDERS):
        some, expected = rng.choice(pools)
        chosen = [*some, *rng.choices(some, k=rng.randint(0, 2))]
        rng.shuffle(chosen)
        at = rng.randint(0, len(chosen) - 1)
        together = merged([*chosen[:at], merged(chosen[at:])] if at else chosen)
        assert dump(together) == expected
        together.close()
