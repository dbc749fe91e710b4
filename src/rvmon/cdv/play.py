"""Play tests one after the other in one process, judged and measured."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rvmon.cdv.campaign import Robot
from rvmon.cdv.checker import Checker
from rvmon.cdv.code import Code
from rvmon.cdv.coverage import spec_coverages
from rvmon.cdv.files import TestError
from rvmon.cdv.measured import hits_of_states
from rvmon.cdv.meter import Meter
from rvmon.cdv.outcome import Outcome
from rvmon.cdv.plan import Job
from rvmon.cdv.system import Observer, Run, System
from rvmon.coverage.hits import Hits
from rvmon.coverage.record import Ending
from rvmon.diagnostics.shown import shown_line
from rvmon.errors import RvmonError
from rvmon.session import load
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rvmon.cdv.abstract_test import Test
    from rvmon.verdict.report import Report


def player(
    robots: Mapping[str, Robot],
    code: Code | None,
    control: Callable[[Any], Test | None] | None,
) -> Callable[[Job], tuple[Outcome, Outcome | None]]:
    """What plays a job in this process: its outcome, and that of its control.

    Args:
        robots: by name.
        code: whose coverage is measured.
        control: makes the control of a test.

    Raises:
        RvmonError: a system cannot be made, or the requirements are wrong.
    """
    benches = {name: _Bench(name, robot, code) for name, robot in robots.items()}

    def played(job: Job) -> tuple[Outcome, Outcome | None]:
        bench = benches[job.robot]
        outcome = bench.play(job.test)
        try:
            beside = None if control is None else control(job.test)
        except Exception as error:
            message = f"test `{job.test.name}`: its control cannot be made: {_error_text(error)}"
            raise TestError(message) from error
        return outcome, None if beside is None else bench.play(beside)

    return played


class _Bench:
    """One robot with all that plays, judges and measures it."""

    def __init__(self, name: str, robot: Robot, code: Code | None) -> None:
        self._system = system_of(name, robot)
        spec = None if robot.spec is None else load(robot.spec)
        self._checker = Checker(spec, spec_coverages(robot))
        self._meter = None if code is None else Meter(code)
        self._marked = code is not None and code.marked

    def play(self, test: Test) -> Outcome:
        """Play a test; whatever its code raises is its result."""
        started = time.perf_counter()
        self._checker.begin()
        if self._meter is not None:
            self._meter.begin()
        measured = self._meter or nullcontext()
        observer = Observer((self._checker.observe,), code=measured if self._marked else None)
        with nullcontext() if self._marked else measured:
            run = run_of(self._system, test, observer)
        hits = hits_of_states(run)
        if self._meter is not None:
            hits |= self._meter.hits()
        found = self._checker.hits(run.end_ns)
        hits |= found
        report = self._checker.finish(run.end_ns)
        illegal = tuple(map(str, self._checker.illegal(found)))
        seconds = time.perf_counter() - started
        return outcome_of(run, report, illegal=illegal, hits=hits, seconds=seconds)


def system_of(name: str, robot: Robot) -> System[Any]:
    """What plays the tests of a robot.

    Raises:
        RvmonError: it cannot be made; the message says why.
    """
    try:
        return robot.system()
    except RvmonError:
        raise
    except Exception as error:
        raise RvmonError(
            f"robot `{name}`: what plays its tests cannot be made: {_error_text(error)}"
        ) from error


def run_of(system: System[Any], test: Test, observer: Observer) -> Run:
    """Play a test; an exception that comes out ends the run at its last sample.

    Raises:
        TestError: the test cannot be played, says the system.
    """
    try:
        run: object = system.play(test, observer)
    except TestError:
        raise
    except Exception as error:  # noqa: BLE001 - of whatever kind those of the system are
        return Run(observer.last_ns, error=_error_text(error))
    if not isinstance(run, Run):
        return Run(observer.last_ns, error=f"`play` returned {run!r}, which is no Run")
    if run.end_ns < observer.last_ns:
        message = f"it ended at {run.end_ns} ns, before its last sample, at {observer.last_ns} ns"
        return replace(run, end_ns=observer.last_ns, error=run.error or message)
    return run


def outcome_of(
    run: Run,
    report: Report,
    *,
    illegal: tuple[str, ...] = (),
    hits: Hits | None = None,
    seconds: float = 0.0,
) -> Outcome:
    """What a campaign keeps of a run that came to its end.

    Args:
        run: what the system reported of it.
        report: the verdicts.
        illegal: what was hit and must not be.
        hits: what was hit, if that was measured.
        seconds: wall time that it took.
    """
    return Outcome(
        verdicts=report.verdicts,
        reasons=_reasons(report),
        illegal=illegal,
        hits=hits or {},
        ending=Ending.COMPLETED if run.error is None else Ending.CRASHED,
        error=run.error,
        end_ns=run.end_ns,
        figures=run.figures,
        seconds=seconds,
    )


def _reasons(report: Report) -> dict[str, str]:
    """The first failure of each requirement that failed."""
    failed = (name for name, verdict in report.verdicts.items() if verdict is Verdict.FAIL)
    first = {name: next(report.of(name, Verdict.FAIL), None) for name in failed}
    return {name: shown_line(str(attempt)) for name, attempt in first.items() if attempt}


def _error_text(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"
