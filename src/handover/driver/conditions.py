"""The conditions of one run that a test leaves to chance."""

from __future__ import annotations

from dataclasses import dataclass

from handover.world.kinematics import Joints


@dataclass(frozen=True, slots=True)
class Conditions:
    """The seeded conditions of one run; the posture ranges are drawn as they are needed.

    Attributes:
        human_start_s: when the human's script starts.
        connected: whether the human's signals reach the robot at all.
        timeout_time_s: the parameter of the legacy robot.
        poll_growth_s: how much each subscription slows a poll down.
        start_pose: joint angles after the reset, rad.
    """

    human_start_s: float
    connected: bool
    timeout_time_s: int
    poll_growth_s: float
    start_pose: Joints
