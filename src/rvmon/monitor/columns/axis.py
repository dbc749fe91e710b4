"""Positions as numbers: of ticks in held time, of samples where only these are positions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]

FAR = 1 << 62
"""Behind all instants, and all places."""


class Axis(Protocol):
    """Between places, the numbers of positions, and instants, in one piece of a trace.

    Attributes:
        start: the first place of the piece; the one before belongs to the piece before.
        stop: behind its last place.
    """

    start: int
    stop: int

    def instants(self, places: Numbers) -> Numbers:
        """The instants of places from `start − 1` on; of `stop`, one that is later than all."""

    def first_from(self, instants: Numbers) -> Numbers:
        """The first place of the piece at or after each instant; `stop` if there is none."""

    def instant(self, place: int) -> int:
        """As `instants`, of one."""

    def place_from(self, instant: int) -> int:
        """As `first_from`, of one."""

    def closes_ranks(self, low: int, high: int | None) -> bool:
        """Whether what lies [low, high] after neighbouring positions is one stretch."""


class TickAxis:
    """Every tick is a position; its place is its instant."""

    def __init__(self, start: int, stop: int) -> None:
        self.start = start
        self.stop = stop

    def instants(self, places: Numbers) -> Numbers:
        """See `Axis`."""
        return np.where(places < self.stop, places, FAR)

    def first_from(self, instants: Numbers) -> Numbers:
        """See `Axis`."""
        return np.clip(instants, self.start, self.stop)

    def instant(self, place: int) -> int:
        """See `Axis`."""
        return place if place < self.stop else FAR

    def place_from(self, instant: int) -> int:
        """See `Axis`."""
        return min(max(instant, self.start), self.stop)

    def closes_ranks(self, low: int, high: int | None) -> bool:  # noqa: ARG002
        """See `Axis`."""
        return True


class RowAxis:
    """Rows are positions; their places count from the beginning of the trace.

    Args:
        start: the place of the first row.
        times: int64[n] ticks, of the rows.
        before: the instant of the row before.
    """

    def __init__(self, start: int, times: Numbers, before: int) -> None:
        self.start = start
        self.stop = start + len(times)
        self._times = times
        self._framed = np.concatenate(([before], times, [FAR]))

    def instants(self, places: Numbers) -> Numbers:
        """See `Axis`."""
        return self._framed[places - (self.start - 1)]

    def first_from(self, instants: Numbers) -> Numbers:
        """See `Axis`."""
        return np.searchsorted(self._times, instants, "left") + self.start

    def instant(self, place: int) -> int:
        """See `Axis`."""
        return int(self._framed[place - (self.start - 1)])

    def place_from(self, instant: int) -> int:
        """See `Axis`."""
        return int(np.searchsorted(self._times, instant, "left")) + self.start

    def closes_ranks(self, low: int, high: int | None) -> bool:
        """See `Axis`."""
        return low == 0 or high is None
