"""The order in which samples come."""

from __future__ import annotations

from rvmon.errors import TimeOrderError
from rvmon.trace.time import format_ticks


def refuse_earlier(t: int, last: int | None, reached: int | None) -> None:
    """Refuse a sample at `t` ticks that does not come behind what was taken.

    Args:
        t: its instant.
        last: that of the sample before; `None`: there was none.
        reached: the instant that time has come to.

    Raises:
        TimeOrderError: it is not later, or an `advance` ruled it out.
    """
    if last is not None and t <= last:
        raise TimeOrderError(
            f"sample at {format_ticks(t)} is not after the one at {format_ticks(last)}: "
            "merge what has equal stamps (settle='next' does), sort what is out of order"
        )
    if reached is not None and t < reached:
        raise TimeOrderError(
            f"sample at {format_ticks(t)}, but advance({format_ticks(reached)}) promised that "
            "none before would come: advance later, or drop the sample"
        )
