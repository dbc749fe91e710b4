"""The arm's geometry: joint angles from the pose of the grip, and back."""

from __future__ import annotations

import math

from handover.world.parameters import FOREARM, SHOULDER, UPPER_ARM, WRIST_TO_GRIP

Joints = tuple[float, float, float]
"""Angles of shoulder, elbow and wrist, each against the link before, rad."""

DOWN = -math.pi / 2


def grip_point(joints: Joints) -> tuple[float, float]:
    """Where the middle of the pads is, (x, z) in metres."""
    a = joints[0]
    b = a + joints[1]
    c = b + joints[2]
    return (
        SHOULDER[0] + UPPER_ARM * math.cos(a) + FOREARM * math.cos(b) + WRIST_TO_GRIP * math.cos(c),
        SHOULDER[1] + UPPER_ARM * math.sin(a) + FOREARM * math.sin(b) + WRIST_TO_GRIP * math.sin(c),
    )


def joints_for(x: float, z: float) -> Joints | None:
    """The joint angles that bring the grip to a point, gripper down and elbow up.

    Args:
        x: metres.
        z: metres.

    Returns:
        `None` if the point is out of reach.

    >>> joints = joints_for(0.1, 0.2)
    >>> [round(value, 6) for value in grip_point(joints)]
    [0.1, 0.2]
    >>> joints_for(5.0, 0.0) is None
    True
    """
    wrist_x = x - SHOULDER[0]
    wrist_z = z + WRIST_TO_GRIP - SHOULDER[1]
    cosine = (wrist_x**2 + wrist_z**2 - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    if not -1.0 <= cosine <= 1.0:
        return None
    elbow = -math.acos(cosine)
    shoulder = math.atan2(wrist_z, wrist_x) - math.atan2(
        FOREARM * math.sin(elbow), UPPER_ARM + FOREARM * math.cos(elbow)
    )
    return shoulder, elbow, DOWN - shoulder - elbow
