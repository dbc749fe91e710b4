"""Short orders of tests that cover all that a campaign does, and the fewest that do."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rvmon.coverage import Coverage
from rvmon.coverage.questions import Answers, Step

MOST_NODES = 20_000
"""Partial choices that are looked at, about a second's worth."""

MOST_COMPARED = 500
"""Tests up to which each is compared with each."""


@dataclass(frozen=True, slots=True)
class Smallest:
    """A choice of tests.

    Attributes:
        places: of the tests, ascending.
        at_least: no choice has fewer; the number of `places` if it is known to be the smallest.
    """

    places: tuple[int, ...]
    at_least: int


def smallest(
    rows: Sequence[Mapping[int, int]], goals: Mapping[int, int], most_nodes: int = MOST_NODES
) -> Smallest:
    """Choose the fewest tests that hit items as often as all of them do, up to their goals.

    Branch and bound: the item that the fewest tests hit is given to each of them in turn. A choice
    is left once items that no test shares ask for as many tests as the best one known has. If that
    takes too many steps, the best choice so far and what is known about the least number are given.

    Args:
        rows: by test, how often it hits items.
        goals: hits that each item needs; others count for nothing.
        most_nodes: partial choices that are looked at.

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
    """Tests without those that are needless beside another one, which alone does as they do."""
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
    """Items without those that are hit whenever a scarcer one is."""
    hitters = _hitters(rows)
    kept: dict[int, int] = {}
    for item in sorted(needed, key=lambda one: (hitters[one].bit_count(), one)):
        own = hitters[item]
        if needed[item] > 1 or not any(hitters[one] & own == hitters[one] for one in kept):
            kept[item] = needed[item]
    return kept


def _hitters(rows: Mapping[int, dict[int, int]]) -> dict[int, int]:
    """By item, the tests that hit it, as bits of a number."""
    found: dict[int, int] = {}
    for place, row in rows.items():
        for item in row:
            found[item] = found.get(item, 0) | 1 << place
    return found


class _Search:
    """Branch and bound; sets of tests are bits of a number."""

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
        """Whether there were too many choices."""
        return self._left <= 0

    def greedy(self, needed: Mapping[int, int]) -> None:
        """A first choice: the test that adds most, again and again."""
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
        """At least so many further tests: for items of which no test hits two."""
        used, count = 0, 0
        for item in sorted(needed, key=lambda one: (self._hitters[one] & ~refused).bit_count()):
            hitters = self._hitters[item] & ~refused
            if not hitters & used:
                used |= hitters
                count += -(-needed[item] // self._most[item])
        return count

    def branch(self, needed: Mapping[int, int], chosen: list[int], refused: int) -> None:
        """Try all choices that go on from one and may be better than the best."""
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
            refused |= 1 << place
            self.branch(_without(needed, self._rows[place]), [*chosen, place], refused)


def _gain(row: Mapping[int, int], needed: Mapping[int, int]) -> int:
    return sum(min(count, needed[item]) for item, count in row.items() if item in needed)


def _without(needed: Mapping[int, int], row: Mapping[int, int]) -> dict[int, int]:
    """What is still needed behind a test."""
    return {item: left for item, count in needed.items() if (left := count - row.get(item, 0)) > 0}


MOST_TESTS = 1000
"""Tests among which the smallest choice is looked for."""


def fewest(answers: Answers) -> Smallest:
    """The fewest tests known that reach the coverage of all.

    Of many tests those of the ranking are taken, and how many are needed at least is left open.
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


def _weights(coverage: Coverage, items: NDArray[np.int64]) -> list[float]:
    """The weight of each group in the total: its part of its subject, which all count alike."""
    groups = [*coverage.model.groups.values()]
    whole: Counter[str] = Counter()
    for group, count in zip(groups, items, strict=True):
        whole[group.subject] += group.weight if count else 0
    return [group.weight / max(1, whole[group.subject]) for group in groups]


def ranking(answers: Answers, places: Collection[int] | None = None) -> list[Step]:
    """Tests that reach the coverage of all, the one that adds most first.

    At every step the test is taken that brings the items nearest to their goals, weighed as in the
    total; what no number of the tests reaches counts for nothing. A gain can only shrink as others
    are taken, so that most of them need not be worked out again.

    Args:
        answers: about the tests.
        places: of those that may be taken, such as the fewest; default: all, of which those that
            are taken are not always the fewest.

    Source: Nemhauser, Wolsey, Fisher, "An analysis of approximations for maximizing submodular set
    functions", 1978; Minoux, "Accelerated greedy algorithms", 1978.
    """
    coverage, goals, reached = answers.coverage, answers.goals, answers.covered
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
    return answers.growth(order)
