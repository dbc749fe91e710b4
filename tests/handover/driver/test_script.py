"""The actions of an abstract test become signals, waits and postures over time."""

import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest
from tests.tools.each import each

from handover.driver.script import INFORMED, Script
from handover.generator.abstract_test import Action, ReceiveSignal, SendSignal, SetParam, Withdraw
from handover.world import parameters as p
from handover.world.bus import Bus, Node, Schedule
from handover.world.process import Process
from handover.world.world import HUMAN_SIGNALS


@dataclass
class Body:
    """Records the human's actions."""

    schedule: Schedule
    done: list[tuple[float, str, tuple[float | bool, ...]]] = field(default_factory=list)

    def __getattr__(self, what: str) -> Callable[..., None]:
        def note(*how: float, **named: bool) -> None:
            self.done.append((self.schedule.now_ns / p.NS, what, (*how, *named.values())))

        return note


@dataclass
class Played:
    body: Body
    signals: list[tuple[float, str]]
    ended: float


def play(*actions: Action, informed_at: float | None = None, connected: bool = True) -> Played:
    schedule = Schedule()
    bus = Bus(schedule)
    signals: list[tuple[float, str]] = []

    def tap(topic: str, value: object) -> None:
        if topic == HUMAN_SIGNALS:
            signals.append((schedule.now_ns / p.NS, str(value)))

    bus.tap(tap)
    robot = Node(bus, {}, 0.0)
    if informed_at is not None:
        schedule.at(round(informed_at * p.NS), lambda: robot.publish(INFORMED, latched=True))
    body = Body(schedule)
    script = Script(
        actions,
        Node(bus, {}, 0.0),
        body,  # type: ignore[arg-type]
        random.Random(1).uniform,
        start_s=1.0,
        connected=connected,
    )
    process = Process(schedule, Node(bus, {}, 0.0), script.run())
    while schedule.next_ns() is not None:
        schedule.run_next()
    assert process.error is None
    return Played(body, signals, schedule.now_ns / p.NS)


INFORM = ReceiveSignal("informHumanOfHandoverStart")
GRASP = SetParam("hpressureOk", 1)
NOTHING = (
    *(SendSignal("setv"), ReceiveSignal("setv")),
    *(SetParam("honTask", 1), SetParam("setg", 1), SetParam("setp", 0), SetParam("setl", 1)),
    *(SetParam("h_undefGaze", 1), SetParam("h_undefPress", 1), SetParam("h_undefLoc", 0)),
)


@each(
    ("actions", "options", "signals", "done", "ended"),
    [
        # A signal is published 2 s after its action begins, and 0.2 s later the next begins.
        (
            [SendSignal("activateRobot"), SendSignal("humanIsReady")],
            {},
            [(3.0, "activateRobot"), (5.2, "humanIsReady")],
            [],
            5.4,
        ),
        # Waits are in units of 50 ms.
        ([SetParam("time", 40)], {}, [], [], 3.0),
        # Some actions of the alphabet do nothing and take no time, such as withdrawing.
        (NOTHING, {}, [], [], 1.0),
        ([Withdraw(), GRASP], {}, [], [(1.0, "withdraw"), (1.0, "grasp")], 1.0),
        # The script continues at the first poll after the robot has informed the human.
        ([INFORM, GRASP], {"informed_at": 7.3}, [], [(7.4, "grasp")], 7.4),
        # It ends after 500 polls; later actions are not played.
        ([INFORM, GRASP], {}, [], [], pytest.approx(101.0)),
        # A human who is not connected publishes nothing.
        ([SendSignal("activateRobot"), GRASP], {"connected": False}, [], [(3.2, "grasp")], 3.2),
    ],
)
def test_actions_take_their_time(
    actions: list[Action],
    options: dict[str, Any],
    signals: list[tuple[float, str]],
    done: list[tuple[float, str]],
    ended: float,
) -> None:
    played = play(*actions, **options)
    assert played.signals == signals
    assert [(t, what) for t, what, _ in played.body.done] == done
    assert played.ended == ended


def test_leaving_the_task_makes_all_postures_bad() -> None:
    """`honTask = 0` turns head, hand and grip away at once."""
    played = play(SetParam("honTask", 0))
    assert [what for _, what, _ in played.body.done] == ["look", "reach", "grasp"]
    reach, grasp = played.body.done[1][2], played.body.done[2][2]
    assert reach[2] is False
    assert grasp == (False,)


@pytest.mark.parametrize(("ok", "ranges"), [(1, p.GAZE_OK), (0, p.GAZE_BAD)])
def test_gaze_is_drawn_from_its_ranges(ok: int, ranges: tuple[tuple[float, float], ...]) -> None:
    """Offset, distance and angle are in the paper's ranges and vary."""
    played = play(*[SetParam("hgazeOk", ok)] * 50)
    looks = [how for _, _, how in played.body.done]
    assert len(set(looks)) == 50
    for look in looks:
        assert all(low <= x <= high for x, (low, high) in zip(look, ranges, strict=True))


def test_bad_location_is_off_on_both_axes_alike() -> None:
    """A bad location is 0.5 to 1 m off, the same on both axes; a good one is fixed."""
    played = play(*[SetParam("hlocationOk", 0)] * 20, SetParam("hlocationOk", 1))
    *bad, good = [how for _, _, how in played.body.done]
    assert all(dx == dz and 0.5 <= dx <= 1.0 and not near for dx, dz, near in bad)
    assert good == (*p.LOCATION_OK, True)
