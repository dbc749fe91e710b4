"""Smooth paths: minimum-jerk motion between two states."""

from __future__ import annotations


def min_jerk(share: float) -> float:
    """The share of a rest-to-rest path that is covered after `share` of its time.

    Source: Flash and Hogan 1985, "The coordination of arm movements", equation for a straight
    reach. Its fastest point is the middle, 1.875 times the mean speed.

    >>> min_jerk(0.0), min_jerk(0.5), min_jerk(1.0)
    (0.0, 0.5, 1.0)
    """
    u = min(max(share, 0.0), 1.0)
    return u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)


PEAK_OVER_MEAN = 1.875
"""Fastest over mean speed of a rest-to-rest minimum-jerk motion."""

Quintic = tuple[float, float, float, float, float, float]


def quintic(start: float, speed: float, goal: float, duration: float) -> Quintic:
    """Coefficients of the minimum-jerk path from a moving start to rest at `goal`.

    With `speed` 0 this is `min_jerk` scaled; with another it lets a motion be redirected in
    flight without a jump of speed (acceleration starts and ends at zero).

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
