"""Truth along a trace as stretches, by NumPy.

A set of places is an array of *toggles*, int64, ascending: the first place of a stretch, the place
behind its last, the first of the next stretch, and so on. Its length is even.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Toggles = NDArray[np.int64]


def nowhere() -> Toggles:
    """The empty set."""
    return np.empty(0, np.int64)


def between(start: int, stop: int) -> Toggles:
    """All places from `start` to before `stop`.

    >>> between(2, 5).tolist(), between(5, 5).tolist()
    ([2, 5], [])
    """
    return np.array([start, stop] if start < stop else [], np.int64)


def complement(toggles: Toggles, start: int, stop: int) -> Toggles:
    """The places from `start` to before `stop` that are not in a set of such places.

    >>> complement(np.array([2, 4]), 0, 9).tolist(), complement(np.array([0, 4]), 0, 9).tolist()
    ([0, 2, 4, 9], [4, 9])
    """
    if not len(toggles):
        return between(start, stop)
    left = [] if toggles[0] == start else [start]
    right = [] if toggles[-1] == stop else [stop]
    inner = toggles[1 - len(left) : len(toggles) - 1 + len(right)]
    return np.concatenate((np.array(left, np.int64), inner, np.array(right, np.int64)))


def in_at_least(count: int, sets: Sequence[Toggles]) -> Toggles:
    """The places that are in at least so many of the sets: 1 is their union.

    >>> in_at_least(2, [np.array([0, 4, 6, 8]), np.array([2, 7])]).tolist()
    [2, 4, 6, 7]
    """
    if len(sets) == 1 and count == 1:
        return sets[0]
    places = np.concatenate(sets)
    if not len(places):
        return places
    order = np.argsort(places, kind="stable")
    turns = np.concatenate([_turns(len(toggles)) for toggles in sets])
    inside = np.cumsum(turns[order]) >= count
    places = places[order]
    # Of several at one place the last one has counted all.
    last = np.append(places[1:] != places[:-1], True)
    places, inside = places[last], inside[last]
    made: Toggles = places[np.append(inside[0], inside[1:] != inside[:-1])]
    return made


def _turns(length: int) -> NDArray[np.int8]:
    made = np.ones(length, np.int8)
    made[1::2] = -1
    return made


def joined(starts: Toggles, stops: Toggles) -> Toggles:
    """The union of stretches of which starts and stops ascend.

    >>> joined(np.array([0, 2, 7]), np.array([3, 5, 9])).tolist()
    [0, 5, 7, 9]
    """
    if not len(starts):
        return nowhere()
    apart = starts[1:] > stops[:-1]
    made = np.empty((1 + np.count_nonzero(apart), 2), np.int64)
    made[:, 0] = starts[np.append(True, apart)]
    made[:, 1] = stops[np.append(apart, True)]
    return made.ravel()


def counted(firsts: Toggles, counts: Toggles) -> Toggles:
    """Each first number with those that follow it, so many as its count says in all.

    >>> counted(np.array([3, 9]), np.array([2, 3])).tolist()
    [3, 4, 9, 10, 11]
    """
    made: Toggles = np.arange(counts.sum()) + np.repeat(firsts + counts - np.cumsum(counts), counts)
    return made


def clipped(toggles: Toggles, start: int, stop: int) -> Toggles:
    """The places of a set from `start` to before `stop`.

    >>> clipped(np.array([0, 4, 6, 8]), 2, 7).tolist()
    [2, 4, 6, 7]
    """
    bounded = np.clip(toggles.reshape(-1, 2), start, stop)
    return bounded[bounded[:, 0] < bounded[:, 1]].ravel()


def holds_at(toggles: Toggles, places: Toggles) -> NDArray[np.int8]:
    """For each place 1 if it is in the set, else 0."""
    return (np.searchsorted(toggles, places, "right") & 1).astype(np.int8)


def holds_at_last(toggles: Toggles, stop: int) -> bool:
    """Whether the place before `stop`, where all ends, is in the set."""
    return len(toggles) > 0 and bool(toggles[-1] == stop)


def first_in(toggles: Toggles, places: Toggles, none: int) -> Toggles:
    """For each place the first from it on that is in the set; `none` if there is none.

    >>> first_in(np.array([2, 4]), np.array([0, 3, 5]), 9).tolist()
    [2, 3, 9]
    """
    following = np.searchsorted(toggles, places, "right")
    return np.where(following & 1, places, np.append(toggles, none)[following])


def unknown_in(must: Toggles, may: Toggles, start: int, stop: int) -> Toggles:
    """The places at which a truth is unknown.

    >>> unknown_in(np.array([2, 4]), np.array([1, 6]), 0, 9).tolist()
    [1, 2, 4, 6]
    """
    return nowhere() if must is may else in_at_least(2, [may, complement(must, start, stop)])
