"""`as_event` reports calls of functions as events."""

import asyncio

import pytest

from rvmon import RvmonError, Verdict, loads
from rvmon.live import Driver, SimulatedClock, as_event

SPEC = """
spec s
event grip(width: real), gripped(width: real)
requirement R
  upon grip
  then within 2 s (gripped and gripped.width == w)
  let w = grip.width
"""


@pytest.fixture
def driver():
    return Driver(loads(SPEC), clock=SimulatedClock())


def _verdict(driver):
    return driver.close()[""][0].verdicts["R"]


def test_a_call_is_an_event_with_its_arguments(driver):
    @as_event(driver, "grip", ended="gripped", payload=lambda width: {"width": width})
    def close_gripper(width):
        return width * 2

    assert close_gripper(0.5) == 1.0
    assert close_gripper.__name__ == "close_gripper"
    assert _verdict(driver) is Verdict.PASS


def test_a_coroutine_ends_once_awaited_unless_it_raises(driver):
    @as_event(driver, "grip", ended="gripped", payload=lambda width: {"width": 1 / width})
    async def close_gripper(width):
        await asyncio.sleep(0)
        return 1 / (width - 1)

    with pytest.raises(ZeroDivisionError):
        asyncio.run(close_gripper(1.0))
    assert driver.waiting == 1
    assert asyncio.run(close_gripper(3.0)) == 0.5
    assert driver.waiting == 3
    assert _verdict(driver) is Verdict.PASS


def test_a_generator_ends_only_when_it_is_exhausted():
    clock = SimulatedClock()
    driver = Driver(loads(SPEC), clock=clock)

    @as_event(driver, "grip", ended="gripped", payload=lambda width: {"width": width})
    def close_gripper(width):
        yield from range(2)
        return width

    close_gripper(1.0)
    left = close_gripper(2.0)
    next(left)
    left.close()
    clock.set_ns(1)
    assert list(close_gripper(3.0)) == [0, 1]
    clock.set_ns(2)
    driver.work()
    status = driver.status()[""]
    assert (status.counts["R", Verdict.PASS], status.open_counts["R"], status.samples) == (1, 1, 3)


def test_neither_a_wrong_payload_nor_a_closed_driver_stops_a_call(driver, caplog):
    @as_event(driver, "grip", payload=lambda width: {"width": 1 / width})
    def close_gripper(width):
        return width

    assert close_gripper(0) == 0
    assert _verdict(driver) is Verdict.INCONCLUSIVE
    assert close_gripper(1) == 1
    assert [record.args[0] for record in caplog.records if record.args] == ["grip", "grip"]


def test_classes_asynchronous_generators_and_values_are_refused(driver):
    async def asynchronous():
        yield 1

    for what in (Verdict, asynchronous, 3):
        with pytest.raises(RvmonError, match="decorate"):
            as_event(driver, "grip")(what)
