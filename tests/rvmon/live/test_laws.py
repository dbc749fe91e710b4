"""What a driver says of random samples, with and without loss, beside a monitor that got all."""

import random

import pytest
from tests.tools.differential import case_of
from tests.tools.sound import is_spoken_of

from rvmon.live import Driver, SimulatedClock
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.verdicts import Verdict

pytestmark = pytest.mark.law
PART, PARTS = 25, 4


def _driven(spec, case, rng, **options):
    """A driver that was offered the samples of a case as they are stamped."""
    clock = SimulatedClock(case.samples[0].t)
    driver = Driver(spec, clock=clock, keep=None, sources=case.names, **options)
    for sample in case.samples:
        if sample.t > clock.now_ns():
            clock.set_ns(sample.t)
        driver.offer(sample.values, t_ns=sample.t)
        if rng.random() < 0.3:
            driver.work()
    clock.set_ns(max(clock.now_ns(), case.samples[-1].t) + 1)
    return driver, clock


def _monitored(spec, case, end):
    """What a monitor says that was told everything."""
    monitor = spec.monitor(settle="next", sources=case.names)
    for sample in case.samples:
        monitor.step_ns(sample.t, sample.values)
    monitor.advance_ns(end)
    return monitor.finish_ns()


@pytest.mark.parametrize("part", range(PARTS))
def test_a_driver_judges_as_a_monitor_and_loss_hides_no_failure(part):
    """With room the records are equal; without, a verdict is that of all samples or I."""
    lost = 0
    for number in range(PART):
        seed = f"live/{part}/{number}"
        case = case_of(seed, Profile(requirements=2), TraceProfile())
        if not case.samples or case.spec.max_delay:
            continue
        spec, rng = Spec(case.spec), random.Random(seed)
        driver, clock = _driven(spec, case, rng)
        wanted = _monitored(spec, case, clock.now_ns())
        (report,) = driver.close()[""]
        assert report.attempts == wanted.attempts, seed
        assert report.verdicts == wanted.verdicts, seed

        driver, _ = _driven(spec, case, rng, room=rng.randint(1, 4))
        driver.close()
        status = driver.status()[""]
        lost += status.lost
        if not is_spoken_of(case.spec) or status.run > 1:
            continue
        for name, verdict in status.verdicts.items():
            failed = wanted.verdicts[name] is Verdict.FAIL
            assert verdict is Verdict.INCONCLUSIVE or (verdict is Verdict.FAIL) == failed, seed
    assert lost > 5
