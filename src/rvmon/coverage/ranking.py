"""Small sets and short orders of tests that reach the coverage of a whole campaign."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from msgspec import Struct

from rvmon.coverage.analysis import Answers, Step

MOST_NODES = 20_000  # the most nodes of the search tree, about a second's worth
MOST_COMPARED = 500  # the most tests for which all pairs are compared for dominance


class Smallest(Struct, frozen=True):
    """A small set of tests."""

    places: tuple[int, ...]  # the indices of the tests, ascending
    at_least: int  # a lower bound; equal to the size of `places` if that is proved minimal


def smallest(
    rows: Sequence[Mapping[int, int]], goals: Mapping[int, int], most_nodes: int = MOST_NODES
) -> Smallest:
    """A smallest set of tests that reaches the same goals as all tests: a set multicover problem.

    It is found by branch and bound, branching over the tests that hit the scarcest item. The lower
    bound adds up items of which no test hits two. If the search exceeds its limit, the best set so
    far is returned with the lower bound at the root.

    Args:
        rows: per test, its hits by item.
        goals: the hits that each item needs; other items are ignored.
        most_nodes: the most nodes of the search tree.

    Source: Garfinkel and Nemhauser, The Set-Partitioning Problem: Set Covering with Equality
    Constraints, Operations Research 17, 1969 (dominance, branching on the scarcest row); Chvátal, A
    Greedy Heuristic for the Set-Covering Problem, 1979 (the first choice).

    >>> smallest([{1: 1, 2: 1, 3: 1}, {1: 1, 2: 1, 4: 1}, {3: 1, 4: 1}], dict.fromkeys(range(5), 1))
    Smallest(places=(0, 1), at_least=2)
    """
    total: dict[int, int] = {}
    for row in rows:
        for item, count in row.items():
            total[item] = min(total.get(item, 0) + count, goals.get(item, 0))
    needed = {item: count for item, count in total.items() if count}
    kept: dict[int, dict[int, int]] = {
        place: {item: min(count, needed[item]) for item, count in row.items() if item in needed}
        for place, row in enumerate(rows)
    }
    while True:
        kept = _undominated(kept, needed)
        fewer = _scarce(kept, needed)
        if len(fewer) == len(needed):
            break
        needed = fewer
        kept = {
            place: {item: count for item, count in row.items() if item in needed}
            for place, row in kept.items()
        }
    search = _Search(kept, most_nodes)
    search.greedy(needed)
    at_least = search.bound(needed, 0)
    search.branch(needed, [], 0)
    best = tuple(sorted(search.best))
    return Smallest(best, at_least if search.stopped else len(best))


def _undominated(
    rows: Mapping[int, dict[int, int]], needed: Mapping[int, int]
) -> dict[int, dict[int, int]]:
    """The tests without dominated ones, all of whose items another test alone brings to goals."""
    kept: dict[int, dict[int, int]] = {}
    seen: set[frozenset[int]] = set()
    for place, row in rows.items():
        suffices = all(count == needed[item] for item, count in row.items())
        key = frozenset(row)
        if row and not (suffices and key in seen):
            kept[place] = row
            if suffices:
                seen.add(key)
    if len(kept) > MOST_COMPARED:
        return kept
    # Equal tests would remove each other here, so only one of them was kept above.
    enough = {
        place: frozenset(item for item, count in row.items() if count == needed[item])
        for place, row in kept.items()
    }
    return {
        place: row
        for place, row in kept.items()
        if not any(other != place and row.keys() <= alone for other, alone in enough.items())
    }


def _scarce(rows: Mapping[int, dict[int, int]], needed: Mapping[int, int]) -> dict[int, int]:
    """The items without dominated ones, which are hit by all tests that hit some scarcer item."""
    hitters = _hitters(rows)
    kept: dict[int, int] = {}
    for item in sorted(needed, key=lambda one: (hitters[one].bit_count(), one)):
        item_hitters = hitters[item]
        # Reaching a scarcer item once does not reach a goal of several hits.
        if needed[item] > 1 or not any(hitters[one] & item_hitters == hitters[one] for one in kept):
            kept[item] = needed[item]
    return kept


def _hitters(rows: Mapping[int, dict[int, int]]) -> dict[int, int]:
    """The set of tests that hit each item, as bits of an integer."""
    hitters: dict[int, int] = {}
    for place, row in rows.items():
        for item in row:
            hitters[item] = hitters.get(item, 0) | 1 << place
    return hitters


class _Search:
    """Branch and bound; sets of tests are bits of an integer."""

    def __init__(self, rows: Mapping[int, dict[int, int]], most_nodes: int) -> None:
        self._rows = rows
        self._left = most_nodes
        self._hitters = _hitters(rows)
        self._most: dict[int, int] = {}
        for row in rows.values():
            for item, count in row.items():
                self._most[item] = max(self._most.get(item, 0), count)
        self.best: list[int] = []

    @property
    def stopped(self) -> bool:
        """Whether the limit of nodes was reached."""
        return self._left <= 0

    def greedy(self, needed: Mapping[int, int]) -> None:
        """Find the initial solution by repeatedly taking the test that adds most."""
        while needed:
            gains = {
                place: _gain(row, needed)
                for place, row in self._rows.items()
                if place not in self.best
            }
            place = max(gains, key=lambda one: (gains[one], -one))
            self.best.append(place)
            needed = _without(needed, self._rows[place])

    def bound(self, needed: Mapping[int, int], refused: int) -> int:
        """A lower bound on further tests: the sum over items of which no test hits two.

        `refused` is a set of tests that are not used.
        """
        used, count = 0, 0
        for item in sorted(needed, key=lambda one: (self._hitters[one] & ~refused).bit_count()):
            hitters = self._hitters[item] & ~refused
            if not hitters & used:
                used |= hitters
                count += -(-needed[item] // self._most[item])
        return count

    def branch(self, needed: Mapping[int, int], chosen: list[int], refused: int) -> None:
        """Search the extensions of a partial solution that may improve on the best one."""
        if not needed:
            if len(chosen) < len(self.best):
                self.best = chosen
            return
        self._left -= 1
        if self.stopped or len(chosen) + self.bound(needed, refused) >= len(self.best):
            return
        scarce = min(needed, key=lambda one: ((self._hitters[one] & ~refused).bit_count(), one))
        free = self._hitters[scarce] & ~refused
        places = [place for place in self._rows if free >> place & 1]
        places.sort(key=lambda place: (-_gain(self._rows[place], needed), place))
        for place in places:
            # The next line searches all sets with this test; the rest of the loop searches those
            # without.
            refused |= 1 << place
            self.branch(_without(needed, self._rows[place]), [*chosen, place], refused)


def _gain(row: Mapping[int, int], needed: Mapping[int, int]) -> int:
    return sum(min(count, needed[item]) for item, count in row.items() if item in needed)


def _without(needed: Mapping[int, int], row: Mapping[int, int]) -> dict[int, int]:
    """The hits still needed after a test."""
    return {item: left for item, count in needed.items() if (left := count - row.get(item, 0)) > 0}


MOST_TESTS = 1000  # the most tests for which a smallest set is searched


def fewest(answers: Answers) -> Smallest:
    """The smallest known set of tests that reaches the coverage of all.

    For many tests it is the greedy ranking, without a lower bound.
    """
    entries = answers.coverage.entries
    if len(entries) > MOST_TESTS:
        return Smallest(tuple(step.entry for step in ranking(answers)), 0)
    rows = [
        dict(zip(entry.row.items.tolist(), entry.row.counts.tolist(), strict=True))
        for entry in entries
    ]
    reached = np.flatnonzero(answers.covered).tolist()
    return smallest(rows, {item: int(answers.goals.goal[item]) for item in reached})


def ranking(answers: Answers, places: Collection[int] | None = None) -> list[Step]:
    """A greedy order of tests that reaches the coverage of all.

    Each step takes the test with the largest gain towards reachable goals, weighted as in the
    total. As gains are submodular, they only shrink, so they are re-evaluated lazily.

    Args:
        answers: about the tests.
        places: indices of the tests to order, such as those of `fewest`; default: all.

    Source: Nemhauser, Wolsey, Fisher, "An analysis of approximations for maximizing submodular set
    functions", 1978; Minoux, "Accelerated greedy algorithms", 1978.
    """
    coverage, goals, reached = answers.coverage, answers.goals, answers.covered
    groups = [*coverage.model.groups.values()]
    items = np.bincount(goals.group[goals.wanted], minlength=len(groups))
    # The weight of each group in the total, relative to its subject; see `weighted`.
    whole: Counter[str] = Counter()
    for group, count in zip(groups, items, strict=True):
        whole[group.subject] += group.weight if count else 0
    weights = np.array([group.weight / max(1, whole[group.subject]) for group in groups])
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
    return answers.growth(order)
