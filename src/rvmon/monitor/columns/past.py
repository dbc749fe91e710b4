"""What looks back, as shifts and unions of stretches; what it remembers from piece to piece."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.stretches import (
    between,
    clipped,
    in_at_least,
    joined,
    nowhere,
)

if TYPE_CHECKING:
    from rvmon.monitor.columns.stretches import Toggles


class Previous:
    """`Y φ`: whether φ held at the position before; at the first position it is false."""

    def __init__(self) -> None:
        self._held = False

    def same(self, other: Previous) -> bool:
        """Whether both will always be the same from now on, of the same operand."""
        return self._held == other._held

    def copy(self) -> Previous:
        """The same, independent from now on."""
        made = Previous()
        made._held = self._held
        return made

    def take(self, operands: Sequence[Toggles], axis: Axis) -> Toggles:
        """Where it holds in a piece, from where the operand does."""
        (operand,) = operands
        moved = clipped(operand + 1, axis.start, axis.stop)
        if self._held and axis.start < axis.stop:
            moved = in_at_least(1, [between(axis.start, axis.start + 1), moved])
        if axis.start < axis.stop:
            self._held = len(operand) > 0 and bool(operand[-1] == axis.stop)
        return moved


class Since:
    """`left S[low, high] right`, one Boolean reading of it.

    A position s where `right` holds makes it true from s + low to s + high, as long as `left` holds
    from the position behind s on. So the stretches of `right`, cut where a stretch of `left`
    begins to lead on, are shifted, cut off where `left` ends, and joined.

    Source: interval marking after Basin, Klaedtke and Zalinescu 2011.

    Args:
        low: ticks.
        high: ticks, or `None`.
    """

    def __init__(self, low: int, high: int | None) -> None:
        self.low = low
        self.high = high
        self._marks = nowhere()
        """Instants at which it holds behind the piece, as far as `left` holds up to there."""

    def same(self, other: Since) -> bool:
        """Whether both will always be the same from now on, of the same operands."""
        return np.array_equal(self._marks, other._marks)

    def copy(self) -> Since:
        """The same, independent from now on."""
        made = Since(self.low, self.high)
        made._marks = self._marks
        return made

    def take(self, operands: Sequence[Toggles], axis: Axis) -> Toggles:
        """Where it holds in a piece, from where the operands do."""
        left, right = operands
        if axis.start == axis.stop:
            return nowhere()
        begins, ends = left[0::2], left[1::2]
        starts, ends_at, run = self._marked(left, right, axis)
        if len(begins) and begins[0] == axis.start and len(self._marks):
            starts = np.concatenate((self._marks[0::2], starts))
            ends_at = np.concatenate((self._marks[1::2], ends_at))
            run = np.concatenate((np.zeros(len(self._marks) // 2, np.int64), run))
        last = int(axis.instants(np.array([axis.stop - 1]))[0])
        goes_on = len(ends) > 0 and bool(ends[-1] == axis.stop)
        if goes_on:
            own = run == len(ends) - 1
            self._marks = clipped(joined(starts[own], ends_at[own]), last + 1, FAR + 1)
        elif len(right) and right[-1] == axis.stop:
            self._marks = clipped(
                np.array([last + self.low, self._behind(last)], np.int64), last + 1, FAR + 1
            )
        else:
            self._marks = nowhere()
        if len(run):
            limits = axis.instants(ends - 1) + 1
            ends_at = np.minimum(ends_at, limits[run])
        found = np.stack((axis.first_from(starts), axis.first_from(ends_at)), 1)
        found = found[found[:, 0] < found[:, 1]]
        held = joined(found[:, 0], found[:, 1])
        return in_at_least(1, [held, right]) if self.low == 0 else held

    def _behind(self, instant: int) -> int:
        return FAR + 1 if self.high is None else instant + self.high + 1

    def _marked(
        self, left: Toggles, right: Toggles, axis: Axis
    ) -> tuple[Toggles, Toggles, Toggles]:
        """Where it holds because of `right` in the piece, not yet cut off where `left` ends.

        Returns:
            The first instants of stretches, the instants behind their ends, and the numbers of the
            stretches of `left` that they depend on.
        """
        firsts, stops, run = _leading(left, right)
        if not axis.closes_ranks(self.low, self.high):
            counts = stops - firsts
            behind = np.cumsum(counts)
            total = int(behind[-1]) if len(behind) else 0
            firsts = np.arange(total) + np.repeat(firsts - (behind - counts), counts)
            stops, run = firsts + 1, np.repeat(run, counts)
        starts = axis.instants(firsts) + self.low
        if self.high is None:
            return starts, np.full(len(starts), FAR + 1), run
        return starts, axis.instants(stops - 1) + (self.high + 1), run


def _leading(left: Toggles, right: Toggles) -> tuple[Toggles, Toggles, Toggles]:
    """The places of `right` behind which `left` holds: starts, stops, stretches of `left`."""
    begins, ends = left[0::2] - 1, left[1::2]
    if len(begins) == 1 and len(right) and begins[0] < right[0] and ends[0] >= right[-1]:
        return right[0::2], right[1::2], np.zeros(len(right) // 2, np.int64)
    first = np.searchsorted(right[1::2], begins, "right")
    behind = np.searchsorted(right[0::2], ends, "left")
    counts = np.maximum(behind - first, 0)
    run = np.repeat(np.arange(len(begins)), counts)
    number = np.arange(len(run)) - np.repeat(np.cumsum(counts) - counts, counts) + first[run]
    starts = np.maximum(right[0::2][number], begins[run])
    return starts, np.minimum(right[1::2][number], ends[run]), run
