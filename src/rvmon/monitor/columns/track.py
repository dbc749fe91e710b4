"""Since when propositions have been as they are, and when they last were otherwise."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.leaves import Truth, known_truth
from rvmon.monitor.columns.stretches import holds_at

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]

UNSEEN = -FAR
"""In place of the last instant of a truth that was not seen yet."""


def edges_of(truths: list[Truth], axis: Axis) -> Numbers:
    """The places of a piece at which one of some truths may change, its first place first."""
    found = [np.array([axis.start])]
    for truth in truths:
        found += [truth.must] if truth.known else [truth.must, truth.may]
    places = np.sort(np.concatenate(found), kind="stable")
    places = places[np.append(True, places[1:] != places[:-1])]
    made: Numbers = places[: max(int(np.searchsorted(places, axis.stop)), 1)]
    return made


def values_at(truth: Truth, places: Numbers) -> NDArray[np.int8]:
    """The truth at each place: 0, 1 (unknown) or 2."""
    must = holds_at(truth.must, places)
    return must + (must if truth.known else holds_at(truth.may, places))


class Track:
    """Follows a proposition from piece to piece.

    Attributes:
        now: at the last place so far: its truth; the instants since when it has had that, and at
            which it last was false and true before; `UNSEEN` if it was not.
    """

    def __init__(self) -> None:
        self.now: tuple[int, int, int, int] = (UNKNOWN, UNSEEN, UNSEEN, UNSEEN)
        self._piece: tuple[Truth, Axis] | None = None
        self._before = self.now

    def take(self, truth: Truth, axis: Axis) -> None:
        """Go on with a piece."""
        self._before = self.now
        self._piece = truth, axis
        if axis.start < axis.stop:
            # What was known longer ago than the last two stretches does not show at the end.
            tail = known_truth(truth.must[-4:]) if truth.known else truth
            self.now = tuple(self._laid_out(tail, axis)[1][-1].tolist())

    def _laid_out(self, truth: Truth, axis: Axis) -> tuple[Numbers, Numbers]:
        """The places of changes, and `now` before the first and behind each of them."""
        now = self._before
        places = edges_of([truth], axis)
        values = values_at(truth, places)
        first = now[1] == UNSEEN
        new = np.append(first or values[0] != now[0], values[1:] != values[:-1])
        places, values = places[new], values[new]
        table = np.empty((len(places) + 1, 4), np.int64)
        table[0] = now
        table[1:, 0] = values
        table[1:, 1] = axis.instants(places)
        ended = axis.instants(places - 1)
        for column, value in ((2, FALSE), (3, TRUE)):
            # Of each change, the instant before if it ended this value; then the last such one.
            before = np.append(now[0], values[:-1]) == value
            ends = np.where(before & (places > axis.start if first else True), ended, UNSEEN)
            table[1:, column] = np.maximum.accumulate(np.append(now[column], ends))[1:]
        return places, table

    def at(self, places: Numbers) -> Numbers:
        """For each place of the last piece, or the one before it, what `now` says of it."""
        if self._piece is None or not len(places):
            return np.empty((0, 4), np.int64)
        changes, table = self._laid_out(*self._piece)
        made: Numbers = table[np.searchsorted(changes, places, "right")]
        return made
