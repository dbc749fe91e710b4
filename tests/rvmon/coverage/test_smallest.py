"""The smallest set of tests that covers as much as all."""

import random
from itertools import combinations

from rvmon.coverage.ranking import smallest


def needed(rows, goals):
    """The hits of all tests together."""
    total = {}
    for row in rows:
        for item, count in row.items():
            total[item] = min(total.get(item, 0) + count, goals.get(item, 0))
    return {item: count for item, count in total.items() if count}


def reaches(rows, places, wanted):
    """Whether some of the tests hit as much as all."""
    return all(sum(rows[at].get(item, 0) for at in places) >= wanted[item] for item in wanted)


def test_no_choice_has_fewer():
    for seed in range(100):
        rng = random.Random(seed)
        items = range(rng.randint(1, 8))
        rows = [
            {item: rng.randint(1, 3) for item in items if rng.random() < 0.4}
            for _ in range(rng.randint(0, 9))
        ]
        goals = {item: rng.randint(0, 4) for item in items if rng.random() < 0.9}
        wanted = needed(rows, goals)
        found = smallest(rows, goals)
        assert reaches(rows, found.places, wanted)
        least = next(
            size
            for size in range(len(rows) + 1)
            if any(reaches(rows, places, wanted) for places in combinations(range(len(rows)), size))
        )
        assert found.at_least == len(found.places) == least


def test_a_search_that_is_cut_short_says_so():
    rng = random.Random(1)
    rows = [{item: 1 for item in range(60) if rng.random() < 0.1} for _ in range(60)]
    goals = dict.fromkeys(range(60), 1)
    short, whole = smallest(rows, goals, 10), smallest(rows, goals)
    assert reaches(rows, short.places, needed(rows, goals))
    assert short.at_least <= whole.at_least <= len(whole.places) <= len(short.places)
    assert short.at_least < len(short.places)
