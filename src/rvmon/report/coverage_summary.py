"""What terminal, page and JSON show of coverage, each worked out when it is asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from math import prod

import numpy as np

from rvmon.coverage import UNKNOWN, Coverage, Ending, Group, Hit, Hits, Item, TestRecord
from rvmon.coverage.holes import Hole, hole_of, nearest_tests
from rvmon.coverage.questions import Answers, Comparison, Step, compare
from rvmon.coverage.ranking import Smallest, fewest, ranking
from rvmon.report.table import RunGroup, VerdictTable
from rvmon.spec.checked.goals import BinKind
from rvmon.spec.rules.properties import MOST_COMBINATIONS
from rvmon.texts import counted
from rvmon.trace.time import format_stamped
from rvmon.verdict import Verdict

LISTED = 5
"""Tests that are named of those that hit an item."""


class Summary(Answers):
    """Answers about coverage, as they are shown."""

    def __init__(
        self,
        name: str,
        coverage: Coverage,
        earlier: Coverage | None = None,
        earlier_name: str = "",
        pages: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(coverage)
        self.name = name
        self.earlier_name = earlier_name
        self.pages = pages or {}
        self._earlier = earlier

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to cover, so that a share says nothing."""
        groups = self.coverage.model.groups
        return not any(one.items for name, one in self.scores.items() if groups[name].weight)

    @cached_property
    def hole_texts(self) -> Mapping[int, Hole]:
        """Each hole in words."""
        model, items = self.coverage.model, self.coverage.items
        hits: dict[str, dict[str, Hit]] = {}
        for place in np.flatnonzero(self.totals.counts).tolist():
            group, item = items[place]
            hits.setdefault(group, {})[item] = Hit(int(self.totals.counts[place]))
        nearest = nearest_tests([items[place] for place in self.holes], self._hits, model)
        return {
            place: hole_of(items[place], model, hits, nearest.get(items[place], ""))
            for place in self.holes
        }

    @property
    def _hits(self) -> list[tuple[str, Hits]]:
        """What each test has hit; of tests that have hit the same, the first."""
        found: dict[bytes, tuple[str, Hits]] = {}
        for entry in self.coverage.entries:
            key = entry.row.items.tobytes()
            if key not in found:
                hits: dict[str, dict[str, Hit]] = {}
                row = zip(entry.row.items.tolist(), entry.row.counts.tolist(), strict=True)
                for place, count in row:
                    group, item = self.coverage.items[place]
                    hits.setdefault(group, {})[item] = Hit(count)
                found[key] = entry.record.name, hits
        return [*found.values()]

    @cached_property
    def unreachable(self) -> Mapping[str, Sequence[int]]:
        """Items that cannot be hit, by the reasons."""
        found: dict[str, list[int]] = {}
        for place in np.flatnonzero(self.goals.unreachable).tolist():
            reasons = self.coverage.unreachable[self.coverage.items[place]]
            found.setdefault("; ".join(reasons), []).append(place)
        return found

    def kind(self, place: int, item: Item) -> BinKind:
        """What a hit of an item means; what cannot be hit counts for nothing."""
        return BinKind.IGNORE if self.goals.unreachable[place] else item.kind

    def kind_text(self, place: int, item: Item) -> str:
        """Why an item is no goal, in brackets; empty if it is one."""
        if self.goals.unreachable[place]:
            return " (cannot be hit)"
        return "" if item.kind is BinKind.GOAL else f" ({item.kind})"

    @cached_property
    def fewest(self) -> Smallest:
        """The fewest tests known that cover as much."""
        return fewest(self)

    @cached_property
    def ranking(self) -> Sequence[Step]:
        """A short order of tests that cover as much."""
        return ranking(self, self.fewest.places)

    def ranking_text(self) -> str:
        """How many tests cover as much, and whether fewer might."""
        count, least = len(self.ranking), self.fewest.at_least
        text = f"{count:,} of {counted(len(self.coverage.entries), 'test')} cover the same"
        if least >= count:
            return f"{text}, no fewer do"
        return f"{text}, at least {least:,} are needed" if least else text

    @cached_property
    def comparison(self) -> Comparison | None:
        """What is different, if there is something to compare with."""
        return None if self._earlier is None else compare(self._earlier, self.coverage)

    @cached_property
    def first_hitters(self) -> Mapping[int, Sequence[int]]:
        """The first tests that hit each item."""
        return self.hitters(LISTED)

    @cached_property
    def campaigns(self) -> Sequence[str]:
        """Their names, in order."""
        return self.coverage.campaigns

    @cached_property
    def alone(self) -> Mapping[str, Sequence[Step]]:
        """What the tests of each strategy add to each other, without those of the others."""
        return {name: self.growth(order) for name, order in self.strategies.items()}

    @cached_property
    def not_fine(self) -> Sequence[int]:
        """Tests that failed a requirement that is not known to fail, or did not complete."""
        entries = self.coverage.entries
        return [place for place, entry in enumerate(entries) if not_fine(entry.record)]

    @cached_property
    def faults(self) -> Mapping[str, Sequence[int]]:
        """What was wrong, in words, with which tests; what most of them had stands first."""
        found: dict[str, list[int]] = {}
        for place in self.not_fine:
            found.setdefault(not_fine(self.record(place)), []).append(place)
        return dict(sorted(found.items(), key=lambda fault: -len(fault[1])))

    @cached_property
    def known(self) -> Mapping[str, Sequence[int]]:
        """What failed as expected, in words with the reason, and in which tests."""
        found: dict[str, list[int]] = {}
        for place, entry in enumerate(self.coverage.entries):
            for name, reason in entry.record.failed_as_expected.items():
                found.setdefault(f"{name}: {reason}", []).append(place)
        return found

    @cached_property
    def starts(self) -> Mapping[str, int]:
        """The place of the first item of each group."""
        starts, place = {}, 0
        for group in self.coverage.model.groups.values():
            starts[group.name] = place
            place += len(group.items)
        return starts

    def verdicts(self) -> VerdictTable:
        """Tests by strategy, requirement and verdict."""
        counts: dict[str, dict[str, Counter[Verdict]]] = {}
        tests: Counter[str] = Counter()
        # What the model knows stands in its order, as in the specification.
        judged = {name for entry in self.coverage.entries for name in entry.record.verdicts}
        names = {name: "" for name in self.coverage.model.groups if name in judged}
        for entry in self.coverage.entries:
            strategy = strategy_name(entry.record.strategy)
            tests[strategy] += 1
            for name, verdict in entry.record.verdicts.items():
                names[name] = ""
                own = counts.setdefault(strategy, {}).setdefault(name, Counter())
                own[verdict] += 1
        groups = tuple(RunGroup(name, count, counts.get(name, {})) for name, count in tests.items())
        return VerdictTable("", names, groups)

    def record(self, place: int) -> TestRecord:
        """A test."""
        return self.coverage.entries[place].record

    def places(self, group: Group) -> Iterator[tuple[int, Item]]:
        """The items of a group with their places."""
        return enumerate(group.items.values(), self.starts[group.name])

    def item_name(self, place: int) -> str:
        """An item for people, with its group."""
        return name_of(self.coverage.items[place])

    def hit_text(self, place: int) -> str:
        """How often an item was hit, by whom and when first."""
        found = self.totals
        count, tests = int(found.counts[place]), int(found.tests[place])
        if not count:
            return "never hit"
        return (
            f"{counted(count, 'hit')} by {counted(tests, 'test')}, first {self.first_text(place)}"
        )

    def first_text(self, place: int) -> str:
        """Which test hit an item first, and when if that is known; empty if none did."""
        first = int(self.totals.first[place])
        if first < 0:
            return ""
        test, instant = self.record(first), int(self.totals.instants[place])
        when = "" if instant == UNKNOWN else f" at {format_stamped(instant, test.origin)}"
        return f"{test.name}{when}"

    def tests_text(self) -> str:
        """How many tests there are, of how many campaigns, and how they ended."""
        endings = Counter(entry.record.ending for entry in self.coverage.entries)
        ended = ", ".join(f"{endings[one]:,} {one}" for one in Ending if endings[one])
        parts = [counted(len(self.coverage.entries), "test")]
        if len(self.campaigns) > 1:
            parts.append(f"of {len(self.campaigns)} campaigns")
        return " ".join(parts) + (f": {ended}" if ended else "")


