"""Play jobs one after the other in one process, judged and measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from handover.campaign.outcome import Outcome
from handover.campaign.plan import Job
from handover.checker import Checker
from handover.collector.meter import StatementMeter
from handover.driver import run_test
from handover.driver.draws import draw
from rvmon.loading import load


@dataclass(frozen=True, slots=True)
class Chunk:
    """Jobs for one worker, all against one robot.

    Attributes:
        start: position of the first job in the plan.
        jobs: what to play.
        spec: the file of the requirements; `None` judges nothing.
    """

    start: int
    jobs: tuple[Job, ...]
    spec: Path | None


@dataclass(frozen=True, slots=True)
class Played:
    """What came out of a chunk; fewer outcomes than jobs if it was interrupted."""

    chunk: Chunk
    outcomes: tuple[Outcome, ...]


def play(chunk: Chunk) -> Played:
    """Play a chunk; an interrupt ends it after the tests that are finished."""
    checker = None if chunk.spec is None else Checker(load(chunk.spec))
    meter = StatementMeter()
    outcomes: list[Outcome] = []
    try:
        for job in chunk.jobs:
            outcomes.append(_play_one(job, checker, meter))  # noqa: PERF401  # keeps what is done
    except KeyboardInterrupt:
        pass
    return Played(chunk, _with_lines(outcomes, meter))


def _play_one(job: Job, checker: Checker | None, meter: StatementMeter) -> Outcome:
    if checker is not None:
        checker.begin()
    meter.begin(_context(job))
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
        lines=frozenset(),
        stepped_s=run.stepped_s,
        simulated_s=run.simulated_s,
        error=run.error,
        connected=draw(job.test.seed, startup_loss=loses).connected,
    )


def _context(job: Job) -> str:
    return f"{job.test.strategy}/{job.test.name}"


def _with_lines(outcomes: Sequence[Outcome], meter: StatementMeter) -> tuple[Outcome, ...]:
    executed = meter.executed()
    return tuple(
        replace(outcome, lines=executed.get(_context(outcome.job), frozenset()))
        for outcome in outcomes
    )
