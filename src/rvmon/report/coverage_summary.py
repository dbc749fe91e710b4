"""The coverage figures shown by terminal, page and JSON, computed lazily; and the JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product
from math import prod
from typing import Any, NamedTuple

import numpy as np
from msgspec.structs import asdict
from numpy.typing import NDArray

from rvmon.coverage import (
    UNKNOWN,
    Coverage,
    Ending,
    Group,
    Hit,
    Hits,
    Item,
    TestRecord,
    combination,
)
from rvmon.coverage.analysis import Answers, Comparison, Step, compare
from rvmon.coverage.holes import Hole, hole_of, nearest_tests
from rvmon.coverage.ranking import Smallest, fewest, ranking
from rvmon.language.checked.properties import BinKind
from rvmon.language.rules.requirements import MOST_COMBINATIONS
from rvmon.report.verdict_table import RunGroup, VerdictTable
from rvmon.texts import counted
from rvmon.trace.time import format_stamped
from rvmon.verdicts import Verdict

LISTED = 5  # the most tests named among those that hit an item


class Grid(NamedTuple):
    """A cross as a table: bins of the last axis are columns, those of the other axes are rows."""

    down: Sequence[str]  # the axes of the rows
    across: str  # the axis of the columns
    columns: Sequence[str]  # its bins
    # for each row its bins, and its items with their places; `None`: the cross lacks the item
    rows: Sequence[tuple[tuple[str, ...], Sequence[tuple[int, Item] | None]]]


class Summary(Answers):
    """The answers about coverage, with names and texts for presentation."""

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
        """Whether there is nothing to cover, so that a share is meaningless."""
        groups = self.coverage.model.groups
        return not any(score.items for name, score in self.scores.items() if groups[name].weight)

    @cached_property
    def hole_texts(self) -> Mapping[int, Hole]:
        """The holes in words, by place."""
        model, items, counts = self.coverage.model, self.coverage.items, self.totals.counts
        hits = self._hits_at(np.flatnonzero(counts), counts[counts > 0])
        nearest = nearest_tests([items[place] for place in self.holes], self._hits, model)
        return {
            place: hole_of(items[place], model, hits, nearest.get(items[place], ""))
            for place in self.holes
        }

    @property
    def _hits(self) -> list[tuple[str, Hits]]:
        """The hits of each test, without tests that hit the same items as an earlier one."""
        hits_by_row: dict[bytes, tuple[str, Hits]] = {}
        for entry in self.coverage.entries:
            key = entry.row.items.tobytes()
            if key not in hits_by_row:
                hits = self._hits_at(entry.row.items, entry.row.counts)
                hits_by_row[key] = entry.record.name, hits
        return [*hits_by_row.values()]

    def _hits_at(self, places: NDArray[Any], counts: NDArray[Any]) -> Hits:
        """Hits by group and item."""
        hits: dict[str, dict[str, Hit]] = {}
        for place, count in zip(places.tolist(), counts.tolist(), strict=True):
            group, item = self.coverage.items[place]
            hits.setdefault(group, {})[item] = Hit(count)
        return hits

    @cached_property
    def unreachable(self) -> Mapping[str, Sequence[int]]:
        """The places of unreachable items, by reason."""
        places: dict[str, list[int]] = {}
        for place in np.flatnonzero(self.goals.unreachable).tolist():
            reasons = self.coverage.unreachable[self.coverage.items[place]]
            places.setdefault("; ".join(reasons), []).append(place)
        return places

    def kind(self, place: int, item: Item) -> BinKind:
        """The kind of an item; unreachable items count as ignored."""
        return BinKind.IGNORE if self.goals.unreachable[place] else item.kind

    def kind_text(self, place: int, item: Item) -> str:
        """The kind of an item that is no goal, in brackets; "" for a goal."""
        if self.goals.unreachable[place]:
            return " (cannot be hit)"
        return "" if item.kind is BinKind.GOAL else f" ({item.kind})"

    @cached_property
    def fewest(self) -> Smallest:
        """The smallest known set of tests with the same coverage."""
        return fewest(self)

    @cached_property
    def ranking(self) -> Sequence[Step]:
        """The tests of `fewest`, ordered by the items that each adds."""
        return ranking(self, self.fewest.places)

    def ranking_text(self) -> str:
        """The size of `fewest` in words, with its lower bound."""
        count, least = len(self.ranking), self.fewest.at_least
        suffice = "suffices" if count == 1 else "suffice"
        tests = counted(len(self.coverage.entries), "test")
        text = f"{count:,} of {tests} {suffice} for the same coverage"
        if least >= count:
            return f"{text}, the minimum"
        return f"{text}, at least {least:,} are needed" if least else text

    @cached_property
    def comparison(self) -> Comparison | None:
        """The comparison with the earlier coverage, if there is one."""
        return None if self._earlier is None else compare(self._earlier, self.coverage)

    def changes(self) -> list[tuple[str, Sequence[tuple[str, str]], Verdict]]:
        """Items that changed since the earlier coverage: heading, items, verdict for the colour."""
        if self.comparison is None:
            return []
        changes = (
            ("New illegal hits", self.comparison.illegal, Verdict.FAIL),
            ("Lost", self.comparison.lost, Verdict.INCONCLUSIVE),
            ("Newly covered", self.comparison.gained, Verdict.PASS),
            ("No longer in the model", self.comparison.dropped, Verdict.NOT_TRIGGERED),
        )
        return [change for change in changes if change[1]]

    @cached_property
    def first_hitters(self) -> Mapping[int, Sequence[int]]:
        """The first tests that hit each item."""
        return self.hitters(LISTED)

    @cached_property
    def alone(self) -> Mapping[str, Sequence[Step]]:
        """The growth of coverage by the tests of each strategy alone."""
        return {name: self.growth(order) for name, order in self.strategies.items()}

    @cached_property
    def not_fine(self) -> Sequence[int]:
        """The tests that failed unexpectedly or did not complete."""
        entries = self.coverage.entries
        return [place for place, entry in enumerate(entries) if not_fine(entry.record)]

    @cached_property
    def faults(self) -> Mapping[str, Sequence[int]]:
        """The tests by their fault in words, the most frequent fault first."""
        tests: dict[str, list[int]] = {}
        for place in self.not_fine:
            tests.setdefault(not_fine(self.record(place)), []).append(place)
        return dict(sorted(tests.items(), key=lambda fault: -len(fault[1])))

    @cached_property
    def known(self) -> Mapping[str, Sequence[int]]:
        """The tests by their expected failure, with its reason."""
        tests: dict[str, list[int]] = {}
        for place, entry in enumerate(self.coverage.entries):
            for name, reason in entry.record.failed_as_expected.items():
                tests.setdefault(f"{name}: {reason}", []).append(place)
        return tests

    @cached_property
    def starts(self) -> Mapping[str, int]:
        """The place of the first item of each group."""
        starts, place = {}, 0
        for group in self.coverage.model.groups.values():
            starts[group.name] = place
            place += len(group.items)
        return starts

    def verdicts(self) -> VerdictTable:
        """The numbers of tests by strategy, requirement and verdict."""
        counts: dict[str, dict[str, Counter[Verdict]]] = {}
        tests: Counter[str] = Counter()
        # Requirements of the model come first, in its order.
        judged = {name for entry in self.coverage.entries for name in entry.record.verdicts}
        names = {name: "" for name in self.coverage.model.groups if name in judged}
        for entry in self.coverage.entries:
            strategy = strategy_name(entry.record.strategy)
            tests[strategy] += 1
            for name, verdict in entry.record.verdicts.items():
                names[name] = ""
                by_verdict = counts.setdefault(strategy, {}).setdefault(name, Counter())
                by_verdict[verdict] += 1
        groups = tuple(RunGroup(name, count, counts.get(name, {})) for name, count in tests.items())
        return VerdictTable("", names, groups)

    def record(self, place: int) -> TestRecord:
        """A test."""
        return self.coverage.entries[place].record

    def places(self, group: Group) -> Iterator[tuple[int, Item]]:
        """The items of a group with their places."""
        return enumerate(group.items.values(), self.starts[group.name])

    def grid(self, group: Group) -> Grid:
        """A cross as a table."""
        *down, (across, columns) = group.axes.items()
        items = {item.name: (place, item) for place, item in self.places(group)}
        rows = [
            (bins, [items.get(combination([*bins, name])) for name in columns])
            for bins in product(*(names for _, names in down))
        ]
        return Grid([name for name, _ in down], across, columns, rows)

    def item_name(self, place: int) -> str:
        """The name of an item with its group."""
        return name_of(self.coverage.items[place])

    def hit_text(self, place: int) -> str:
        """The hits of an item in words, with the first test and instant."""
        totals = self.totals
        count, tests = int(totals.counts[place]), int(totals.tests[place])
        if not count:
            return "never hit"
        return (
            f"{counted(count, 'hit')} by {counted(tests, 'test')}, first {self.first_text(place)}"
        )

    def first_text(self, place: int) -> str:
        """The first test that hit an item, and the instant if known; "" if none did."""
        first = int(self.totals.first[place])
        if first < 0:
            return ""
        test, instant = self.record(first), int(self.totals.instants[place])
        when = "" if instant == UNKNOWN else f" at {format_stamped(instant, test.origin)}"
        return f"{test.name}{when}"

    def tests_text(self) -> str:
        """The number of tests and campaigns, and how the tests ended."""
        endings = Counter(entry.record.ending for entry in self.coverage.entries)
        ended = ", ".join(f"{endings[ending]:,} {ending}" for ending in Ending if endings[ending])
        parts = [counted(len(self.coverage.entries), "test")]
        if (campaigns := len(self.coverage.campaigns)) > 1:
            parts.append(f"of {campaigns} campaigns")
        return " ".join(parts) + (f": {ended}" if ended else "")


def name_of(item: tuple[str, str]) -> str:
    """The name of an item with its group.

    >>> name_of(("gaze", "yes"))
    'gaze: yes'
    """
    return f"{item[0]}: {item[1]}"


def strategy_name(strategy: str) -> str:
    """The name of a strategy for display."""
    return strategy or "no strategy"


def not_fine(record: TestRecord) -> str:
    """The fault of a test in words; "" if it has none."""
    parts = []
    if record.ending is not Ending.COMPLETED:
        parts.append(f"{record.ending}: {record.error}" if record.error else record.ending.value)
    if record.failed:
        parts.append(f"F {', '.join(record.failed)}")
    return "; ".join(parts)


def is_grid(group: Group) -> bool:
    """Whether a group is shown as a grid: a cross no larger than a specification allows.

    >>> from rvmon.coverage import Subject
    >>> is_grid(Group("g", Subject.CROSS, {}, axes={"x": ["a", "b"], "y": ["c"]}))
    True
    >>> is_grid(Group("g", Subject.CROSS, {}, axes=dict.fromkeys("vwxyz", ["a"] * 100)))
    False
    """
    return bool(group.axes) and 0 < prod(map(len, group.axes.values())) <= MOST_COMBINATIONS


def cell_look(kind: BinKind, goal: int, count: int) -> tuple[str, str]:
    """The cell of an item in a grid: its CSS class, and its hits, with the goal if too few.

    >>> cell_look(BinKind.GOAL, 1, 7), cell_look(BinKind.GOAL, 3, 1)
    (('covered', '7'), ('hole', '1/3'))
    >>> cell_look(BinKind.ILLEGAL, 1, 2), cell_look(BinKind.ILLEGAL, 1, 0)
    (('illegal hit', '2 !'), ('illegal', '!'))
    """
    match kind:
        case BinKind.IGNORE:
            return "ignored", "–"
        case BinKind.ILLEGAL:
            return ("illegal hit", f"{count:,} !") if count else ("illegal", "!")
        case BinKind.GOAL:
            text = f"{count:,}" if count >= goal or goal == 1 else f"{count:,}/{goal:,}"
            return "covered" if count >= goal else "hole", text


_OF_TEST = (
    "name campaign strategy recording seed system verdicts expected ending error seconds when"
)


def coverage_data(summary: Summary) -> dict[str, Any]:
    """The whole summary as JSON values."""
    coverage, compared = summary.coverage, summary.comparison
    records = [entry.record for entry in coverage.entries]
    return {
        "share": summary.share,
        "groups": [_group_data(summary, name) for name in coverage.model.groups],
        "holes": _item_names(summary, summary.holes),
        "illegal": _item_names(summary, summary.illegal),
        "tests": [
            {
                **{name: getattr(record, name) for name in _OF_TEST.split()},
                "added": _item_names(summary, step.added),
                "share": step.share,
                "only_by_it": _item_names(summary, only),
            }
            for record, step, only in zip(records, summary.steps, summary.unique, strict=True)
        ],
        "shortest_known_order": [
            {
                "test": step.entry,
                "name": records[step.entry].name,
                "added": _item_names(summary, step.added),
                "share": step.share,
            }
            for step in summary.ranking
        ],
        "compared": None
        if compared is None
        else {"with": summary.earlier_name, **asdict(compared)},
    }


def _group_data(summary: Summary, name: str) -> dict[str, Any]:
    group, score = summary.coverage.model.groups[name], summary.scores[name]
    return {
        "name": name,
        "title": group.title,
        "subject": group.subject,
        "weight": group.weight,
        "items": score.items,
        "covered": score.covered,
        "axes": group.axes,
        "bins": [
            {
                **{key: getattr(item, key) for key in ("name", "text", "kind", "goal")},
                "hits": int(summary.totals.counts[place]),
                "tests": int(summary.totals.tests[place]),
                "first": _first_data(summary, place),
                "reasons": summary.coverage.reasons.get((name, item.name), ()),
                "hole": summary.hole_texts.get(place),
                "unreachable": summary.coverage.unreachable.get((name, item.name), ()),
            }
            for place, item in summary.places(group)
        ],
    }


def _first_data(summary: Summary, place: int) -> dict[str, Any] | None:
    """The test that hit an item first (index and name), and the instant in ns."""
    entry = int(summary.totals.first[place])
    if entry < 0:
        return None
    instant = int(summary.totals.instants[place])
    return {
        "test": entry,
        "name": summary.record(entry).name,
        "at": None if instant == UNKNOWN else instant,
    }


def _item_names(summary: Summary, places: Iterable[int]) -> list[tuple[str, str]]:
    return [summary.coverage.items[place] for place in places]
