"""`handover replay`: one test again, alone."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

from handover.campaign.examples import comparable_jobs
from handover.campaign.pages import judged, simulated_page
from handover.campaign.plan import Job
from handover.campaign.program import typed
from handover.checker import Checker, spec_path
from handover.driver import run_test
from handover.driver.run import Run
from handover.generator.abstract_test import AbstractTest
from handover.generator.files import load as load_test
from rvmon.loading import load
from rvmon.report.folder import made
from rvmon.session import Spec
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole


def run_replay(arguments: argparse.Namespace) -> int:
    """Run `handover replay` and return its exit code."""
    test = load_test(arguments.test)
    robot = "legacy" if arguments.legacy else test.robot or "correct"
    spec = load(arguments.spec or spec_path(robot))
    # A folder that cannot be written to is told before anything is played.
    folder = made(arguments.out) if arguments.out else None
    run, report = play_again(test, robot, spec)
    _show(arguments.format, spec, run, report)
    if folder is not None:
        words = ["replay", arguments.test, *(["--legacy"] if arguments.legacy else [])]
        # The file is named after the test's file: what it says inside is no path.
        target = folder / Path(arguments.test).stem
        others = [
            judged(*play_again(one.test, robot, spec))
            for one in comparable_jobs(Job(test, robot), (), ())
        ]
        page = simulated_page(run, report, spec, command=typed(words), others=others)
        _write(target, run, page)
    return int(Verdict.FAIL in report.verdicts.values())


def play_again(
    test: AbstractTest, robot: str, spec: Spec, *, startup_loss: bool = True
) -> tuple[Run, Report]:
    """Play one test with the scene recorded, and judge it: the run that the campaign had."""
    checker = Checker(spec)
    run = run_test(
        test,
        robot=robot,
        startup_loss=startup_loss,
        record_poses=True,
        observer=checker.observe,
    )
    return run, replace(checker.finish(run.end_ns), trace=test.name)


def _write(target: Path, run: Run, page: str) -> None:
    """Write the page, and the bus messages as JSON lines, which `rvmon run` reads."""
    lines = [json.dumps({"t_ns": t_ns, **values}) + "\n" for t_ns, values in run.samples]
    write_whole(target.with_name(f"{target.name}.html"), page)
    write_whole(target.with_name(f"{target.name}.jsonl"), "".join(lines))


def _show(form: str, spec: Spec, run: Run, report: Report) -> None:
    if form == "json":
        print(report.to_json())
        return
    from rich.console import Console

    from rvmon.report.run_text import print_report

    console = Console(highlight=False)
    print_report(report, spec.checked, console)
    if run.error is not None:
        console.print(f"The robot's code crashed: {run.error}", style="bold red")
