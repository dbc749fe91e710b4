"""Columns of stamps as ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT, ticks_of_seconds, whole_ticks

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SECONDS = TIME_LIMIT // TICKS_PER_SECOND
"""So many whole seconds are in range."""


def ticks_of_column(seconds: NDArray[Any]) -> NDArray[np.int64]:
    """Seconds to ticks, each rounded once as `ticks_of_seconds` does.

    Raises:
        TraceError: a number is not finite or out of range.
    """
    if not len(seconds):
        return np.empty(0, np.int64)
    if seconds.dtype.kind == "i":
        _refuse(seconds, _SECONDS)
        return seconds.astype(np.int64) * TICKS_PER_SECOND
    values = seconds.astype(np.float64, copy=False)
    _refuse(values, _SECONDS + 1)
    whole = np.floor(values)
    parts = (values - whole) * 1e9
    ticks = whole.astype(np.int64) * TICKS_PER_SECOND + np.rint(parts).astype(np.int64)
    for row in np.flatnonzero(np.abs(parts - np.floor(parts) - 0.5) < 1e-5):
        ticks[row] = ticks_of_seconds(float(values[row]))
    return ticks_in_range(ticks)


def ticks_in_range(ticks: NDArray[Any]) -> NDArray[np.int64]:
    """Integers as ticks.

    Only the ends are looked at: if these are in range, and whoever judges the column finds that it
    ascends, all are. To read all of a long column costs as much as to judge it.

    Raises:
        TraceError: the first or the last is out of range.
    """
    made = ticks.astype(np.int64, copy=False)
    for end in made[:: max(len(made) - 1, 1)].tolist():
        whole_ticks(end)
    return made


def _refuse(seconds: NDArray[Any], most: int) -> None:
    """Refuse seconds beyond those bounds, and what is no number."""
    if not -most <= seconds.min() <= seconds.max() <= most:
        fine = (seconds >= -most) & (seconds <= most)
        ticks_of_seconds(seconds[~fine][0].item())
