"""What coverage says of items and tests, held against what can be counted by hand or by force."""

from dataclasses import replace
from itertools import permutations

import pytest
from tests.tools.covered import door_model, fill, hits_of, merged, random_database

from rvmon import coverage as by_run
from rvmon.coverage import Hit, TestRecord
from rvmon.coverage.database import Database
from rvmon.coverage.questions import Answers, VerdictChange, compare, only
from rvmon.coverage.ranking import ranking
from rvmon.verdict import Verdict


@pytest.fixture(scope="module")
def door():
    with Database.in_memory() as database:
        fill(database)
        return database.coverage()


def named(coverage, places):
    return [coverage.items[place] for place in places]


def test_totals(door):
    """Hits in all, by how many tests, by which first and when."""
    answers = Answers(door)
    found = answers.totals
    look = door.items.index(("gaze", "yes"))
    assert (found.counts[look], found.tests[look], found.first[look]) == (3, 2, 0)
    assert found.instants[look] == 1_000_000_000
    far = door.items.index(("near", "far"))
    assert (found.counts[far], found.tests[far], found.first[far]) == (0, 0, -1)
    assert answers.hitters(1)[look] == [0]
    assert answers.hitters(9)[look] == [0, 1]


def test_holes_and_illegal_hits(door):
    """What is ignored or illegal is no hole; a goal of three needs three."""
    answers = Answers(door)
    assert named(door, answers.illegal) == [("situation", "no × touch")]
    assert named(door, answers.holes) == [
        ("near", "reach"),
        ("near", "far"),
        ("situation", "yes × reach"),
        ("situation", "no × reach"),
        ("situation", "no × far"),
        ("D1", "passed"),
    ]


def test_the_share_is_that_of_the_hits_of_all_runs(door):
    """The one that is worked out from hits by name."""
    together = {}
    for entry in door.entries:
        row = zip(named(door, entry.row.items), entry.row.counts.tolist(), strict=True)
        for (group, item), count in row:
            own = together.setdefault(group, {})
            own[item] = Hit(count + (own[item].count if item in own else 0))
    answers = Answers(door)
    assert answers.share == by_run.share(together, door.model) == (2 / 2 + 1 / 3 + 2 / 4) / 4
    for name, group in door.model.groups.items():
        assert answers.scores[name] == by_run.score(together, group)


def test_growth_and_what_each_test_adds(door):
    """A goal of three hits is reached by the test that brings the third."""
    answers = Answers(door)
    steps = answers.steps
    assert [named(door, step.added) for step in steps] == [
        [("gaze", "yes"), ("D1", "triggered")],
        [("near", "touch"), ("situation", "yes × touch")],
        [],
        [("gaze", "no")],
    ]
    shares = [step.share for step in steps]
    assert shares == sorted(shares)
    assert shares[-1] == answers.share
    assert answers.strategies == {"random": [0, 1], "directed": [2, 3]}
    assert named(door, answers.growth([2, 3])[1].added) == [("gaze", "no")]


def test_what_only_one_test_covers(door):
    """Without it, the item would be a hole."""
    found = Answers(door).unique
    assert [named(door, items) for items in found] == [
        [("D1", "triggered")],
        [("situation", "yes × touch")],
        [("gaze", "no")],
        [("gaze", "no")],
    ]


def test_a_ranking_covers_all_with_few_tests():
    """As much as the whole campaign, each test adding to it, rarely more than the least."""
    for seed in range(25):
        together = merged(random_database(4 * seed + one) for one in range(4))
        coverage = together.coverage()
        together.close()
        answers = Answers(coverage)
        steps, share = ranking(answers), answers.share
        assert (steps[-1].share if steps else share) == share
        order = [step.entry for step in steps]
        assert len(set(order)) == len(order)
        if len(coverage.entries) <= 6:
            least = next(
                size
                for size in range(len(coverage.entries) + 1)
                for some in permutations(range(len(coverage.entries)), size)
                if ([0.0] + [step.share for step in answers.growth(some)])[-1] >= share
                or (not size and not steps)
            )
            assert least <= len(order) <= least + 1


def test_nothing_to_cover_is_covered():
    """An empty database, and a test without a model."""
    with Database.in_memory() as database:
        database.record(TestRecord("t"), {})
        coverage = database.coverage()
    answers = Answers(coverage)
    assert answers.share == 1
    assert [step.share for step in answers.steps] == [1]
    assert ranking(answers) == []
    assert answers.unique == [[]]


def test_campaigns_are_compared(door):
    """What is new, lost, illegal, and what verdicts changed."""
    with Database.in_memory() as database:
        database.declare(door_model())
        record = replace(
            door.entries[0].record, campaign="week 2", system="door 2", verdicts={"D1": "F"}
        )
        database.record(record, hits_of(("gaze", "yes"), ("near", "far")))
        later = database.coverage()
    found = compare(door, later)
    assert found.gained == [("near", "far")]
    assert ("gaze", "no") in found.lost
    assert found.illegal == []
    assert found.verdicts == [VerdictChange("calm-1", "D1", Verdict.PASS, Verdict.FAIL)]
    back = compare(later, door)
    assert (back.gained, back.lost) == (found.lost, [("near", "far")])
    assert back.illegal == [("situation", "no × touch")]
    assert back.before == found.after < back.after


def test_some_of_the_tests(door):
    """A campaign alone."""
    assert door.campaigns == ["week 1"]
    assert len(only(door, lambda record: record.strategy == "random").entries) == 2
    assert only(door, lambda record: record.campaign == "").entries == []
