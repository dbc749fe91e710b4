"""What becomes of verdicts where something goes wrong with the robot, or with who listens."""

import threading

import pytest

from rvmon import Verdict, loads
from rvmon.live import Driver, Live, SimulatedClock

S = 1_000_000_000
SPEC = """
spec s
signal speed : real{stale}
event stop
requirement SLOW
  always speed <= 1
requirement STOPS
  upon stop
  then within 2 s speed == 0
"""


@pytest.mark.parametrize(("stale", "verdicts"), [("", "PF"), (" stale after 1 s", "II")])
def test_a_publisher_that_dies_in_mid_attempt(stale, verdicts):
    """Its last value is held and the deadline missed; or, by `stale after`, nothing is known."""
    clock = SimulatedClock()
    driver = Driver(loads(SPEC.format(stale=stale)), clock=clock)
    driver.offer({"speed": 0.5, "stop": True})
    clock.set_ns(5 * S)
    driver.work()
    found = driver.close()[""][0].verdicts
    assert found["SLOW"] + found["STOPS"] == verdicts


def test_a_subscriber_that_comes_late_judges_what_it_sees():
    """What was before is not known: no pass and no failure is told of it."""
    clock = SimulatedClock(100 * S)
    driver = Driver(loads(SPEC.format(stale="")), clock=clock)
    driver.offer({"speed": 0.5})
    clock.set_ns(101 * S)
    driver.work()
    (report,) = driver.close()[""]
    assert report.verdicts == {"SLOW": Verdict.PASS, "STOPS": Verdict.NOT_TRIGGERED}
    assert [one.triggered for one in report.attempts] == [100 * S]


def test_a_slow_callback_costs_samples_that_are_counted():
    """And no verdict that needs them; who offers is never held up."""
    goes_on = threading.Event()
    live = Live(loads(SPEC.format(stale="")), room=10, on_failure=lambda _: goes_on.wait(30))
    with live:
        live.offer({"speed": 0.0})
        live.offer({"speed": 2.0})  # its failure keeps the callback busy
        taken = sum(live.offer({"speed": 0.0, "stop": True}) for _ in range(50))
        goes_on.set()
    status = live.status()[""]
    assert taken < 50
    assert (status.samples, status.lost) == (2 + taken, 50 - taken)
    assert status.verdicts == {"SLOW": Verdict.FAIL, "STOPS": Verdict.INCONCLUSIVE}
