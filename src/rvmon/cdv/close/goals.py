"""What is to be shown, what of it was, and what cannot be."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.coverage.holes import Goal, Hole, hole_of, nearest_tests
from rvmon.coverage.model import Hits, Model, merged, share, without
from rvmon.spec.checked.goals import BinKind


class Goals:
    """The items of a coverage model that are to be hit, and how often they were.

    Args:
        model: what there is to be covered.
        argued: why some of it cannot be, by item.

    Attributes:
        model: as it was given.
        wanted: how often each item is to be hit.
        proved: the query that proves an item to be unreachable, by item.
        argued: as it was given.
        wrong: unreachable items that were hit all the same, with the test that hit them first.
    """

    def __init__(self, model: Model, argued: Mapping[Goal, str]) -> None:
        self.model = model
        self.wanted: dict[Goal, int] = {
            (group.name, item.name): item.goal
            for group in model.groups.values()
            if group.weight
            for item in group.items.values()
            if item.kind is BinKind.GOAL
        }
        self.argued = {goal: why for goal, why in argued.items() if goal in self.wanted}
        self.proved: dict[Goal, str] = {}
        self.wrong: dict[Goal, str] = {}
        self._seen: list[tuple[str, Hits]] = []
        self._counts: dict[Goal, int] = {}

    @property
    def sought(self) -> dict[Goal, int]:
        """How often each item is to be hit of those that can be, as far as anybody knows."""
        return {goal: count for goal, count in self.wanted.items() if not self._is_out(goal)}

    @property
    def open(self) -> list[Goal]:
        """What is sought and was not hit as often as it is to be; in the model's order."""
        return [goal for goal in self.sought if not self.is_met(goal)]

    @property
    def met(self) -> int:
        """How many of those that are sought were."""
        return sum(map(self.is_met, self.sought))

    def is_met(self, goal: Goal) -> bool:
        """Whether an item was hit as often as it is to be."""
        return self._counts.get(goal, 0) >= self.wanted[goal]

    @property
    def share(self) -> float:
        """The share of the model that is covered, from 0 to 1, without what cannot be."""
        hits = merged(found for _, found in self._seen)
        return share(hits, without(self.model, [*self.proved, *self.argued]))

    def holes(self) -> dict[Goal, Hole]:
        """What is open, in words."""
        hits = merged(found for _, found in self._seen)
        nearest = nearest_tests(self.open, self._seen, self.model)
        return {goal: hole_of(goal, self.model, hits, nearest.get(goal, "")) for goal in self.open}

    def _is_out(self, goal: Goal) -> bool:
        """Whether an item cannot be hit, as it is proved or declared."""
        return goal in self.proved or goal in self.argued

    def add(self, test: str, hits: Hits) -> list[Goal]:
        """Count what a test hit, and return what was met with it for the first time."""
        added = []
        self._seen.append((test, hits))
        for group, items in hits.items():
            for item, hit in items.items():
                goal = group, item
                if goal not in self.wanted:
                    continue
                before = self.is_met(goal)
                self._counts[goal] = self._counts.get(goal, 0) + hit.count
                if self._is_out(goal):
                    self.wrong.setdefault(goal, test)
                elif self.is_met(goal) and not before:
                    added.append(goal)
        return added
