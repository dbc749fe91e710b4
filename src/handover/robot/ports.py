"""The ports of the robot's code: bus, arm, gripper and sensors."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

Result = TypeVar("Result")
Steps = Generator[float, None, Result]
"""A blocking call: it waits by yielding seconds, and finally returns a result."""

Path = TypeVar("Path")
"""A path made by the arm's planner, which the arm follows."""


Value = bool | float | str | None
"""The content of a message; `None` if it only reports that something happened."""


@dataclass(frozen=True, slots=True)
class Message:
    """A received message."""

    value: Value
    stamp: float  # the instant of publication, seconds


class Node(Protocol):
    """The robot's connection to the message bus."""

    @property
    def params(self) -> Mapping[str, Any]:
        """The robot's parameters from the launch file."""

    def now(self) -> float:
        """Seconds since the start."""

    def publish(self, topic: str, value: Value = None, *, latched: bool = False) -> None:
        """Publish a message; a latched one can also be read later."""

    def subscribe(self, topic: str) -> None:
        """Subscribe to a topic."""

    def receive(self, topic: str) -> Message | None:
        """The topic's latched message, if there is one."""


class Arm(Protocol[Path]):
    """Plans and follows paths of the gripper."""

    def plan(self, x: float, z: float) -> Steps[Path | None]:
        """Find a path of the grip to a point (metres), gripper down and clear of people.

        The result is `None` if there is no path.
        """

    def interpolate(self, joints: tuple[float, float, float], duration: float) -> Path:
        """Make a path to joint angles (rad) of the given duration (s)."""

    def follow(self, path: Path, *, minds_people: bool = False) -> Steps[bool]:
        """Move along a path, and return at its end whether the arm got there.

        With `minds_people` the arm stops where a person comes close.
        """


class Gripper(Protocol):
    """Opens and closes; both calls return at once."""

    def open(self) -> None:
        """Start to open."""

    def close(self) -> None:
        """Start to close, and keep pressing."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A reading of the sensors; `None` if a sensor has no reading."""

    gaze: bool | None  # whether the human looks at the piece
    pressure: bool | None  # whether robot and human both hold the piece
    location: bool | None  # whether the human's hand is near the piece


class Sensors(Protocol):
    """The camera, the trackers of the human, and the pressure at the fingers."""

    def piece(self) -> tuple[float, float] | None:
        """The position (x, z) of the piece, metres; `None`: not in sight."""

    def hand_distance(self) -> float | None:
        """The distance of the hand from the gripper, metres; `None`: unknown."""

    def sense(self) -> Reading:
        """Read gaze, pressure and location."""
