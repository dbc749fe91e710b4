"""Play, judge and measure tests: one after the other in a process, or a whole plan on all cores."""

from __future__ import annotations

import os
import pickle
import sys
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import chdir, closing, nullcontext, redirect_stdout
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from rvmon.cdv.campaign import Campaign, Robot
from rvmon.cdv.campaign_plan import Job, Outcome, Plan, Played, Results
from rvmon.cdv.code_coverage import Meter, hits_of_states
from rvmon.cdv.resume import Unfinished
from rvmon.cdv.system import Checker, Code, Observer, Run, System, Taker, Values
from rvmon.cdv.test import TestError, blamed
from rvmon.coverage import Ending, Hits
from rvmon.errors import RvmonError
from rvmon.execute import Ended, parallel
from rvmon.texts import escaped_line
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from rvmon.cdv.test import Test
    from rvmon.verdicts.report import Report


def player(
    robots: Mapping[str, Robot],
    code: Code | None,
    control: Callable[[Any], Test | None] | None,
    spool: Path | None = None,
) -> Callable[[Job], tuple[Outcome, Outcome | None]]:
    """Make the function that plays a job in this process.

    It returns the outcome of the test, and the outcome of its control if it has one.

    Args:
        robots: by name.
        code: the code whose coverage is measured.
        control: makes the control of a test.
        spool: a folder for recordings, from which pages are made. They are unpickled, so only this
            user may have access to it.

    Raises:
        RvmonError: a system cannot be made, or the requirements are wrong.
    """
    benches = {name: Bench(name, robot, code, covers=True) for name, robot in robots.items()}

    def played(job: Job) -> tuple[Outcome, Outcome | None]:
        bench, keeps = benches[job.robot], spool is not None
        recorded = bench.play(job.test, keeps=keeps, wants_scene=keeps)
        if spool is not None:
            recording_path(spool, job).write_bytes(pickle.dumps(recorded))
        outcome = outcome_of(recorded)
        with blamed(f"test `{job.test.name}`: its control cannot be made"):
            variant = None if control is None else control(job.test)
        return outcome, None if variant is None else outcome_of(bench.play(variant))

    return played


def recording_path(spool: Path, job: Job) -> Path:
    """The file of a test's recording."""
    return spool / f"{job.robot}-{job.test.name}"


class Recorded(NamedTuple):
    """A played test with its verdicts, its coverage and, if requested, its samples."""

    run: Run  # what the system returned
    report: Report  # the verdicts
    samples: Sequence[tuple[int, Values]]  # empty unless they were kept
    hits: Hits  # of the measured items
    illegal: tuple[str, ...]  # hits of illegal bins, in words
    seconds: float  # wall time, including judging
    cpu_s: float  # processor time of this process while it played

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        """The verdicts, by requirement."""
        return self.report.verdicts


class Bench:
    """A robot with its system, monitor and coverage measurement; it plays one test after the other.

    Args:
        name: name of the robot.
        robot: the robot.
        code: the code whose coverage is measured.
        covers: whether the hits of its coverage models are collected.

    Raises:
        RvmonError: the system cannot be made; the message says why.
    """

    def __init__(
        self, name: str, robot: Robot, code: Code | None = None, *, covers: bool = False
    ) -> None:
        with blamed(f"robot `{name}`: its system cannot be made", RvmonError):
            self._system: System[Any] = robot.system()
        self._checker = Checker(robot.requirements, robot.coverages if covers else ())
        self._meter = None if code is None else Meter(code)
        self._marked = code is not None and code.marked

    def play(self, test: Test, *, keeps: bool = False, wants_scene: bool = False) -> Recorded:
        """Play a test, keeping its samples if `keeps`; an exception of the robot is a result.

        Raises:
            TestError: the test cannot be played.
        """
        started, samples = time.perf_counter(), list[tuple[int, Values]]()
        takers: list[Taker] = [self._checker.observe]
        if keeps:
            takers.append(lambda t_ns, values: samples.append((t_ns, dict(values))))
        self._checker.start()
        if self._meter is not None:
            self._meter.start()
        measured = self._meter or nullcontext()
        marked = measured if self._marked else None
        observer = Observer(takers, code=marked, wants_scene=wants_scene)
        cpu_started = time.process_time()
        # Measure all of `play`, or only what the system runs within `observer.code()`.
        with nullcontext() if self._marked else measured:
            run = run_of(self._system, test, observer)
        cpu_s = time.process_time() - cpu_started
        hits = hits_of_states(run)
        if self._meter is not None:
            hits |= self._meter.hits()
        covered = self._checker.hits(run.end_ns)
        report = self._checker.finish(run.end_ns)
        illegal = tuple(hit.sentence(report.origin) for hit in self._checker.illegal(covered))
        seconds = time.perf_counter() - started
        return Recorded(run, report, samples, {**hits, **covered}, illegal, seconds, cpu_s)


def run_of(system: System[Any], test: Test, observer: Observer) -> Run:
    """Play a test; an exception of the system ends the run at its last sample.

    Output of the system goes to standard error, as standard output is for results. The working
    directory is restored afterwards.

    Raises:
        TestError: the system raises it, as it cannot play the test.
    """
    try:
        with redirect_stdout(sys.stderr), chdir(os.curdir):
            run: object = system.play(test, observer)
    except TestError:
        raise
    except Exception as error:  # noqa: BLE001 - the system may raise anything
        return Run(observer.last_ns, error=f"{type(error).__name__}: {error}")
    if not isinstance(run, Run):
        return Run(observer.last_ns, error=f"`play` returned {run!r}, which is not a Run")
    if run.end_ns < observer.last_ns:
        message = f"it ended at {run.end_ns} ns, before its last sample, at {observer.last_ns} ns"
        return replace(run, end_ns=observer.last_ns, error=run.error or message)
    return run


