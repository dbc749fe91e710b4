"""Arrays of instants for people and for JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rvmon.trace.time import TICKS_PER_SECOND, format_ticks
from rvmon.verdict.attempt_json import seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

_EXACT = 1 << 53
"""Integers below this are floats, too."""

_LEAST = 1_000
"""Ticks from here on are written in seconds."""


def seconds_of(instants: NDArray[np.int64], origin: int) -> list[float]:
    """Instants in seconds after the origin; all in ticks."""
    since = instants - origin
    if len(since) and max(-since.min(), since.max()) >= _EXACT:
        return [seconds(instant, origin) for instant in instants.tolist()]
    # Both are exact, and rounded once: as of integers.
    found: list[float] = (since / TICKS_PER_SECOND).tolist()
    return found


def formatted(ticks: NDArray[np.int64]) -> list[str]:
    """Instants or durations as `format_ticks` writes them."""
    if not len(ticks) or ticks.min() < _LEAST:
        return list(map(format_ticks, ticks.tolist()))
    whole, rest = np.divmod(ticks, TICKS_PER_SECOND)
    return [
        f"{count}.{part:09d}".rstrip("0").rstrip(".") + " s"
        for count, part in zip(whole.tolist(), rest.tolist(), strict=True)
    ]
