"""The steps from stamp to stamp; imported by what starts fast, it imports next to nothing."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

LOOKED_AT = 1_000
"""So many of the first stamps of a recording are looked at."""

FEWEST = 10
"""Of fewer stamps nothing is reported."""

LONG_STEP = 5
"""Seconds of a median step from which on seconds may be milliseconds."""


def median_step(times: Sequence[float]) -> float:
    """The median of the steps forward; 0 if there are none.

    >>> median_step([0, 1, 1, 3, 6])
    2
    """
    steps = sorted(then - now for now, then in pairwise(times) if then > now)
    return steps[len(steps) // 2] if steps else 0
