"""Write a campaign's page and the pages of its examples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from handover.campaign.examples import choose_examples, comparable_jobs
from handover.campaign.files import RUNS, TESTS
from handover.campaign.outcome import Outcome, Results
from handover.campaign.pages import judged, simulated_page
from handover.campaign.plan import Job
from handover.campaign.program import typed
from handover.campaign.replay import play_again
from handover.campaign.report_page import report_page
from handover.campaign.summary import CampaignSummary
from handover.driver.run import Run
from rvmon.report.run_page import JudgedRun
from rvmon.session import Spec
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole

REPORT = "report.html"

Replays = dict[tuple[str, str], tuple[Run, Report]]
"""Runs that were played again, by robot and test."""


def write_pages(
    folder: Path,
    summary: CampaignSummary,
    results: Results,
    specs: Mapping[str, Spec],
    command: str,
) -> Path:
    """Write `report.html` and a page per example to `runs/`; return the former.

    Args:
        folder: of the campaign's files, with the tests in `tests/`.
        summary: its figures.
        results: its outcomes.
        specs: by robot, what judged it; empty if nothing was judged.
        command: runs the campaign again.
    """
    addresses: dict[tuple[str, str], str] = {}
    examples = choose_examples(results.outcomes)
    replays: Replays = {}
    (folder / RUNS).mkdir(parents=True, exist_ok=True)
    for job in examples.jobs if specs else ():
        spec = specs[job.robot]
        run, report = _replayed(job, spec, replays)
        text = simulated_page(
            run,
            report,
            spec,
            command=_command(folder, job),
            others=_others(job, report, results.outcomes, spec, replays),
            back=f"../{REPORT}",
        )
        address = f"{RUNS}/{job.robot}-{job.test.name}.html"
        write_whole(folder / address, text)
        addresses[job.robot, job.test.name] = address
    cells = {
        cell: f"{addresses[job.robot, job.test.name]}#{cell[2]}"
        for cell, job in examples.by_cell.items()
    }
    path = folder / REPORT
    page = report_page(summary, command=command, examples=cells, tests=addresses)
    write_whole(path, page)
    return path


def _others(
    job: Job, report: Report, outcomes: Sequence[Outcome], spec: Spec, replays: Replays
) -> list[JudgedRun]:
    """Runs that passed what this one failed."""
    failed = [name for name, verdict in report.verdicts.items() if verdict is Verdict.FAIL]
    if not failed:
        return []
    jobs = comparable_jobs(job, failed, outcomes)
    return [judged(*_replayed(one, spec, replays)) for one in jobs]


def _replayed(job: Job, spec: Spec, replays: Replays) -> tuple[Run, Report]:
    key = job.robot, job.test.name
    if key not in replays:
        replays[key] = play_again(job.test, job.robot, spec)
    return replays[key]


def _command(folder: Path, job: Job) -> str:
    words: list[object] = ["replay", folder / TESTS / f"{job.test.name}.json"]
    if job.robot == "legacy" and job.test.robot is None:
        words.append("--legacy")
    return typed(words)
