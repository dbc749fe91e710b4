"""Play a plan on all cores; whatever ends it early, the finished tests are kept."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import closing
from functools import partial

from handover.campaign.outcome import Outcome, Results
from handover.campaign.plan import Plan
from handover.campaign.play import player
from rvmon.errors import WorkerLostError
from rvmon.execute import parallel

INTERRUPTED = "interrupted"

Progress = Callable[[int], None]
"""Called with the number of tests that have been finished so far."""


def execute(
    plan: Plan, *, jobs: int | None = None, unfitted: bool = True, progress: Progress | None = None
) -> Results:
    """Play all tests of a plan.

    The results do not depend on the number of workers.

    Args:
        plan: what to play.
        jobs: worker processes; default: one per core; 1 plays in this process.
        unfitted: also play the tests whose signals got lost once more without that loss.
        progress: told as tests are finished.
    """
    started = time.perf_counter()
    begin = partial(player, plan.specs if plan.monitors else {}, repeat=unfitted)
    count = jobs or os.cpu_count() or 1
    outcomes: list[Outcome] = []
    repeated: list[Outcome] = []
    cut_short = ""
    try:
        with closing(parallel.execute(plan.jobs(), begin, jobs=count, what="test")) as played:
            for outcome, *again in played:
                outcomes.append(outcome)
                repeated += again
                if progress is not None:
                    progress(len(outcomes))
    except KeyboardInterrupt:
        cut_short = INTERRUPTED
    except WorkerLostError as error:
        cut_short = str(error)
    seconds = time.perf_counter() - started
    return Results(plan, tuple(outcomes), tuple(repeated), seconds, cut_short)
