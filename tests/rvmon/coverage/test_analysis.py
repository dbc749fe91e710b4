"""Questions about coverage, compared with counts by hand or by brute force."""

import pytest
from tests.rvmon.coverage.merged import merged, random_database
from tests.tools.covered import fill

from rvmon import coverage as by_run
from rvmon.coverage import Hit, TestRecord
from rvmon.coverage.analysis import Answers
from rvmon.coverage.database import Database
from rvmon.coverage.ranking import fewest, ranking


@pytest.fixture(scope="module")
def door():
    with Database.in_memory() as database:
        fill(database)
        return database.coverage()


def named(coverage, places):
    return [coverage.items[place] for place in places]


def test_the_share_is_that_of_the_hits_of_all_runs(door):
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


def test_growth_and_contributions_of_tests(door):
    """A goal of three hits is reached by the test with the third hit."""
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


@pytest.mark.slow
def test_a_ranking_covers_everything_with_few_tests():
    """As much as the whole campaign; each test adds something, and few are superfluous."""
    for seed in range(25):
        together = merged(random_database(4 * seed + one) for one in range(4))
        coverage = together.coverage()
        together.close()
        answers = Answers(coverage)
        steps, share = ranking(answers), answers.share
        assert (steps[-1].share if steps else share) == share
        order = [step.entry for step in steps]
        assert len(set(order)) == len(order)
        least = len(fewest(answers).places)
        assert least <= len(order) <= least + 1


def test_nothing_to_cover_is_covered():
    with Database.in_memory() as database:
        database.record(TestRecord("t"), {})
        coverage = database.coverage()
    answers = Answers(coverage)
    assert answers.share == 1
    assert [step.share for step in answers.steps] == [1]
    assert ranking(answers) == []
    assert answers.unique == [[]]
