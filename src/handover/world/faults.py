"""Faults of sensors and scene; by default none."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from handover.world.parameters import FRICTION

Sensor = Literal["gaze", "pressure", "location", "distance"]


class SensorFaults(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Imperfections of the sensors."""

    # standard deviation of every measured length, metres
    noise_m: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # age of what the robot reads of gaze, pressure and location, seconds
    delay_s: Annotated[float, msgspec.Meta(ge=0, le=10)] = 0.0
    # sensors that are dead: the robot gets no reading, the signal is unknown
    dropout: tuple[Sensor, ...] = ()
    # probability that gaze, pressure or location gives no reading when it is read
    loss: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0


class SceneFaults(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Faults of the scene."""

    # of the piece's surface; a slippery piece gets lost on the way
    friction: Annotated[float, msgspec.Meta(ge=0.01, le=2)] = FRICTION
    # probability that the arm's planner finds no path where there is one
    plan_failure: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # probability that the robot's camera does not see the piece when it looks for it
    hidden: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    # height of a block that the piece stands on, metres
    raised_m: Annotated[float, msgspec.Meta(ge=0, le=0.1)] = 0.0
    # whether the hand is beside the gripper, so that they collide, and not in front of it
    hand_in_plane: bool = False
    # the place along x of a person beside the robot's way, not at its end, metres: the whole arm
    # and the other hand are then in the plane
    beside_m: Annotated[float, msgspec.Meta(ge=0.3, le=1)] | None = None
    far_hand: bool = False  # whether that person takes the piece with the hand away from the robot
