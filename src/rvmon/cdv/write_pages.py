"""Write a campaign's page and the pages of its examples."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from rvmon.cdv.campaign import Campaign, Robot
from rvmon.cdv.campaign_files import RUNS, TESTS
from rvmon.cdv.campaign_page import campaign_page
from rvmon.cdv.coverage import write_coverage
from rvmon.cdv.examples import Examples, comparable_jobs
from rvmon.cdv.outcome import Played, Results
from rvmon.cdv.plan import Job
from rvmon.cdv.program import typed
from rvmon.cdv.run_pages import Replay, play_again, replay_page
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.tables import RobotTables
from rvmon.execute import parallel
from rvmon.loading import load
from rvmon.report.run_page import JudgedRun
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole

REPORT = "report.html"


def write_pages(
    folder: Path,
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    results: Results,
    command: str,
    *,
    examples: Examples,
    jobs: int | None,
    tell: Callable[[float], None],
) -> list[str]:
    """Write `report.html`, a page per example to `runs/`, and what was covered.

    Args:
        folder: of the campaign's files, with the tests in `tests/`.
        summary: its figures.
        tables: its verdicts, by robot.
        results: its outcomes.
        command: runs the campaign again.
        examples: the tests that get a page.
        jobs: processes that write pages; default: one per core.
        tell: told how many pages are written.

    Returns:
        The tests that came out otherwise when they were played again for their pages.
    """
    campaign = results.plan.campaign
    (folder / RUNS).mkdir(parents=True, exist_ok=True)
    shown = {(job.robot, job.test.name) for job in examples.jobs}
    judged = {name: robot for name, robot in campaign.robots.items() if robot.spec is not None}
    wanted = [
        one
        for one in results.played
        if (one.job.robot, one.job.test.name) in shown and one.job.robot in judged
    ]
    written = parallel.execute(
        [_page_of(one, folder, results) for one in wanted],
        partial(_writer, folder, judged),
        jobs=jobs or os.cpu_count() or 1,
        what="page",
    )
    addresses: dict[tuple[str, str], str] = {}
    otherwise: list[str] = []
    with closing(written):
        for number, (one, verdicts) in enumerate(zip(wanted, written, strict=True), start=1):
            test = one.job.test.name
            addresses[one.job.robot, test] = _address(one.job)
            if verdicts != one.outcome.verdicts:
                otherwise.append(test)
            tell(number)
    cells = {
        cell: f"{addresses[job.robot, job.test.name]}#{cell[2]}"
        for cell, job in examples.by_cell.items()
    }
    page = campaign_page(
        summary,
        tables,
        campaign.presentation,
        command=command,
        examples=cells,
        tests=addresses,
        coverage=write_coverage(folder, results, addresses),
    )
    write_whole(folder / REPORT, page)
    return otherwise


@dataclass(frozen=True, slots=True)
class _Page:
    """A page to be written.

    Attributes:
        job: the test that it shows.
        command: replays it.
        others: tests that passed what it failed.
    """

    job: Job
    command: str
    others: tuple[Job, ...]


def _page_of(one: Played, folder: Path, results: Results) -> _Page:
    verdicts = one.outcome.verdicts
    failed = [name for name, verdict in verdicts.items() if verdict is Verdict.FAIL]
    others = comparable_jobs(one.job, failed, results.played) if failed else ()
    return _Page(one.job, _command(folder, one.job, results.plan.campaign), tuple(others))


def _writer(folder: Path, robots: Mapping[str, Robot]) -> Callable[[_Page], Mapping[str, Verdict]]:
    """What writes a page and returns the verdicts on the test that was played for it."""
    specs = {name: load(robot.spec) for name, robot in robots.items() if robot.spec is not None}
    compared: dict[tuple[str, str], Replay] = {}

    def replay_of(job: Job) -> Replay:
        known = compared.get((job.robot, job.test.name))
        return known or play_again(job.test, job.robot, robots[job.robot], specs[job.robot])

    def compared_with(job: Job) -> JudgedRun:
        """A run that many pages may compare theirs with: it is kept."""
        return compared.setdefault((job.robot, job.test.name), replay_of(job)).judged

    def write(page: _Page) -> Mapping[str, Verdict]:
        replay, robot = replay_of(page.job), page.job.robot
        text = replay_page(
            replay,
            robot,
            specs[robot],
            command=page.command,
            others=[compared_with(job) for job in page.others],
            back=f"../{REPORT}",
        )
        write_whole(folder / _address(page.job), text)
        return replay.report.verdicts

    return write


def _address(job: Job) -> str:
    """Of a test's page in the folder of the campaign."""
    return f"{RUNS}/{job.robot}-{job.test.name}.html"


def _command(folder: Path, job: Job, campaign: Campaign) -> str:
    words: list[object] = ["replay", folder / TESTS / f"{job.test.name}.json"]
    if job.test.robot is None and len(campaign.robots) > 1:
        words += campaign.presentation.robot_words(job.robot)
    return typed(campaign.program, words)
