"""Calls of functions as events."""

import asyncio

import pytest

from rvmon import Verdict, loads
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
    """On a clock that stands."""
    return Driver(loads(SPEC), clock=SimulatedClock())


def _verdict(driver):
    return driver.close()[""][0].verdicts["R"]


def test_a_call_is_an_event_with_its_arguments(driver):
    """The function does what it did, and keeps its name."""

    @as_event(driver, "grip", ended="gripped", payload=lambda width: {"width": width})
    def close_gripper(width):
        return width * 2

    assert close_gripper(0.5) == 1.0
    assert close_gripper.__name__ == "close_gripper"
    assert _verdict(driver) is Verdict.PASS


def test_a_call_that_raises_has_not_ended(driver):
    """What it raises comes out."""

    @as_event(driver, "grip", ended="gripped", payload=lambda: {"width": 1.0})
    def close_gripper():
        raise KeyError("jammed")

    with pytest.raises(KeyError, match="jammed"):
        close_gripper()
    assert _verdict(driver) is Verdict.INCONCLUSIVE


def test_a_coroutine_ends_when_it_was_awaited(driver):
    """Not when it is made."""

    @as_event(driver, "grip", ended="gripped", payload=lambda width: {"width": width})
    async def close_gripper(width):
        await asyncio.sleep(0)
        return width

    assert asyncio.run(close_gripper(3.0)) == 3.0
    assert _verdict(driver) is Verdict.PASS
