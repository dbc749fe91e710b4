"""What looks back, as shifts and unions of stretches; what it remembers from piece to piece."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.stretches import (
    between,
    clipped,
    counted,
    holds_at_last,
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
        moved = moved_on(operand, self._held, axis)
        self._held = holds_at_last(operand, axis.stop) if axis.start < axis.stop else self._held
        return moved


def moved_on(toggles: Toggles, before: bool, axis: Axis) -> Toggles:
    """The places of a piece of which the one before is in a set."""
    moved = clipped(toggles + 1, axis.start, axis.stop)
    if before and axis.start < axis.stop:
        moved = in_at_least(1, [between(axis.start, axis.start + 1), moved])
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
        if axis.start == axis.stop:
            return nowhere()
        left, right = operands
        if self.low == 0:
            return self._from_now(left, right, axis)
        starts, stops, run = self._marked(left, right, axis)
        if len(left) and left[0] == axis.start and len(self._marks):
            starts = np.concatenate((self._marks[0::2], starts))
            stops = np.concatenate((self._marks[1::2], stops))
            run = np.concatenate((np.zeros(len(self._marks) // 2, np.int64), run))
        last = axis.instant(axis.stop - 1)
        if len(left) and left[-1] == axis.stop:
            own = run == len(left) // 2 - 1
            ahead = joined(starts[own], stops[own])
        elif len(right) and right[-1] == axis.stop:
            ahead = np.array([last + self.low, self._behind(last)], np.int64)
        else:
            ahead = nowhere()
        self._marks = clipped(ahead, last + 1, FAR + 1)
        if len(run):
            stops = np.minimum(stops, (axis.instants(left[1::2] - 1) + 1)[run])
        found = np.stack((axis.first_from(starts), axis.first_from(stops)), 1)
        found = found[found[:, 0] < found[:, 1]]
        return joined(found[:, 0], found[:, 1])

    def _from_now(self, left: Toggles, right: Toggles, axis: Axis) -> Toggles:
        """As `take`, where `low` is 0: each stretch of `right` goes on for a while."""
        starts, stops = right[0::2], right[1::2]
        ends = np.full(len(stops), axis.stop)
        if self.high is not None:
            ends = axis.first_from(axis.instants(stops - 1) + (self.high + 1))
        toggle = np.searchsorted(left, stops, "right")
        limits = np.append(left, axis.stop)[toggle]
        stops = np.where(toggle % 2 == 1, np.minimum(ends, limits), stops)
        last = axis.instant(axis.stop - 1)
        ahead = last + 1
        begins_held = len(left) > 0 and bool(left[0] == axis.start)
        if begins_held and len(self._marks):
            ahead = int(self._marks[1])
            stop = min(axis.place_from(ahead), int(left[1]))
            starts = np.append(axis.start, starts)
            stops = np.append(stop, stops)
        holds_on = len(left) > 0 and bool(left[-1] == axis.stop)
        if not holds_on or left[-2] > axis.start:
            ahead = last + 1
        final = self._last_leading(left, right, axis, holds_on=holds_on)
        if final is not None:
            ahead = self._behind(axis.instant(final))
        self._marks = between(last + 1, ahead)
        return joined(starts, stops)

    def _last_leading(
        self, left: Toggles, right: Toggles, axis: Axis, *, holds_on: bool
    ) -> int | None:
        """The last place of `right` behind which `left` holds to the end of the piece."""
        if not len(right):
            return None
        final = int(right[-1]) - 1
        least = int(left[-2]) - 1 if holds_on else axis.stop - 1
        return final if final >= least else None

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
            firsts = counted(firsts, counts)
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
    number = counted(first, counts)
    starts = np.maximum(right[0::2][number], begins[run])
    return starts, np.minimum(right[1::2][number], ends[run]), run