def outcome_of(recorded: Recorded) -> Outcome:
    """The part of a recorded test that a campaign keeps."""
    run, report = recorded.run, recorded.report
    return Outcome(
        verdicts=report.verdicts,
        reasons=_reasons(report),
        illegal=recorded.illegal,
        hits=recorded.hits,
        ending=Ending.COMPLETED if run.error is None else Ending.CRASHED,
        error=run.error,
        end_ns=run.end_ns,
        figures=run.figures,
        seconds=recorded.seconds,
    )


def _reasons(report: Report) -> dict[str, str]:
    failed = (name for name, verdict in report.verdicts.items() if verdict is Verdict.FAIL)
    first = {name: next(report.of(name, Verdict.FAIL), None) for name in failed}
    return {name: escaped_line(str(attempt)) for name, attempt in first.items() if attempt}


INTERRUPTED = "interrupted"

Progress = Callable[[int], None]
"""Called with the number of finished tests."""


def execute(
    plan: Plan,
    *,
    jobs: int | str | None = None,
    controls: bool = True,
    kept: Unfinished | None = None,
    progress: Progress | None = None,
    spool: Path | None = None,
) -> Results:
    """Play all tests of a plan.

    The results do not depend on the number of processes. A test that takes too long, or that ends
    its process, is a result like any other. Ctrl-C ends the campaign with the tests played so far.

    Args:
        plan: the tests.
        jobs: number of processes, or address of a Dask scheduler; default: one process per core.
        controls: also play the controls of tests.
        kept: the journal that stores each test once it is played; tests already in it are not
            played again.
        progress: called after each test.
        spool: as for `player`.

    Raises:
        RvmonError: a system cannot be made, or no process can be started.
    """
    tests = plan.jobs() if kept is None else kept.jobs
    known = {} if kept is None else kept.known
    # Back-dated by the time that the known tests took, so that `seconds` includes it.
    started = time.perf_counter() - (kept.seconds if kept is not None else 0)
    left = [job for job in tests if (job.test.name, job.robot) not in known]
    played: list[Played] = []
    cut_short = "" if kept is None or kept.shard is None else f"shard {kept.shard}"
    try:
        playing = outcomes(plan.campaign, left, jobs=jobs, controls=controls, spool=spool)
        with closing(playing) as results:
            for job in tests:
                before = known.get((job.test.name, job.robot))
                if before is not None:
                    played.append(before)
                    continue
                played.append(Played(job, *next(results)))
                if kept is not None:
                    kept.played(played[-1], time.perf_counter() - started)
                if progress is not None:
                    progress(len(played))
    except KeyboardInterrupt:
        cut_short = INTERRUPTED
    return Results(plan, tuple(played), time.perf_counter() - started, cut_short)


def outcomes(
    campaign: Campaign,
    tests: Iterable[Job],
    *,
    jobs: int | str | None = None,
    controls: bool = True,
    spool: Path | None = None,
) -> Generator[tuple[Outcome, Outcome | None], None, None]:
    """Play tests and yield, in their order, each outcome with that of its control.

    For the arguments see `execute`.

    Raises:
        RvmonError: a system cannot be made, or no process can be started.
    """
    control = campaign.control.make if campaign.control is not None and controls else None
    for robot in campaign.robots.values():
        # Compile the specifications now, so that each process need not compile them again.
        Checker(robot.requirements, robot.coverages)
    return parallel.execute(
        tests,
        partial(player, campaign.robots, campaign.code, control, spool),
        jobs=jobs or os.cpu_count() or 1,
        what="test",
        instead=partial(_outcome_of_ended, campaign.robots),
        timeout_s=campaign.timeout_s,
    )


class JobQueue(Iterator[Job]):
    """A queue of tests to play; it can be refilled after it ran empty, for batches of tests."""

    def __init__(self) -> None:
        self.jobs: deque[Job] = deque()

    def __next__(self) -> Job:
        if not self.jobs:
            raise StopIteration
        return self.jobs.popleft()


class PlayerApart:
    """Plays one test after the other in another process, which is killed if a test takes too long.

    The process is restarted after a test that ended it or that cannot be played.

    Args:
        campaign: the campaign of the tests; code coverage is not measured.
        robot: name of the robot to test.
    """

    def __init__(self, campaign: Campaign, robot: str) -> None:
        self._campaign = replace(campaign, robots={robot: campaign.robots[robot]}, code=None)
        self._robot = robot
        self._waiting = JobQueue()
        self._results = self._start()

    def play(self, test: Test) -> Outcome:
        """Play a test and return its outcome.

        Raises:
            TestError: the test cannot be played.
            RvmonError: the system cannot be made, or the process cannot be started.
        """
        self._waiting.jobs.append(Job(test, self._robot))
        try:
            return next(self._results)[0]
        except TestError:  # a generator that has raised gives nothing more
            self._results = self._start()
            raise

    def close(self) -> None:
        """End the process."""
        self._results.close()

    def _start(self) -> Generator[tuple[Outcome, Outcome | None], None, None]:
        return outcomes(self._campaign, self._waiting, jobs=1, controls=False)


def _outcome_of_ended(robots: Mapping[str, Robot], job: Job, ended: Ended) -> tuple[Outcome, None]:
    """The outcome of a test whose process ended; all its verdicts are inconclusive."""
    ending = Ending.HUNG if ended.timed_out else Ending.LOST
    spec = robots[job.robot].requirements
    verdicts = dict.fromkeys(spec.requirements if spec else (), Verdict.INCONCLUSIVE)
    return Outcome(verdicts, {}, (), {}, ending, ended.why, 0, {}, ended.seconds), None
