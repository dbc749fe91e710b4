"""The pages of a campaign and its tests; tests whose recording was not kept are played again."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from rvmon.cdv.campaign import Campaign, Robot
from rvmon.cdv.campaign_page import Examples, campaign_page, comparable_jobs
from rvmon.cdv.campaign_plan import Job, Played, Results
from rvmon.cdv.campaign_summary import CampaignSummary
from rvmon.cdv.campaign_text import RUNS, TESTS, typed
from rvmon.cdv.coverage import write_coverage
from rvmon.cdv.play import Bench, Recorded, recording_path
from rvmon.cdv.shrink import failure_of
from rvmon.cdv.tables import RobotTables
from rvmon.cdv.test import Test
from rvmon.execute import parallel
from rvmon.files import write_whole
from rvmon.report.attempt_panels import JudgedRun, RunPage
from rvmon.report.html import Child, e
from rvmon.report.run_html import run_page
from rvmon.session import Spec
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict


@dataclass(frozen=True, slots=True)
class Replay:
    """A test that was played again."""

    test: Test
    recorded: Recorded  # may lack hits of code and coverage models: a replay measures none

    @property
    def judged(self) -> JudgedRun:
        """The run, in the form that its page needs."""
        samples = tuple(Sample(*sample) for sample in self.recorded.samples)
        report = replace(self.recorded.report, trace=self.test.name)
        return JudgedRun(self.test.name, report, samples)


def play_again(test: Test, bench: Bench, *, wants_scene: bool = True) -> Replay:
    """Play one test in this process, keeping its samples; it gives the same run as the campaign."""
    return Replay(test, bench.play(test, keeps=True, wants_scene=wants_scene))


def replay_page(
    replay: Replay,
    robot: str,
    spec: Spec,
    *,
    command: str,
    others: Sequence[JudgedRun] = (),
    back: str = "",
    smallest: str = "",
) -> str:
    """The page of one test.

    `others` are runs that a failed attempt can be compared with, `back` is the address of the
    campaign's page; `command` replays the test, and `smallest` shrinks it.
    """
    facts: list[tuple[str, Child]] = [*_facts(replay, robot, spec)]
    if smallest:
        facts.append(("smallest test that fails alike", e("code", None, smallest)))
    return run_page(
        RunPage(
            run=replay.judged,
            spec=spec.checked,
            command=command,
            others=others,
            facts=facts,
            scene=replay.recorded.run.scene,
            back=back,
        )
    )


def _facts(replay: Replay, robot: str, spec: Spec) -> list[tuple[str, str]]:
    test, run = replay.test, replay.recorded.run
    facts = [
        ("test", test.name),
        ("purpose", test.text or None),
        ("robot", robot),
        ("specification", spec.checked.name),
        ("planted fault", test.mutation),
        ("seed", str(test.seed)),
        *run.facts,
        ("robot crashed", run.error),
    ]
    return [(name, fact) for name, fact in facts if fact is not None]


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
    progress: Callable[[float], None],
    spool: Path | None = None,
) -> list[str]:
    """Write `report.html`, a page per example to `runs/`, and the coverage.

    Tests are played again for their pages, unless `spool` has their recordings. `command` is the
    command line of the campaign; `progress` is called with the number of written pages.

    Returns:
        The names of tests whose verdicts differed when they were played again.
    """
    campaign = results.plan.campaign
    (folder / RUNS).mkdir(parents=True, exist_ok=True)
    shown = {(job.robot, job.test.name) for job in examples.jobs}
    judged = campaign.requirements
    wanted = [
        played
        for played in results.played
        if (played.job.robot, played.job.test.name) in shown and played.job.robot in judged
    ]
    written = parallel.execute(
        [_page_to_write(played, folder, results) for played in wanted],
        partial(_writer, folder, campaign.robots, judged, spool),
        jobs=jobs or os.cpu_count() or 1,
        what="page",
    )
    addresses: dict[tuple[str, str], str] = {}
    changed: list[str] = []
    with closing(written):
        pairs = zip(wanted, written, strict=True)
        for number, (played, verdicts) in enumerate(pairs, start=1):
            test = played.job.test.name
            addresses[played.job.robot, test] = _address(played.job)
            if verdicts != played.outcome.verdicts:
                changed.append(test)
            progress(number)
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
        further=campaign.presentation.sections(
            {
                (played.job.robot, played.job.test.name): played.job.test
                for played in results.played
            },
            addresses,
        ),
    )
    write_whole(folder / REPORT, page)
    return changed


@dataclass(frozen=True, slots=True)
class _Page:
    """A page to be written."""

    job: Job  # the test that it shows
    command: str  # the command line that replays it
    others: tuple[Job, ...]  # runs that a failed attempt is compared with
    shrink: str  # the command line that shrinks it; empty: it cannot be shrunk, or does not fail


def _page_to_write(played: Played, folder: Path, results: Results) -> _Page:
    campaign = results.plan.campaign
    verdicts = played.outcome.verdicts
    failed = [name for name, verdict in verdicts.items() if verdict is Verdict.FAIL]
    others = comparable_jobs(played.job, failed, results.played) if failed else ()
    fails = bool(played.job.test.removable) and failure_of(played.outcome) is not None
    return _Page(
        played.job,
        _command("replay", folder, played.job, campaign),
        tuple(others),
        _command("shrink", folder, played.job, campaign) if fails else "",
    )


def _writer(
    folder: Path, robots: Mapping[str, Robot], specs: Mapping[str, Spec], spool: Path | None
) -> Callable[[_Page], Mapping[str, Verdict]]:
    """A function that writes a page and returns the verdicts on its test."""
    benches = {name: Bench(name, robots[name]) for name in specs}
    compared: dict[tuple[str, str], JudgedRun] = {}

    def compared_with(job: Job) -> JudgedRun:
        """A run to compare with; it is kept, as many pages may use the same one."""
        key = job.robot, job.test.name
        if key not in compared:
            bench = benches[job.robot]
            again = _recording_of(spool, job) or play_again(job.test, bench, wants_scene=False)
            compared[key] = again.judged
        return compared[key]

    def write(page: _Page) -> Mapping[str, Verdict]:
        robot = page.job.robot
        replay = _recording_of(spool, page.job) or play_again(page.job.test, benches[robot])
        text = replay_page(
            replay,
            robot,
            specs[robot],
            command=page.command,
            others=[compared_with(job) for job in page.others],
            back=f"../{REPORT}",
            smallest=page.shrink,
        )
        write_whole(folder / _address(page.job), text)
        return replay.recorded.report.verdicts

    return write


def _recording_of(spool: Path | None, job: Job) -> Replay | None:
    """The recording of a test, or `None` if it was played elsewhere or in an earlier session."""
    if spool is None or not (path := recording_path(spool, job)).exists():
        return None
    recorded: Recorded = pickle.loads(path.read_bytes())  # noqa: S301 - a folder of this process
    return Replay(job.test, recorded)


def _address(job: Job) -> str:
    """The address of a test's page, relative to the campaign's folder."""
    return f"{RUNS}/{job.robot}-{job.test.name}.html"


def _command(command: str, folder: Path, job: Job, campaign: Campaign) -> str:
    words: list[object] = [command, folder / TESTS / f"{job.test.name}.json"]
    if job.test.robot is None and len(campaign.robots) > 1:
        words += ["--robot", job.robot]
    return typed(campaign.program, words)
