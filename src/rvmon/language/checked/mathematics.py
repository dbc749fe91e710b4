"""Operations on numbers for which Python has no function.

An error of arithmetic, or of a value, is a result that is unknown.
"""

from __future__ import annotations

import math

EARTH = 6_371_008.8
"""The mean radius of the Earth, m.

Source: Moritz, Geodetic Reference System 1980, Journal of Geodesy 74, 2000.
"""
MOST_SHIFT = 63
"""By so many bits a whole number can be shifted."""


def nearest_whole(x: float) -> float:
    """The nearest whole number; of two, the one farther from 0.

    >>> [nearest_whole(x) for x in (0.5, -0.5, 2.5, 0.49999999999999994)]
    [1, -1, 3, 0]
    """
    whole = math.trunc(x)
    return whole + sign(x) if abs(x - whole) * 2 >= 1 else whole


def sign(x: float) -> int:
    """1, 0 or −1."""
    return (x > 0) - (x < 0)


def clamp(x: float, low: float, high: float) -> float:
    """The value, at least `low`, and then at most `high`."""
    return min(max(x, low), high)


def angle_between(a: float, b: float, turn: float = math.tau) -> float:
    """By how much to turn from a to b, the shorter way; a half turn is positive.

    >>> angle_between(170.0, -170.0, 360.0), angle_between(0.0, -180.0, 360.0)
    (20.0, 180.0)
    """
    between = math.remainder(b - a, turn)
    return -between if 2 * between == -turn else between


def distance_on_earth(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """The way along the surface of a sphere of the Earth's size, in m, of angles in rad.

    Source: Sinnott, Virtues of the Haversine, Sky and Telescope 68, 1984.

    >>> round(distance_on_earth(0.0, 0.0, math.pi / 2, 0.0))
    10007557
    """
    across = math.sin((lat2 - lat1) / 2)
    along = math.sin((lon2 - lon1) / 2)
    share = across * across + math.cos(lat1) * math.cos(lat2) * (along * along)
    return 2 * EARTH * math.asin(min(1.0, math.sqrt(share)))


def shifted_left(x: float, by: float) -> int:
    """A whole number times a power of 2."""
    return int(x) << _shift(by)


def shifted_right(x: float, by: float) -> int:
    """A whole number divided by a power of 2, rounded down."""
    return int(x) >> _shift(by)


def bit(x: float, n: float) -> int:
    """Bit n of a whole number, the least is 0; of a negative one in two's complement."""
    return int(x) >> _shift(n) & 1


def _shift(by: float) -> int:
    if not 0 <= by <= MOST_SHIFT:
        raise ValueError(by)
    return int(by)
