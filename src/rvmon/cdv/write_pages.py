"""Write a campaign's page and the pages of its examples."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from rvmon.cdv.campaign import Campaign
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
from rvmon.report.run_page import JudgedRun
from rvmon.session import Spec
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole

REPORT = "report.html"


def write_pages(
    folder: Path,
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    results: Results,
    specs: Mapping[str, Spec],
    command: str,
    *,
    examples: Examples,
    tell: Callable[[float], None],
) -> list[str]:
    """Write `report.html`, a page per example to `runs/`, and what was covered.

    Args:
        folder: of the campaign's files, with the tests in `tests/`.
        summary: its figures.
        tables: its verdicts, by robot.
        results: its outcomes.
        specs: by robot, what judged it; empty if nothing was judged.
        command: runs the campaign again.
        examples: the tests that get a page.
        tell: told how many pages are written.

    Returns:
        The tests that came out otherwise when they were played again for their pages.
    """
    campaign = results.plan.campaign
    replays = _Replays(campaign, specs)
    verdicts = {(one.job.robot, one.job.test.name): one.outcome.verdicts for one in results.played}
    addresses: dict[tuple[str, str], str] = {}
    otherwise: list[str] = []
    (folder / RUNS).mkdir(parents=True, exist_ok=True)
    for number, job in enumerate(examples.jobs if specs else (), start=1):
        replay = replays.of(job)
        text = replay_page(
            replay,
            job.robot,
            specs[job.robot],
            command=_command(folder, job, campaign),
            others=_others(job, replay, results.played, replays),
            back=f"../{REPORT}",
        )
        if replay.report.verdicts != verdicts[job.robot, job.test.name]:
            otherwise.append(job.test.name)
        address = f"{RUNS}/{job.robot}-{job.test.name}.html"
        write_whole(folder / address, text)
        addresses[job.robot, job.test.name] = address
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


class _Replays:
    """Tests that were played again, each once."""

    def __init__(self, campaign: Campaign, specs: Mapping[str, Spec]) -> None:
        self._campaign = campaign
        self._specs = specs
        self._known: dict[tuple[str, str], Replay] = {}

    def of(self, job: Job) -> Replay:
        """The replay of a test."""
        key = job.robot, job.test.name
        if key not in self._known:
            robot = self._campaign.robots[job.robot]
            self._known[key] = play_again(job.test, job.robot, robot, self._specs[job.robot])
        return self._known[key]


def _others(
    job: Job, replay: Replay, played: Sequence[Played], replays: _Replays
) -> list[JudgedRun]:
    """Runs that passed what this one failed."""
    verdicts = replay.report.verdicts
    failed = [name for name, verdict in verdicts.items() if verdict is Verdict.FAIL]
    if not failed:
        return []
    return [replays.of(one).judged for one in comparable_jobs(job, failed, played)]


def _command(folder: Path, job: Job, campaign: Campaign) -> str:
    words: list[object] = ["replay", folder / TESTS / f"{job.test.name}.json"]
    if job.test.robot is None and len(campaign.robots) > 1:
        words += campaign.presentation.robot_words(job.robot)
    return typed(campaign.program, words)
