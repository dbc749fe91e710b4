"""Campaigns: what they count, and that it follows from the seed alone."""

import json
import multiprocessing
import os
import signal

import pytest

from handover.campaign import play as playing
from handover.campaign.documents import coverage_document, table_document, to_json
from handover.campaign.examples import choose_examples, comparable_jobs
from handover.campaign.execute import INTERRUPTED, execute
from handover.campaign.paper import FITTED, paper_table
from handover.campaign.plan import plan
from handover.campaign.summarise import summarise
from handover.generator.files import directed
from rvmon.verdict.verdict import Verdict

pytestmark = pytest.mark.campaign

REQUIREMENTS = dict.fromkeys(("R1", "R2", "R3", "R4", "R5"), "")
TEXTS = {"legacy": REQUIREMENTS, "correct": REQUIREMENTS}


def small(**more):
    """A few tests of two strategies against both robots."""
    options = {"tests": 6, "seed": 3, **more}
    return plan(("legacy", "correct"), ("pseudorandom", "constrained"), **options)


def document(results):
    """What `table.json` says, but for the seconds."""
    content = table_document(summarise(results, TEXTS))
    del content["seconds"]
    return to_json(content)


@pytest.fixture(scope="module")
def results():
    """The small campaign, played in this process."""
    return execute(small(), jobs=1)


@pytest.fixture(scope="module")
def directed_results():
    """All directed tests against the robots that they are written for."""
    return execute(plan(("correct", "legacy"), ("directed",)), jobs=1)


def test_the_number_of_workers_changes_nothing(results):
    """The same bytes with one worker and with two, which play it a second time."""
    once = document(results)
    assert document(execute(small(), jobs=2)) == once
    assert document(execute(small(seed=4), jobs=1)) != once


def test_every_test_is_counted_once(results):
    """P, F, NT and I of each requirement add up to the number of tests."""
    content = json.loads(document(results))
    for robot in content["robots"].values():
        for strategy in robot["strategies"].values():
            assert strategy["tests"] == 6
            for counts in strategy["requirements"].values():
                assert list(counts) == ["P", "F", "NT", "I"]
                assert sum(counts.values()) == 6


def test_what_was_not_run_is_absent(results):
    """No strategy, no model checking and no partial mark that there was not."""
    content = json.loads(document(results))
    assert set(content["robots"]["correct"]["strategies"]) == {"pseudorandom", "constrained"}
    assert "model_checking" not in content
    assert "partial" not in content


def test_random_tests_never_reach_the_release(results):
    """The paper's coverage hole: the release block stays at 0 %, for want of a ready human."""
    content = json.loads(to_json(coverage_document(summarise(results, TEXTS))))
    for robot in content["robots"].values():
        for strategy in robot["strategies"].values():
            assert strategy["by_state"]["release"]["percent"] == 0
            assert strategy["by_state"]["reset"]["percent"] > 50


def test_tests_whose_signals_got_lost_are_repeated():
    """The table without the fitted loss differs in these tests only."""
    chosen = plan(("legacy",), ("constrained",), tests=40, seed=1)
    played = execute(chosen, jobs=1)
    lost = [one for one in played.outcomes if not one.connected]
    assert 0 < len(lost) == len(played.unfitted) < 12
    assert all(one.verdicts["R5"] == "NT" for one in lost)
    assert all(one.verdicts["R5"] == "P" for one in played.unfitted)
    summary = summarise(played, TEXTS).robots["legacy"]
    assert summary.unfitted["constrained"]["R5"][Verdict.PASS] == 40


def test_directed_tests_end_as_they_should(directed_results):
    """Each known answer comes out; a planted fault says nothing about the robot as it is."""
    summary = summarise(directed_results, TEXTS)
    for figures in summary.robots.values():
        assert [one.test for one in figures.known if not one.as_expected] == []
    correct = summary.robots["correct"]
    planted = [one for one in correct.known if one.mutation is not None]
    assert planted
    assert correct.strategies["directed"].tests == len(correct.known) - len(planted)


