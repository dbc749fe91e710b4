"""The robot's code against hand-made surroundings: no world, no physics."""

from collections.abc import Callable, Generator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import pytest

from handover.collector.code import TRANSITIONS
from handover.robot.behaviour import CORRECT, LEGACY, Behaviour
from handover.robot.handover import STATES, HandoverRobot
from handover.robot.ports import Message, Reading


@dataclass
class Path:
    duration: float


@dataclass
class AttemptJudge:
    """Bus, arm, gripper and sensors in one, with a clock that the waits of the robot drive."""

    signals: list[Message] = field(default_factory=list)
    reading: Callable[[float], Reading] = lambda _: Reading(gaze=True, pressure=True, location=True)
    reachable: bool = True
    hand: float | None = 0.5
    timeout_time: int = 50
    time: float = 0.0
    log: list[tuple[float, str, object]] = field(default_factory=list)
    subscriptions: int = 0
    commands: list[str] = field(default_factory=list)

    @property
    def params(self) -> dict[str, Any]:
        pose = (1.0, -2.0, -0.5)
        return {"zero_pose": pose, "start_pose": pose, "timeout_time": self.timeout_time}

    def now(self) -> float:
        return self.time

    def publish(self, topic: str, value: Any = None, **_latched: bool) -> None:
        self.log.append((self.time, topic, value))

    def subscribe(self, _topic: str) -> None:
        self.subscriptions += 1

    def receive(self, _topic: str) -> Message | None:
        heard = [message for message in self.signals if message.stamp <= self.time]
        return heard[-1] if heard else None

    def plan(self, _x: float, _z: float) -> Generator[float, None, Path | None]:
        yield 2.0
        return Path(1.0) if self.reachable else None

    def interpolate(self, _joints: tuple[float, float, float], duration: float) -> Path:
        return Path(duration)

    def follow(self, path: Path, **_minds_people: bool) -> Generator[float, None, bool]:
        yield path.duration
        return True

    def open(self) -> None:
        self.commands.append("open")

    def close(self) -> None:
        self.commands.append("close")

    def piece(self) -> tuple[float, float]:
        return 0.2, 0.2

    def hand_distance(self) -> float | None:
        return self.hand

    def sense(self) -> Reading:
        return self.reading(self.time)

    def play(
        self,
        behaviour: Behaviour = CORRECT,
        *,
        robot: type[HandoverRobot] = HandoverRobot,
        until: float = 300.0,
    ) -> HandoverRobot:
        machine = robot(self, self, self, self, behaviour)
        for wait in machine.run():
            self.time += wait
            if self.time > until:
                break
        return machine

    def states(self) -> list[str]:
        names = [str(value) for _, topic, value in self.log if topic == "robot_state"]
        return [name for i, name in enumerate(names) if i == 0 or names[i - 1] != name]

    def times(self, topic: str) -> list[float]:
        return [time for time, name, _ in self.log if name == topic]


def protocol(ready_after: float = 25.0) -> list[Message]:
    """The signals of a human who follows the protocol."""
    return [Message("activateRobot", 5.0), Message("humanIsReady", ready_after)]


def test_handover_goes_through_all_states() -> None:
    bench = AttemptJudge(protocol())
    bench.play()
    assert bench.states() == list(STATES)
    assert bench.times("released")
    assert bench.commands == ["open", "close", "open"]


def test_legacy_reads_missing_as_bad() -> None:
    """The legacy robot takes a sensor without a reading for a bad one, at once."""
    nothing = Reading(gaze=None, pressure=None, location=None)
    bench = AttemptJudge(protocol(), reading=lambda _: nothing)
    bench.play(LEGACY)
    assert ("gpl_is_ok", False) in [(topic, value) for _, topic, value in bench.log]


@pytest.mark.parametrize("signal", ["activateRobot", "humanIsReady"])
def test_legacy_takes_any_signal_twice(signal: str) -> None:
    """One latched signal, right or wrong, carries the legacy robot through both waits."""
    bench = AttemptJudge([Message(signal, 3.0)])
    bench.play(LEGACY)
    assert bench.states()[-2:] == ["release", "done"]


def test_legacy_shares_its_polls() -> None:
    """The legacy robot has 500 polls for both waits together, and subscribes in each."""
    bench = AttemptJudge([Message("activateRobot", 21.0)])
    no_readiness = replace(LEGACY, readiness=frozenset())
    bench.play(no_readiness)
    assert bench.subscriptions == 500
    moving = bench.times("informed")[0] + 0.5 - 21.0
    assert bench.times("timed_out")[0] == pytest.approx(1.0 + 100.0 + moving, abs=0.21)


def test_legacy_sensing_timeout_is_a_parameter() -> None:
    """The legacy robot times out when its parameter has passed since it informed the human."""
    in_time = AttemptJudge(protocol(), timeout_time=100)
    in_time.play(LEGACY)
    assert in_time.times("decide")
    late = AttemptJudge(protocol(), timeout_time=3)
    late.play(LEGACY)
    assert not late.times("decide")
    assert late.times("timed_out")


@pytest.mark.parametrize(("hand", "closes"), [(0.05, False), (0.07, True), (None, True)])
def test_gripper_does_not_close_on_a_hand(hand: float | None, closes: bool) -> None:
    """A hand that is seen in the grip ends the task; only the legacy robot closes on it."""
    bench = AttemptJudge(protocol(), hand=hand)
    bench.play()
    assert bool(bench.times("released")) is closes
    assert ("close" in bench.commands) is closes
    legacy = AttemptJudge(protocol(), hand=hand)
    legacy.play(LEGACY)
    assert "close" in legacy.commands


def test_transitions_are_those_of_the_protocol() -> None:
    """The protocol's transitions occur, and no others, whatever the human does."""
    nothing = Reading(gaze=None, pressure=None, location=None)
    bad = Reading(gaze=False, pressure=True, location=True)
    benches = [
        AttemptJudge(protocol()),
        AttemptJudge(protocol(), reading=lambda _: bad),
        AttemptJudge(protocol(), reading=lambda _: nothing),
        AttemptJudge([Message("activateRobot", 5.0)]),
        AttemptJudge(),
        AttemptJudge(protocol(), reachable=False),
    ]
    seen: set[tuple[str, str]] = set()
    for bench in benches:
        bench.play()
        names = [str(value) for _, topic, value in bench.log if topic == "robot_state"]
        seen |= set(pairwise(names))
    assert seen == set(TRANSITIONS)
