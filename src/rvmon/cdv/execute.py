"""Play a plan on all cores; whatever ends it early, the finished tests are kept."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial

from rvmon.cdv.campaign import Campaign
from rvmon.cdv.outcome import Outcome, Played, Results
from rvmon.cdv.plan import Job, Plan
from rvmon.cdv.play import player
from rvmon.cdv.unfinished import Unfinished
from rvmon.coverage.record import Ending
from rvmon.execute import parallel
from rvmon.execute.ended import Ended
from rvmon.session import load
from rvmon.verdict.verdict import Verdict

INTERRUPTED = "interrupted"

Progress = Callable[[int], None]
"""Called with the number of tests that have been finished so far."""


def execute(
    plan: Plan,
    *,
    jobs: int | str | None = None,
    controls: bool = True,
    kept: Unfinished | None = None,
    progress: Progress | None = None,
) -> Results:
    """Play all tests of a plan.

    The results do not depend on the number of processes. A test that takes too long, or ends its
    process, is a result as any other.

    Args:
        plan: what to play.
        jobs: processes, or the address of a scheduler of Dask; default: one process per core.
        controls: also play the controls of tests.
        kept: where each test is kept as soon as it was played; those before are not played again.
        progress: called as each test is finished.

    Raises:
        RvmonError: a system cannot be made, or no process be begun.
    """
    tests = plan.jobs() if kept is None else kept.jobs
    known = {} if kept is None else kept.known
    begun = time.perf_counter() - (kept.seconds if kept is not None else 0)
    left = [job for job in tests if (job.test.name, job.robot) not in known]
    played: list[Played] = []
    cut_short = "" if kept is None or kept.shard is None else f"shard {kept.shard}"
    try:
        with closing(outcomes(plan.campaign, left, jobs=jobs, controls=controls)) as results:
            for job in tests:
                before = known.get((job.test.name, job.robot))
                if before is not None:
                    played.append(before)
                    continue
                played.append(Played(job, *next(results)))
                if kept is not None:
                    kept.keep(played[-1], time.perf_counter() - begun)
                if progress is not None:
                    progress(len(played))
    except KeyboardInterrupt:
        cut_short = INTERRUPTED
    return Results(plan, tuple(played), time.perf_counter() - begun, cut_short)


def outcomes(
    campaign: Campaign,
    tests: Iterable[Job],
    *,
    jobs: int | str | None = None,
    controls: bool = True,
) -> Generator[tuple[Outcome, Outcome | None], None, None]:
    """Play tests, in this order; each outcome comes with that of its control.

    Args:
        campaign: whose tests they are.
        tests: taken from as processes have time.
        jobs: processes, or the address of a scheduler of Dask; default: one process per core.
        controls: also play the controls of tests.

    Raises:
        RvmonError: a system cannot be made, or no process be begun.
    """
    control = campaign.control.make if campaign.control is not None and controls else None
    return parallel.execute(
        tests,
        partial(player, campaign.robots, campaign.code, control),
        jobs=jobs or os.cpu_count() or 1,
        what="test",
        instead=partial(_without_result, _requirements(campaign)),
        timeout_s=campaign.timeout_s,
    )


def play_apart(campaign: Campaign, job: Job) -> Outcome:
    """Play one test in a process of its own, which is ended if it takes too long.

    Args:
        campaign: that the test is of; its code is not measured.
        job: what is played.

    Raises:
        RvmonError: the system cannot be made, or the process not be begun.
    """
    alone = replace(campaign, robots={job.robot: campaign.robots[job.robot]}, code=None)
    with closing(outcomes(alone, [job], jobs=1, controls=False)) as results:
        return next(results)[0]


def _requirements(campaign: Campaign) -> dict[str, tuple[str, ...]]:
    """The ids of the requirements by robot."""
    return {
        name: () if robot.spec is None else tuple(load(robot.spec).requirements)
        for name, robot in campaign.robots.items()
    }


def _without_result(
    requirements: Mapping[str, Sequence[str]], job: Job, ended: Ended
) -> tuple[Outcome, None]:
    """The outcome of a test whose process was ended: nothing is known of it."""
    ending = Ending.HUNG if ended.timed_out else Ending.LOST
    verdicts = dict.fromkeys(requirements[job.robot], Verdict.INCONCLUSIVE)
    return Outcome(verdicts, {}, (), {}, ending, ended.why, 0, {}, ended.seconds), None
