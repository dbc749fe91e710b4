"""Play tests one after the other in one process, judged and measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from handover.campaign.outcome import Outcome
from handover.campaign.plan import Job
from handover.checker import Checker
from handover.collector.meter import StatementMeter
from handover.driver import run_test
from handover.driver.draws import draw
from rvmon.loading import load


def player(specs: Mapping[str, Path], *, repeat: bool) -> Callable[[Job], list[Outcome]]:
    """What plays a job in this process.

    Args:
        specs: by robot, the file of the requirements that judge it; none judges nothing.
        repeat: whether a test whose signals got lost is played once more without that loss, as a
            second outcome.
    """
    checkers = {robot: Checker(load(path)) for robot, path in specs.items()}
    meter = StatementMeter()

    def played(job: Job) -> list[Outcome]:
        outcome = _play(job, checkers.get(job.robot), meter)
        if outcome.connected or not repeat:
            return [outcome]
        return [outcome, _play(replace(job, startup_loss=False), checkers.get(job.robot), meter)]

    return played


def _play(job: Job, checker: Checker | None, meter: StatementMeter) -> Outcome:
    if checker is not None:
        checker.begin()
    meter.begin()
    run = run_test(
        job.test,
        robot=job.robot,
        startup_loss=job.startup_loss,
        observer=None if checker is None else checker.observe,
        around_robot_step=lambda: meter,
    )
    report = None if checker is None else checker.finish(run.end_ns)
    loses = job.startup_loss and job.test.startup_loss
    return Outcome(
        job=job,
        verdicts={} if report is None else report.verdicts,
        states=tuple(state for _, state in run.states),
        lines=meter.executed(),
        stepped_s=run.stepped_s,
        simulated_s=run.simulated_s,
        error=run.error,
        connected=draw(job.test.seed, startup_loss=loses).connected,
    )
