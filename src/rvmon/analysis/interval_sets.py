"""Sets of ticks as arrays int64[n, 2] of closed intervals: ascending, disjoint, not adjacent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def joined(intervals: Any) -> NDArray[np.int64]:
    """The set of some intervals, with adjacent ones merged.

    Args:
        intervals: int64[n, 2], ascending and disjoint.

    >>> joined([(1, 2), (3, 4), (6, 7)]).tolist()
    [[1, 4], [6, 7]]
    """
    if len(intervals) == 1:
        return np.asarray(intervals, np.int64)
    spans = np.asarray(intervals, np.int64).reshape(-1, 2)
    apart = np.ones(len(spans) + 1, np.bool_)
    apart[1:-1] = spans[1:, 0] > spans[:-1, 1] + 1
    if apart.all():
        return spans
    return np.column_stack((spans[apart[:-1], 0], spans[apart[1:], 1]))


def within(spans: NDArray[np.int64], low: int, high: int) -> NDArray[np.int64]:
    """The intersection of the set with [low, high].

    >>> within(joined([(1, 4), (6, 7), (9, 9)]), 3, 6).tolist()
    [[3, 4], [6, 6]]
    """
    if len(spans) and low <= spans.item(0) and spans.item(-1) <= high:
        return spans
    part = spans[spans[:, 1].searchsorted(low) : spans[:, 0].searchsorted(high, "right")].copy()
    if len(part):
        part[0, 0] = max(part[0, 0], low)
        part[-1, 1] = min(part[-1, 1], high)
    return part


def hold(spans: NDArray[np.int64], ticks: Any) -> NDArray[np.bool_]:
    """Whether each tick lies in the set.

    >>> hold(joined([(1, 4), (6, 7)]), [0, 1, 5, 7]).tolist()
    [False, True, False, True]
    """
    if not len(spans):
        return np.zeros(np.shape(ticks), np.bool_)
    place = np.searchsorted(spans[:, 0], ticks, "right") - 1
    inside: NDArray[np.bool_] = (place >= 0) & (np.asarray(ticks) <= spans[place, 1])
    return inside


def distinct(ticks: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """The ticks of several arrays, ascending, each once; unlike `numpy.unique` it imports nothing.

    >>> distinct([np.array([3, 7]), np.array([5, 3])]).tolist()
    [3, 5, 7]
    """
    ordered: NDArray[np.int64] = np.sort(np.concatenate(ticks))
    is_last = np.ones(len(ordered), np.bool_)
    is_last[:-1] = ordered[:-1] != ordered[1:]
    return ordered[is_last]
