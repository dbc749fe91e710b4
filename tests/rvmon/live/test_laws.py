"""A driver and a monitor agree on random samples."""

import random

import pytest
from tests.tools.differential import case_of

from rvmon.live import Driver, SimulatedClock
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

pytestmark = pytest.mark.law


def _driven(spec, case, rng):
    """A driver that was offered the samples of a case at their stamps."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, keep=None, sources=case.names)
    for sample in case.samples:
        if sample.t > clock.now_ns():
            clock.set_ns(sample.t)
        driver.offer(sample.values, t_ns=sample.t)
        if rng.random() < 0.3:
            driver.work()
    clock.set_ns(max(clock.now_ns(), case.samples[-1].t) + 1)
    return driver, clock


def _monitored(spec, case, end):
    """The report of a monitor on the same samples."""
    monitor = spec.monitor(settle="next", sources=case.names)
    for sample in case.samples:
        monitor.step_ns(sample.t, sample.values)
    monitor.advance_ns(end)
    return monitor.finish_ns()


def test_a_driver_with_room_gives_the_report_of_a_monitor():
    """Loss for lack of room is tested in `laws/test_doors.py`."""
    judged = 0
    for number in range(60):
        seed = f"live/{number}"
        case = case_of(seed, Profile(requirements=2), TraceProfile())
        if not case.samples or case.spec.max_delay:
            continue
        spec = Spec(case.spec)
        driver, clock = _driven(spec, case, random.Random(seed))
        wanted = _monitored(spec, case, clock.now_ns())
        (report,) = driver.close()[""]
        assert report.attempts == wanted.attempts, seed
        assert report.verdicts == wanted.verdicts, seed
        judged += len(wanted.attempts)
    assert judged > 50
