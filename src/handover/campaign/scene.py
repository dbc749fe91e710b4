"""The recorded poses of a run as a scene for its page."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rvmon.report.scene import Outline, Scene

if TYPE_CHECKING:
    from handover.world.poses import Poses

ROLES = {
    "upper_arm": "link",
    "forearm": "link",
    "palm": "gripper",
    "left_finger": "gripper",
    "right_finger": "gripper",
    "piece": "piece",
    "hand": "person",
    "head": "person",
}
"""How each body is coloured; every other one is ground."""

VIEW = (-0.62, -0.1, 1.18, 0.95)
"""Metres: from behind the robot's shoulder to behind the human's head, the table below."""

GAZE_LENGTH = 0.55
GAZE_HALF_ANGLE = math.radians(12)


def scene_of(poses: Poses) -> Scene:
    """Colour the bodies and add the cone in which the human looks."""
    outlines = [
        Outline(one.body, one.corners, one.radius, ROLES.get(one.body, "ground"))
        for one in poses.outlines
    ]
    x, z = GAZE_LENGTH, GAZE_LENGTH * math.tan(GAZE_HALF_ANGLE)
    outlines.append(Outline("head", ((0.0, 0.0), (x, -z), (x, z)), 0.0, "gaze"))
    return Scene(poses.bodies, tuple(outlines), poses.frames, VIEW)
