"""A path of the arm as data."""

from __future__ import annotations

from dataclasses import dataclass

from handover.world.kinematics import Joints


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A path in joint space, at rest at both ends.

    Attributes:
        start: joint angles, rad.
        goal: joint angles, rad.
        duration: seconds.
    """

    start: Joints
    goal: Joints
    duration: float
