"""`handover replay`: one test again, alone."""

from __future__ import annotations

import argparse

from handover.checker import Checker, spec_path
from handover.driver import run_test
from handover.driver.run import Run
from handover.generator.abstract_test import AbstractTest
from handover.generator.files import load as load_test
from rvmon.session import Spec, load
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict


def run_replay(arguments: argparse.Namespace) -> int:
    """Run `handover replay` and return its exit code."""
    test = load_test(arguments.test)
    robot = "legacy" if arguments.legacy else test.robot or "correct"
    spec = load(arguments.spec or spec_path(robot))
    run, report = play_again(test, robot, spec)
    _show(arguments.format, spec, run, report)
    return int(Verdict.FAIL in report.verdicts.values())


def play_again(
    test: AbstractTest, robot: str, spec: Spec, *, startup_loss: bool = True
) -> tuple[Run, Report]:
    """Play one test with the scene recorded, and judge it: the run that the campaign had."""
    from dataclasses import replace

    checker = Checker(spec)
    run = run_test(
        test,
        robot=robot,
        startup_loss=startup_loss,
        record_poses=True,
        observer=checker.observe,
    )
    return run, replace(checker.finish(run.end_ns), trace=test.name)


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
