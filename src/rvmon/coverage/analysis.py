"""Analysis of coverage: hits, holes, the contribution of each test, comparisons."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from rvmon.coverage import UNKNOWN, Coverage, Score, TestRecord, weighted
from rvmon.language.checked.properties import BinKind
from rvmon.verdicts import Verdict


class Goals(Struct, frozen=True, eq=False):
    """The goals of all items, as arrays by item."""

    goal: NDArray[np.int64]  # the number of hits it needs
    wanted: NDArray[np.bool_]  # whether it is a reachable goal and so counts
    unreachable: NDArray[np.bool_]  # whether it is a goal that cannot be hit
    illegal: NDArray[np.bool_]  # whether a hit is an error
    group: NDArray[np.int64]  # the index of its group in the model


class Totals(Struct, frozen=True, eq=False):
    """The hits of all items over all tests, as arrays by item."""

    counts: NDArray[np.int64]  # the number of hits
    tests: NDArray[np.int64]  # the number of tests that hit it
    first: NDArray[np.int64]  # the first test that hit it; −1 if none
    instants: NDArray[np.int64]  # the instant of the first hit in that test, ticks, or `UNKNOWN`


class Step(Struct, frozen=True):
    """The contribution of a test after those before it."""

    entry: int  # the test
    added: Sequence[int]  # the items that reached their goals with it
    share: float  # the covered share of the model with it, from 0 to 1


class VerdictChange(Struct, frozen=True):
    """A changed verdict of a requirement on the same test."""

    test: str  # the name of the test
    requirement: str  # the id of the requirement
    before: Verdict | None  # the earlier verdict; `None` if it was not judged
    after: Verdict | None  # the later verdict; `None` if it was not judged


class Comparison(Struct, frozen=True):
    """The differences from an earlier campaign."""

    before: float  # the earlier covered share, from 0 to 1
    after: float  # the covered share now
    gained: Sequence[tuple[str, str]]  # items newly covered, by group and name
    lost: Sequence[tuple[str, str]]  # items no longer covered
    illegal: Sequence[tuple[str, str]]  # illegal items newly hit
    dropped: Sequence[tuple[str, str]]  # earlier goals that are no longer in the model
    verdicts: Sequence[VerdictChange]  # the changed verdicts


_MOST = 1 << 62  # the bound at which sums of hits saturate


class Answers:
    """Answers about a coverage database; each is computed once, on access."""

    def __init__(self, coverage: Coverage) -> None:
        self.coverage = coverage

    @cached_property
    def goals(self) -> Goals:
        """The goals of all items."""
        coverage = self.coverage
        groups = list(coverage.model.groups.values())
        items = [item for group in groups for item in group.items.values()]
        has_goal = np.array([item.kind is BinKind.GOAL for item in items], np.bool_)
        out = np.array([names in coverage.unreachable for names in coverage.items], np.bool_)
        return Goals(
            np.array([item.goal for item in items], np.int64),
            has_goal & ~out,
            has_goal & out,
            np.array([item.kind is BinKind.ILLEGAL for item in items], np.bool_),
            np.repeat(np.arange(len(groups)), [len(group.items) for group in groups]),
        )

    @cached_property
    def totals(self) -> Totals:
        """The hits of all items over all tests."""
        size = len(self.coverage.items)
        counts, tests = np.zeros(size, np.int64), np.zeros(size, np.int64)
        first, instants = np.full(size, -1), np.full(size, UNKNOWN)
        for place, entry in enumerate(self.coverage.entries):
            row = entry.row
            counts[row.items] += np.minimum(row.counts, _MOST - counts[row.items])
            tests[row.items] += 1
            is_new = first[row.items] < 0
            first[row.items[is_new]] = place
            instants[row.items[is_new]] = row.firsts[is_new]
        return Totals(counts, tests, first, instants)

    @cached_property
    def covered(self) -> NDArray[np.bool_]:
        """bool[items]: whether each is a reachable goal that was reached."""
        return self.goals.wanted & (self.totals.counts >= self.goals.goal)

    @cached_property
    def scores(self) -> Mapping[str, Score]:
        """The coverage of each group, by its name."""
        return self._scores(self.covered)

    @cached_property
    def share(self) -> float:
        """The covered share of the model, from 0 to 1; see `weighted`."""
        return self._share(self.covered)

    @cached_property
    def holes(self) -> Sequence[int]:
        """The reachable goals that were not reached."""
        return _places(self.goals.wanted & ~self.covered)

    @cached_property
    def illegal(self) -> Sequence[int]:
        """The illegal items that were hit."""
        return _places(self.goals.illegal & (self.totals.counts > 0))

    @cached_property
    def contradicted(self) -> Sequence[int]:
        """The items that were hit although declared unreachable."""
        return _places(self.goals.unreachable & (self.totals.counts > 0))

    @cached_property
    def steps(self) -> Sequence[Step]:
        """The contribution of each test, in the order of their campaigns."""
        return self.growth(range(len(self.coverage.entries)))

    def growth(self, order: Iterable[int]) -> list[Step]:
        """The contributions of tests taken in a given order (indices of entries)."""
        goals, size = self.goals, len(self.coverage.items)
        counts, covered = np.zeros(size, np.int64), np.zeros(size, np.bool_)
        share = self._share(covered)
        steps = []
        for place in order:
            row = self.coverage.entries[place].row
            counts[row.items] += np.minimum(row.counts, _MOST - counts[row.items])
            reached = goals.wanted & (counts >= goals.goal)
            added = _places(reached & ~covered)
            if added:
                covered = reached
                share = self._share(covered)
            steps.append(Step(place, added, share))
        return steps

    @cached_property
    def strategies(self) -> Mapping[str, Sequence[int]]:
        """The tests of each strategy, in order."""
        tests: dict[str, list[int]] = {}
        for place, entry in enumerate(self.coverage.entries):
            tests.setdefault(entry.record.strategy, []).append(place)
        return tests

    @cached_property
    def unique(self) -> Sequence[Sequence[int]]:
        """Per test, the items that would not be covered without it."""
        counts, unique = self.totals.counts, []
        for entry in self.coverage.entries:
            items = entry.row.items
            rest = counts[items] - entry.row.counts
            needed = self.covered[items] & (rest < self.goals.goal[items])
            unique.append(items[needed].tolist())
        return unique

    def hitters(self, most: int) -> dict[int, list[int]]:
        """The first `most` tests that hit each item, by item."""
        tests: dict[int, list[int]] = {}
        counts = np.zeros(len(self.coverage.items), np.int64)
        for place, entry in enumerate(self.coverage.entries):
            items = entry.row.items
            for item in items[counts[items] < most].tolist():
                tests.setdefault(item, []).append(place)
            counts[items] += 1
        return tests

    def _scores(self, covered: NDArray[np.bool_]) -> dict[str, Score]:
        goals, groups = self.goals, self.coverage.model.groups
        wanted = np.bincount(goals.group[goals.wanted], minlength=len(groups))
        reached = np.bincount(goals.group[covered], minlength=len(groups))
        return {
            name: Score(int(wanted[place]), int(reached[place]))
            for place, name in enumerate(groups)
        }

    def _share(self, covered: NDArray[np.bool_]) -> float:
        groups = self.coverage.model.groups
        return weighted((groups[name], score) for name, score in self._scores(covered).items())


def _places(chosen: NDArray[np.bool_]) -> list[int]:
    places: list[int] = np.flatnonzero(chosen).tolist()
    return places


def only(coverage: Coverage, wanted: Callable[[TestRecord], bool]) -> Coverage:
    """The coverage of the tests that satisfy a predicate."""
    return replace(coverage, entries=[entry for entry in coverage.entries if wanted(entry.record)])


Names = tuple[str, str]


def compare(before: Coverage, after: Coverage) -> Comparison:
    """The differences from an earlier campaign.

    Tests are matched by name, strategy and seed, whatever system they tested; of several equal
    ones, the first is matched with the first.
    """
    old_covered, old_illegal, old_share = _state(before)
    covered, illegal, share = _state(after)
    return Comparison(
        old_share,
        share,
        gained=[item for item, is_so in covered.items() if is_so and not old_covered.get(item)],
        lost=[
            item for item, was_so in old_covered.items() if was_so and not covered.get(item, True)
        ],
        illegal=[item for item in illegal if item not in old_illegal],
        dropped=[item for item in old_covered if item not in covered],
        verdicts=list(_changes(before, after)),
    )


def _state(coverage: Coverage) -> tuple[dict[Names, bool], list[Names], float]:
    """Whether each goal is covered; the illegal items that were hit; the covered share."""
    answers = Answers(coverage)
    covered = {
        coverage.items[place]: bool(answers.covered[place])
        for place in _places(answers.goals.wanted)
    }
    return covered, [coverage.items[place] for place in answers.illegal], answers.share


def _changes(before: Coverage, after: Coverage) -> Iterator[VerdictChange]:
    earlier: dict[tuple[object, ...], list[TestRecord]] = {}
    # Reversed, so that `pop` below takes the first of equal tests.
    for entry in reversed(before.entries):
        earlier.setdefault(_key(entry.record), []).append(entry.record)
    for entry in after.entries:
        record = entry.record
        same = earlier.get(_key(record))
        if not same:
            continue
        old = same.pop()
        for name in dict.fromkeys((*old.verdicts, *record.verdicts)):
            was, now = old.verdicts.get(name), record.verdicts.get(name)
            if was is not now:
                yield VerdictChange(record.name, name, was, now)


def _key(record: TestRecord) -> tuple[object, ...]:
    return record.name, record.strategy, record.seed
