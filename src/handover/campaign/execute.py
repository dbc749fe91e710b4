"""Play a plan on all cores; whatever ends it early, the finished tests are kept."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import groupby

from handover.campaign.outcome import Outcome, Results
from handover.campaign.plan import Job, Plan
from handover.campaign.play import Chunk, Played, play
from rvmon.children import workers

CHUNK = 25
"""Tests per chunk at most: the start of a chunk costs about as much as one test."""

CHUNKS_PER_WORKER = 4
"""At least so many chunks for each worker, so that all end at about the same time."""

INTERRUPTED = "interrupted"
WORKER_DIED = "a worker process died"

Progress = Callable[[int], None]
"""Called with the number of tests that have been finished since the last call."""


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
    count = jobs or os.cpu_count() or 1
    outcomes, cut_short = _execute(plan, plan.jobs(), count, progress)
    repeated: list[Outcome] = []
    if unfitted and not cut_short:
        lost = [replace(one.job, startup_loss=False) for one in outcomes if not one.connected]
        repeated, cut_short = _execute(plan, lost, count, None)
    seconds = time.perf_counter() - started
    return Results(plan, tuple(outcomes), tuple(repeated), seconds, cut_short)


def _execute(
    plan: Plan, jobs: Sequence[Job], count: int, progress: Progress | None
) -> tuple[list[Outcome], str]:
    played: list[Played] = []

    def keep(one: Played) -> None:
        played.append(one)
        if progress is not None:
            progress(len(one.outcomes))

    chunks = _chunks(plan, jobs, count)
    run = _here if count == 1 or len(chunks) < 2 else _in_workers
    cut_short = run(chunks, count, keep)
    played.sort(key=lambda one: one.chunk.start)
    return [outcome for one in played for outcome in one.outcomes], cut_short


def _chunks(plan: Plan, jobs: Sequence[Job], count: int) -> list[Chunk]:
    size = max(1, min(CHUNK, len(jobs) // (count * CHUNKS_PER_WORKER)))
    chunks: list[Chunk] = []
    start = 0
    for robot, group in groupby(jobs, key=lambda job: job.robot):
        of_robot = list(group)
        for first in range(0, len(of_robot), size):
            some = tuple(of_robot[first : first + size])
            chunks.append(Chunk(start, some, plan.specs[robot] if plan.monitors else None))
            start += len(some)
    return chunks


def _here(chunks: Sequence[Chunk], _count: int, keep: Callable[[Played], None]) -> str:
    try:
        for chunk in chunks:
            one = play(chunk)
            keep(one)
            if len(one.outcomes) < len(chunk.jobs):
                return INTERRUPTED
    except KeyboardInterrupt:  # between two chunks
        return INTERRUPTED
    return ""


def _in_workers(chunks: Sequence[Chunk], count: int, keep: Callable[[Played], None]) -> str:
    # Workers that are spawned inherit no threads and no state, on every platform.
    with workers(min(count, len(chunks)), "spawn") as pool:
        with _without_interrupts():
            waiting: set[Future[Played]] = {pool.submit(play, chunk) for chunk in chunks}
        try:
            for future in as_completed(tuple(waiting)):
                waiting.remove(future)
                keep(future.result())
        except KeyboardInterrupt:
            # After a second one, what is not here by now is lost.
            with suppress(KeyboardInterrupt, BrokenProcessPool):
                for future in [one for one in waiting if not one.cancel()]:
                    keep(future.result())  # a worker has it already
            return INTERRUPTED
        except BrokenProcessPool:
            return WORKER_DIED
    return ""


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Processes that are started here ignore Ctrl-C, from their first instruction on.

    It reaches all processes of a terminal; this one ends the campaign, workers finish what they
    have. Only the main thread can say so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    known = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, known)
