"""Latched messages, publishers that end, and reads that become slow."""

import pytest

from handover.world.bus import Bus, Node, Schedule, Value
from handover.world.parameters import LATCH_LINGER_S, NS


def at(schedule: Schedule, seconds: float) -> None:
    schedule.at(round(seconds * NS), lambda: None)
    schedule.run_next()


def two_nodes() -> tuple[Schedule, Bus, Node, Node]:
    schedule = Schedule()
    bus = Bus(schedule)
    return schedule, bus, Node(bus, {}, 0.0), Node(bus, {}, 0.0)


def test_latched_message_is_read_later() -> None:
    """Who subscribes late still gets the latched message, with the time of its publication."""
    schedule, _, human, robot = two_nodes()
    human.publish("signal", "ready", latched=True)
    at(schedule, 5.0)
    robot.subscribe("signal")
    message = robot.receive("signal")
    assert message is not None
    assert (message.value, message.stamp) == ("ready", 0.0)


def test_latched_message_vanishes_after_its_publisher() -> None:
    """A latched message outlives its publisher by the linger time and no longer."""
    schedule, _, human, robot = two_nodes()
    robot.subscribe("signal")
    human.publish("signal", "ready", latched=True)
    at(schedule, 1.0)
    human.end()
    at(schedule, 1.0 + LATCH_LINGER_S)
    assert robot.receive("signal") is not None
    at(schedule, 1.0 + LATCH_LINGER_S + 0.01)
    assert robot.receive("signal") is None


def test_unlatched_message_cannot_be_read_later() -> None:
    _, bus, human, robot = two_nodes()
    passed: list[tuple[str, Value]] = []
    bus.tap(lambda topic, value: passed.append((topic, value)))
    robot.subscribe("signal")
    human.publish("signal", True)
    assert robot.receive("signal") is None
    assert passed == [("signal", True)]


def test_reading_needs_a_subscription() -> None:
    _, _, human, robot = two_nodes()
    human.publish("signal", "ready", latched=True)
    assert robot.receive("signal") is None


def test_reads_slow_down_with_leaked_subscriptions() -> None:
    bus = Bus(Schedule())
    node = Node(bus, {}, 0.001)
    node.subscribe("signal")
    node.receive("signal")
    assert node.take_delay_s() == 0.0
    for _ in range(4):
        node.subscribe("signal")
    node.receive("signal")
    node.receive("signal")
    assert node.take_delay_s() == pytest.approx(0.008)
    assert node.take_delay_s() == 0.0
