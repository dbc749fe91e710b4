"""The least step of stamps, and whether what is read as seconds looks like milliseconds."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from rvmon.trace.health import Health, HealthKind
from rvmon.trace.schema import Stamps
from rvmon.trace.time import TICKS_PER_SECOND, format_ticks

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


_LONG = 10_000 * TICKS_PER_SECOND


def doubt_unit(times: Sequence[int], stamps: Stamps) -> list[Health]:
    """A remark if stamps look like milliseconds.

    They do if their median step would be 5 s or more, and either all are whole numbers or a
    thousand of them would take 10,000 s or more. A unit that a person has named is not doubted.

    Args:
        times: the first `LOOKED_AT` instants of a recording in ticks, or all.
        stamps: as which they were read.

    >>> doubt_unit([20 * TICKS_PER_SECOND * k for k in range(10)], Stamps("t", "s"))[0].remark
    'from stamp to stamp it is 20 s: are these milliseconds? `--time t:ms` (if not: `--time t:s`)'
    """
    if stamps.is_stated or stamps.unit != "s" or len(times) < FEWEST:
        return []
    step = median_step(times)
    whole = all(t % TICKS_PER_SECOND == 0 for t in times)
    long = len(times) >= LOOKED_AT and times[-1] - times[0] >= _LONG
    if step < LONG_STEP * TICKS_PER_SECOND or not (whole or long):
        return []
    column = stamps.column
    remark = (
        f"from stamp to stamp it is {format_ticks(int(step))}: are these milliseconds? "
        f"`--time {column}:ms` (if not: `--time {column}:s`)"
    )
    return [Health(HealthKind.UNIT, column, 1, times[0], remark=remark)]