def test_a_crash_of_the_robot_is_a_result(directed_results):
    """The test is judged, and its exception is kept."""
    crashed = [one for one in directed_results.outcomes if one.error is not None]
    assert [one.job.test.name for one in crashed] == ["mutant-crashes"]
    assert "ZeroDivisionError" in crashed[0].error
    assert set(crashed[0].verdicts) == set(REQUIREMENTS)


def test_an_interrupt_keeps_the_finished_tests(monkeypatch, results):
    """The table is made of what was played, and says that it is partial."""
    calls = []

    def run_test(*arguments, **options):
        calls.append(1)
        if len(calls) == 9:
            raise KeyboardInterrupt
        return real(*arguments, **options)

    real = playing.run_test
    monkeypatch.setattr(playing, "run_test", run_test)
    played = execute(small(), jobs=1)
    assert played.cut_short == INTERRUPTED
    assert played.outcomes == results.outcomes[:8]
    content = table_document(summarise(played, TEXTS))
    assert content["partial"] == {"why": "interrupted", "planned": 24, "finished": 8}
    counted = sum(
        strategy["tests"]
        for robot in content["robots"].values()
        for strategy in robot["strategies"].values()
    )
    assert counted == 8


@pytest.mark.skipif(
    multiprocessing.get_start_method() != "fork", reason="needs processes that are forked"
)
def test_a_worker_that_is_lost_keeps_the_finished_tests(monkeypatch, results):
    """Those before the one that it had, which is named."""
    last = small().jobs()[4]

    def run_test(test, **options):
        if (test.name, options["robot"]) == (last.test.name, last.robot):
            os.kill(os.getpid(), signal.SIGKILL)
        return real(test, **options)

    real = playing.run_test
    monkeypatch.setattr(playing, "run_test", run_test)
    played = execute(small(), jobs=2)
    assert played.outcomes == results.outcomes[:4]
    assert "the process that had test 5 was ended from outside" in played.cut_short


def test_without_monitors_nothing_is_judged():
    """The simulation is the same, and no verdict is made up."""
    played = execute(small(monitors=False), jobs=1, unfitted=False)
    assert all(one.verdicts == {} for one in played.outcomes)
    assert [one.states for one in played.outcomes] == [
        one.states for one in execute(small(), jobs=1, unfitted=False).outcomes
    ]


def test_the_paper_counts_a_hundred_a_hundred_and_four():
    """Each row of the published table adds up, and the fitted cells are in it."""
    table = paper_table()
    assert [group.runs for group in table.groups] == [100, 100, 4]
    for group in table.groups:
        assert all(sum(counts.values()) == group.runs for counts in group.counts.values())
    cells = {(group.name, name) for group in table.groups for name in group.counts}
    assert cells >= FITTED
    assert table.checked["R5"] is None


def test_every_count_has_an_example(results):
    """Each cell that is not nought leads to a test with that verdict."""
    examples = choose_examples(results.outcomes)
    verdicts = {(one.job.robot, one.job.test.name): one.verdicts for one in results.outcomes}
    for (robot, strategy, requirement, verdict), job in examples.by_cell.items():
        assert (job.robot, job.test.strategy) == (robot, strategy)
        assert verdicts[robot, job.test.name][requirement] == verdict
        assert job in examples.jobs
    summary = summarise(results, TEXTS)
    cells = {
        (robot, strategy, requirement, verdict)
        for robot, figures in summary.robots.items()
        for strategy, counted in figures.strategies.items()
        for requirement, counts in counted.counts.items()
        for verdict, count in counts.items()
        if count
    }
    assert set(examples.by_cell) == cells


def test_a_failed_test_is_held_against_itself_without_fault(directed_results):
    """A planted fault is best seen beside the robot as it is."""
    failed = next(
        one.job for one in directed_results.outcomes if one.job.test.name == "mutant-releases-late"
    )
    first, *others = comparable_jobs(failed, ["R1"], directed_results.outcomes)
    assert first.test.mutation is None
    assert first.test.actions == failed.test.actions
    assert others
    assert all(job.robot == "correct" and job.test.mutation is None for job in others)
    assert len(directed()) == len({test.name for test in directed()})
