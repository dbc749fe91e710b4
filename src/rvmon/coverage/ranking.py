"""A short order of tests that covers all that the whole campaign does."""

from __future__ import annotations

import heapq

import numpy as np

from rvmon.coverage.answers import Step
from rvmon.coverage.questions import goals_of, growth, totals
from rvmon.coverage.record import Coverage


def ranking(coverage: Coverage) -> list[Step]:
    """Tests that reach the coverage of all, the one that adds most first.

    At every step the test is taken that brings the items nearest to their goals, weighed as in the
    total; what no number of the tests reaches counts for nothing. The order is the shortest known,
    not always the shortest there is. A gain can only shrink as others are taken, so that most of
    them need not be worked out again.

    Source: Nemhauser, Wolsey, Fisher, "An analysis of approximations for maximizing submodular set
    functions", 1978; Minoux, "Accelerated greedy algorithms", 1978.
    """
    goals = goals_of(coverage)
    reached = goals.wanted & (totals(coverage).counts >= goals.goal)
    items = np.bincount(goals.group[goals.wanted], minlength=len(coverage.model.groups))
    weights = np.array([group.weight for group in coverage.model.groups.values()], np.int64)
    worth = np.where(reached, weights[goals.group] / np.maximum(items[goals.group], 1), 0.0)
    worth /= np.maximum(goals.goal, 1)
    left = np.where(reached, goals.goal, 0)

    def gain(place: int) -> float:
        row = coverage.entries[place].row
        return float(np.dot(np.minimum(row.counts, left[row.items]), worth[row.items]))

    queue = [(-gain(place), place) for place in range(len(coverage.entries))]
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
