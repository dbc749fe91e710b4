"""Campaigns: their counts, which depend on the seed alone."""

import json

import pytest

from handover.campaign import campaign as of_handover
from handover.campaign.campaign import handover_campaign
from handover.campaign.table1 import FITTED, paper_table, table_document
from handover.checker import spec_path
from handover.generator.abstract_test import directed
from rvmon.cdv.campaign_page import choose_examples, comparable_jobs
from rvmon.cdv.campaign_plan import plan
from rvmon.cdv.outcome_counts import summarise
from rvmon.cdv.play import execute
from rvmon.cdv.tables import to_json
from rvmon.session import load
from rvmon.verdicts import Verdict

pytestmark = pytest.mark.campaign

REQUIREMENTS = ("R1", "R2", "R3", "R4", "R5")
SPECS = {robot: load(spec_path(robot)) for robot in ("legacy", "correct")}


def small(*, monitors=True, **more):
    options = {"tests": 2, "seed": 3, **more}
    campaign = handover_campaign(("legacy", "correct"), monitors=monitors)
    return plan(campaign, ("pseudorandom", "constrained"), **options)


def document(results):
    """The content of `table.json` without the seconds."""
    content = table_document(summarise(results, SPECS))
    del content["seconds"]
    return to_json(content)


@pytest.fixture(scope="module")
def results():
    return execute(small(), jobs=1)


@pytest.fixture(scope="module")
def directed_results():
    """The results of a few directed tests; `test_directed.py` plays all of them."""
    few = [one for one in directed() if one.name in ("released", "mutant-releases-late")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(of_handover, "directed", lambda: few)
        return execute(plan(handover_campaign(), ("directed",)), jobs=1)


def test_the_number_of_workers_changes_nothing(results):
    once = document(results)
    assert document(execute(small(), jobs=2)) == once
    assert document(execute(small(seed=4), jobs=1)) != once
    robots = json.loads(once)["robots"].values()
    columns = [one["strategies"][name] for one in robots for name in one["strategies"]]
    assert [column["tests"] for column in columns] == [2] * 4
    for counts in (row for column in columns for row in column["requirements"].values()):
        assert sum(counts.values()) == 2


def test_random_tests_never_reach_the_release(results):
    """The paper's coverage hole: the release block stays at 0 %, as the human is never ready."""
    for robot in summarise(results, SPECS).robots.values():
        for strategy in robot.strategies.values():
            assert strategy.statements["release"].percent == 0
            assert strategy.statements["reset"].percent > 50


def test_tests_with_lost_signals_are_repeated():
    """The table without the fitted loss differs only in these tests."""
    chosen = plan(handover_campaign(("legacy",)), ("constrained",), tests=40, seed=1)
    played = execute(chosen, jobs=1)
    lost = [one for one in played.played if one.control is not None]
    assert 0 < len(lost) < 12
    assert all(one.outcome.verdicts["R5"] == "NT" for one in lost)
    assert all(one.control.verdicts["R5"] == "P" for one in lost)
    summary = summarise(played, SPECS).robots["legacy"]
    assert summary.controls["constrained"]["R5"][Verdict.PASS] == 40


def test_without_monitors_nothing_is_judged(results):
    played = execute(small(monitors=False), jobs=1, controls=False)
    assert all(one.outcome.verdicts == {} for one in played.played)
    for bare, one in zip(played.played, results.played, strict=True):
        assert bare.outcome.hits.items() <= one.outcome.hits.items()
        assert "situation" not in bare.outcome.hits


def test_the_paper_counts_a_hundred_a_hundred_and_four():
    table = paper_table()
    assert [group.runs for group in table.groups] == [100, 100, 4]
    for group in table.groups:
        assert all(sum(counts.values()) == group.runs for counts in group.counts.values())
    cells = {(group.name, name) for group in table.groups for name in group.counts}
    assert cells >= FITTED
    assert table.checked["R5"] is None


def test_every_count_has_an_example(results):
    examples = choose_examples(results.played)
    verdicts = {(one.job.robot, one.job.test.name): one.outcome.verdicts for one in results.played}
    for (robot, strategy, requirement, verdict), job in examples.by_cell.items():
        assert (job.robot, job.test.strategy) == (robot, strategy)
        assert verdicts[robot, job.test.name][requirement] == verdict
        assert job in examples.jobs
    summary = summarise(results, SPECS)
    cells = {
        (robot, strategy, requirement, verdict)
        for robot, figures in summary.robots.items()
        for strategy, counted in figures.strategies.items()
        for requirement, counts in counted.counts.items()
        for verdict, count in counts.items()
        if count
    }
    assert set(examples.by_cell) == cells


def test_a_failed_test_is_compared_with_its_run_without_the_fault(directed_results):
    """A planted fault is easiest to see beside the unchanged robot."""
    failed = next(
        one.job for one in directed_results.played if one.job.test.name == "mutant-releases-late"
    )
    first, *others = comparable_jobs(failed, ["R1"], directed_results.played)
    assert first.test.mutation is None
    assert first.test.actions == failed.test.actions
    assert others
    assert all(job.robot == "correct" and job.test.mutation is None for job in others)
    assert len(directed()) == len({test.name for test in directed()})
