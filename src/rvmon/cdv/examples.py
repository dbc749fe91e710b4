"""Which tests of a campaign get a page: one example of everything that happened."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from msgspec import structs

from rvmon.cdv.outcome import Played
from rvmon.cdv.plan import Job
from rvmon.coverage.record import Ending
from rvmon.verdict.verdict import Verdict

Cell = tuple[str, str, str, Verdict]
"""Robot, strategy, requirement and verdict: a count in a table."""

COMPARED = 12
"""Passing tests in which the nearest passing attempt is looked for."""


@dataclass(frozen=True, slots=True)
class Examples:
    """Tests with a page.

    Attributes:
        jobs: without repetition, in the order of the plan.
        by_cell: the first test behind each count that is not zero.
    """

    jobs: tuple[Job, ...]
    by_cell: dict[Cell, Job]


def choose_examples(
    played: Sequence[Played], *, also: Collection[str] = (), every: bool = False
) -> Examples:
    """The first test behind each count, every test with a known answer, and every crash.

    A test that hung, or ended its process, has no page: it cannot be played again here.

    Args:
        played: of the campaign.
        also: names of tests that get a page whatever became of them.
        every: whether all others are shown as well.
    """
    by_cell: dict[Cell, Job] = {}
    shown: dict[tuple[str, str], Job] = {}
    for one in played:
        job, outcome = one.job, one.outcome
        if outcome.ending in (Ending.HUNG, Ending.LOST):
            continue
        wanted = every or job.test.name in also
        wanted |= bool(job.test.expected) or outcome.error is not None
        if job.test.mutation is None:
            for requirement, verdict in outcome.verdicts.items():
                cell = (job.robot, job.test.strategy, requirement, verdict)
                wanted |= by_cell.setdefault(cell, job) is job
        if wanted:
            shown[job.robot, job.test.name] = job
    return Examples(tuple(shown.values()), by_cell)


def comparable_jobs(job: Job, failed: Sequence[str], played: Sequence[Played]) -> list[Job]:
    """Tests that pass what a test failed, on the same robot: its own self without fault first.

    Args:
        job: the test that failed.
        failed: ids of the requirements.
        played: of the campaign.
    """
    jobs = _without_fault(job)
    for requirement in failed:
        passed = [
            one.job
            for one in played
            if one.job.robot == job.robot
            and one.job.test.mutation is None
            and one.outcome.verdicts.get(requirement) is Verdict.PASS
        ]
        # Tests that know their answers are about what the robot should do: those first.
        passed.sort(key=lambda one: not one.test.expected)
        jobs.extend(passed[:COMPARED])
    return jobs


def _without_fault(job: Job) -> list[Job]:
    if job.test.mutation is None:
        return []
    name = f"{job.test.name} on the robot as it is"
    return [
        replace(
            job, test=structs.replace(job.test, name=name, mutation=None, expected={}, reaches={})
        )
    ]
