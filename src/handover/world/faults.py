"""Faults of the sensors and the scene; by default there are none."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from handover.world.parameters import FRICTION

Sensor = Literal["gaze", "pressure", "location", "distance"]


class SensorFaults(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Faults of the sensors."""

    # standard deviation of every measured length, metres
    noise_m: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # age of the readings of gaze, pressure and location, seconds
    delay_s: Annotated[float, msgspec.Meta(ge=0, le=10)] = 0.0
    # dead sensors: the robot gets no reading, and the signal is unknown
    dropout: tuple[Sensor, ...] = ()
    # probability that gaze, pressure or location gives no reading when it is read
    loss: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0


class SceneFaults(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Faults of the scene."""

    # friction of the piece's surface; the gripper loses a slippery piece
    friction: Annotated[float, msgspec.Meta(ge=0.01, le=2)] = FRICTION
    # probability that the arm's planner finds no path although one exists
    plan_failure: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # probability that the robot's camera does not see the piece when it looks for it
    hidden: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # height of a block under the piece, metres
    raised_m: Annotated[float, msgspec.Meta(ge=0, le=0.1)] = 0.0
    # whether the hand is in the plane of the gripper, so that they collide, not in front of it
    hand_in_plane: bool = False
    # position along x of a person who stands beside the robot's way instead of at its end, metres;
    # the whole arm and the other hand are then in the plane
    beside_m: Annotated[float, msgspec.Meta(ge=0.3, le=1)] | None = None
    far_hand: bool = False  # whether that person takes the piece with the hand far from the robot
