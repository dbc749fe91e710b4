"""Whether stamps that are read as seconds look like milliseconds."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.readers.steps import FEWEST, LONG_STEP, LOOKED_AT, median_step
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.schema import Stamps
from rvmon.trace.time import TICKS_PER_SECOND, format_ticks

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
