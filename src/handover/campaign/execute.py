"""Play a plan on all cores; whatever ends it early, the finished tests are kept."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import closing
from functools import partial

from handover.campaign.outcome import Results
from handover.campaign.plan import Plan
from handover.campaign.play import player
from handover.campaign.unfinished import Played, Unfinished
from rvmon.errors import WorkerLostError
from rvmon.execute import parallel

INTERRUPTED = "interrupted"

Progress = Callable[[int], None]
"""Called with the number of tests that have been finished so far."""


def execute(
    plan: Plan,
    *,
    jobs: int | None = None,
    unfitted: bool = True,
    kept: Unfinished | None = None,
    progress: Progress | None = None,
) -> Results:
    """Play all tests of a plan.

    The results do not depend on the number of workers.

    Args:
        plan: what to play.
        jobs: worker processes; default: one per core; 1 plays in this process.
        unfitted: also play the tests whose signals got lost once more without that loss.
        kept: where each test is kept as soon as it was played; those before are not played again.
        progress: told as tests are finished.
    """
    played = [] if kept is None else [*kept.played]
    started = time.perf_counter() - (played[-1].seconds if played else 0)
    begin = partial(player, plan.specs if plan.monitors else {}, repeat=unfitted)
    count = jobs or os.cpu_count() or 1
    left = plan.jobs()[len(played) :]
    cut_short = ""
    try:
        with closing(parallel.execute(left, begin, jobs=count, what="test")) as results:
            for outcomes in results:
                played.append(Played(outcomes, time.perf_counter() - started))
                if kept is not None:
                    kept.keep(played[-1])
                if progress is not None:
                    progress(len(played))
    except KeyboardInterrupt:
        cut_short = INTERRUPTED
    except WorkerLostError as error:
        cut_short = str(error)
    return Results(
        plan,
        outcomes=tuple(one.outcomes[0] for one in played),
        unfitted=tuple(again for one in played for again in one.outcomes[1:]),
        seconds=time.perf_counter() - started,
        cut_short=cut_short,
    )
