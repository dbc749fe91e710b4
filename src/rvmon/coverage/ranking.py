"""A short order of tests that covers all that the whole campaign does."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from rvmon.coverage.answers import Step
from rvmon.coverage.questions import goals_of, growth, totals
from rvmon.coverage.record import Coverage
from rvmon.coverage.smallest import Smallest, smallest

MOST_TESTS = 1000
"""Tests among which the smallest choice is looked for."""


def fewest(coverage: Coverage) -> Smallest:
    """The fewest tests known that reach the coverage of all.

    Of many tests those of the ranking are taken, and how many are needed at least is left open.
    """
    if len(coverage.entries) > MOST_TESTS:
        return Smallest(tuple(step.entry for step in ranking(coverage)), 0)
    goals = goals_of(coverage)
    rows = [
        dict(zip(entry.row.items.tolist(), entry.row.counts.tolist(), strict=True))
        for entry in coverage.entries
    ]
    reached = np.flatnonzero(goals.wanted & (totals(coverage).counts >= goals.goal))
    return smallest(rows, {item: int(goals.goal[item]) for item in reached.tolist()})


def _weights(coverage: Coverage, items: NDArray[np.int64]) -> list[float]:
    """The weight of each group in the total: its part of its subject, which all count alike."""
    groups = [*coverage.model.groups.values()]
    whole: Counter[str] = Counter()
    for group, count in zip(groups, items, strict=True):
        whole[group.subject] += group.weight if count else 0
    return [group.weight / max(1, whole[group.subject]) for group in groups]


def ranking(coverage: Coverage, places: Collection[int] | None = None) -> list[Step]:
    """Tests that reach the coverage of all, the one that adds most first.

    At every step the test is taken that brings the items nearest to their goals, weighed as in the
    total; what no number of the tests reaches counts for nothing. A gain can only shrink as others
    are taken, so that most of them need not be worked out again.

    Args:
        coverage: with the tests.
        places: of those that may be taken, such as the fewest; default: all, of which those that
            are taken are not always the fewest.

    Source: Nemhauser, Wolsey, Fisher, "An analysis of approximations for maximizing submodular set
    functions", 1978; Minoux, "Accelerated greedy algorithms", 1978.
    """
    goals = goals_of(coverage)
    reached = goals.wanted & (totals(coverage).counts >= goals.goal)
    items = np.bincount(goals.group[goals.wanted], minlength=len(coverage.model.groups))
    weights = np.array(_weights(coverage, items))
    worth = np.where(reached, weights[goals.group] / np.maximum(items[goals.group], 1), 0.0)
    worth /= np.maximum(goals.goal, 1)
    left = np.where(reached, goals.goal, 0)

    def gain(place: int) -> float:
        row = coverage.entries[place].row
        return float(np.dot(np.minimum(row.counts, left[row.items]), worth[row.items]))

    queue = [
        (-gain(place), place)
        for place in (range(len(coverage.entries)) if places is None else places)
    ]
    heapq.heapify(queue)
    order = []
    while queue:
        _, place = heapq.heappop(queue)
        now = gain(place)
        if not now:
            continue
        if queue and (-now, place) > queue[0]:
            heapq.heappush(queue, (-now, place))
            continue
        order.append(place)
        row = coverage.entries[place].row
        left[row.items] -= np.minimum(row.counts, left[row.items])
    return growth(coverage, order)
