"""Columns of seconds as ticks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray


def ticks_of_column(seconds: NDArray[Any]) -> NDArray[np.int64]:
    """Seconds to ticks, each rounded once as `ticks_of_seconds` does.

    Raises:
        TraceError: a number is not finite or out of range.
    """
    if seconds.dtype.kind == "i" and not (np.abs(seconds) >= 4_600_000_000).any():
        return seconds.astype(np.int64) * 1_000_000_000
    values = seconds.astype(np.float64, copy=False)
    if not np.isfinite(values).all() or (np.abs(values) >= 4.6e9).any():
        bad = values[~(np.abs(values) < 4.6e9)][0]
        ticks_of_seconds(float(bad))
        raise TraceError(f"time {bad} s is out of range")
    whole = np.floor(values)
    parts = (values - whole) * 1e9
    ticks = whole.astype(np.int64) * 1_000_000_000 + np.rint(parts).astype(np.int64)
    for row in np.flatnonzero(np.abs(parts - np.floor(parts) - 0.5) < 1e-5):
        ticks[row] = ticks_of_seconds(float(values[row]))
    return ticks