def name_of(item: tuple[str, str]) -> str:
    """An item for people, with its group.

    >>> name_of(("gaze", "yes"))
    'gaze: yes'
    """
    return f"{item[0]}: {item[1]}"


def strategy_name(strategy: str) -> str:
    """A strategy for people."""
    return strategy or "no strategy"


def not_fine(record: TestRecord) -> str:
    """What is wrong with a test, in words; empty if nothing is."""
    parts = []
    if record.ending is not Ending.COMPLETED:
        parts.append(f"{record.ending}: {record.error}" if record.error else record.ending.value)
    if record.failed:
        parts.append(f"F {', '.join(record.failed)}")
    return "; ".join(parts)


def is_grid(group: Group) -> bool:
    """Whether a group is shown along its axes: a cross of the size that a specification may have.

    >>> from rvmon.coverage import Subject
    >>> is_grid(Group("g", Subject.CROSS, {}, axes={"x": ["a", "b"], "y": ["c"]}))
    True
    >>> is_grid(Group("g", Subject.CROSS, {}, axes=dict.fromkeys("vwxyz", ["a"] * 100)))
    False
    """
    return bool(group.axes) and 0 < prod(map(len, group.axes.values())) <= MOST_COMBINATIONS


def cell_text(kind: BinKind, goal: int, count: int) -> str:
    """An item in a grid: its hits, of how many where they are too few.

    >>> cell_text(BinKind.GOAL, 1, 7), cell_text(BinKind.GOAL, 3, 1)
    ('7', '1/3')
    >>> cell_text(BinKind.ILLEGAL, 1, 2), cell_text(BinKind.ILLEGAL, 1, 0)
    ('2 !', '!')
    """
    match kind:
        case BinKind.IGNORE:
            return "–"
        case BinKind.ILLEGAL:
            return f"{count:,} !" if count else "!"
        case BinKind.GOAL:
            return f"{count:,}" if count >= goal or goal == 1 else f"{count:,}/{goal:,}"
