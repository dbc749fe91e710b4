"""The arm's kinematics, its paths, and smooth motion between two states."""

from __future__ import annotations

import math
from dataclasses import dataclass

from handover.world.parameters import FOREARM, SHOULDER, UPPER_ARM, WRIST_TO_GRIP

Joints = tuple[float, float, float]
"""Angles of shoulder, elbow and wrist, each relative to the previous link, rad."""

DOWN = -math.pi / 2


def grip_point(joints: Joints) -> tuple[float, float]:
    """The middle of the pads, (x, z) in metres."""
    a = joints[0]
    b = a + joints[1]
    c = b + joints[2]
    return (
        SHOULDER[0] + UPPER_ARM * math.cos(a) + FOREARM * math.cos(b) + WRIST_TO_GRIP * math.cos(c),
        SHOULDER[1] + UPPER_ARM * math.sin(a) + FOREARM * math.sin(b) + WRIST_TO_GRIP * math.sin(c),
    )


def joints_for(x: float, z: float) -> Joints | None:
    """The joint angles that bring the grip to a point (metres), gripper down and elbow up.

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


def between(start: Joints, goal: Joints, share: float) -> Joints:
    """The joint angles at a share of the way, linearly interpolated."""
    return (
        start[0] + (goal[0] - start[0]) * share,
        start[1] + (goal[1] - start[1]) * share,
        start[2] + (goal[2] - start[2]) * share,
    )


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A path in joint space, at rest at both ends."""

    start: Joints  # joint angles, rad
    goal: Joints  # joint angles, rad
    duration: float  # seconds


def min_jerk(share: float) -> float:
    """The share of a rest-to-rest path that is covered after `share` of its time.

    Source: Flash and Hogan 1985, "The coordination of arm movements", equation for a straight
    reach. The speed peaks in the middle, at 1.875 times the mean speed.

    >>> min_jerk(0.0), min_jerk(0.5), min_jerk(1.0)
    (0.0, 0.5, 1.0)
    """
    u = min(max(share, 0.0), 1.0)
    return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)


PEAK_OVER_MEAN = 1.875
"""Ratio of peak speed to mean speed of a rest-to-rest minimum-jerk motion."""

Quintic = tuple[float, float, float, float, float, float]


def quintic(start: float, speed: float, goal: float, duration: float) -> Quintic:
    """Coefficients of the minimum-jerk path from a moving start to rest at `goal`.

    With `speed` 0 this is `min_jerk`, scaled. Other speeds allow to redirect a motion under way
    without a jump in speed (acceleration starts and ends at zero).

    Args:
        start: position now.
        speed: velocity now, per second.
        goal: position at the end.
        duration: seconds, positive.

    Returns:
        c0 … c5 of the polynomial in seconds since the start.
    """
    t = duration
    d = goal - start
    return (
        start,
        speed,
        0.0,
        (10 * d - 6 * speed * t) / t**3,
        (-15 * d + 8 * speed * t) / t**4,
        (6 * d - 3 * speed * t) / t**5,
    )


def evaluate(path: Quintic, t: float) -> float:
    """The position on a path, `t` seconds after its start.

    >>> evaluate(quintic(1.0, 0.0, 3.0, 2.0), 1.0)
    2.0
    """
    c0, c1, c2, c3, c4, c5 = path
    return c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))


def slope(path: Quintic, t: float) -> float:
    """The speed on a path, `t` seconds after its start."""
    _, c1, c2, c3, c4, c5 = path
    return c1 + t * (2 * c2 + t * (3 * c3 + t * (4 * c4 + t * 5 * c5)))
