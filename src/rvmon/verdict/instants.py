"""Arrays of instants for people and for JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rvmon.trace.time import TICKS_PER_SECOND, format_ticks
from rvmon.verdict.attempt_json import encoded, seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

_EXACT = 1 << 53
"""Integers below this are floats, too."""

_LEAST = 10_000
"""Ticks from here on are written in seconds, and by JSON without a power of ten."""

_MOST = TICKS_PER_SECOND << 23
"""Below this, neighbouring ticks are more apart than neighbouring floats of seconds."""


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
    plain = (ticks >= _LEAST) & (ticks < _MOST)
    texts = np.empty(len(ticks), object)
    texts[plain] = _decimals(ticks[plain])
    texts[~plain] = list(map(format_ticks, ticks[~plain].tolist()))
    found: list[str] = texts.tolist()
    return found


def _decimals(ticks: NDArray[np.int64]) -> list[str]:
    """The same, of ticks of which JSON writes the shortest decimal, without a power of ten.

    That is the one which is nearest to the quotient: here no other is as near as the exact one.
    """
    if not len(ticks):
        return []
    text = encoded((ticks / TICKS_PER_SECOND).tolist())[1:-1]
    return f"{text},".replace(".0,", ",").replace(",", " s,")[:-1].split(",")
