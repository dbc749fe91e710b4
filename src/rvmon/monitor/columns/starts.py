"""Where attempts start (SEMANTICS 3), from the stretches of a trigger."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.columns.axis import Axis
from rvmon.monitor.columns.leaves import Truth

if TYPE_CHECKING:
    from rvmon.monitor.columns.stretches import Toggles


class Starts:
    """Follows a trigger from piece to piece; `rvmon.monitor.trigger.Trigger` for whole stretches.

    Args:
        pulse: whether it starts an attempt at every position where it holds.
        episodic: whether an attempt is an episode, of which one runs at a time.
    """

    def __init__(self, pulse: bool, episodic: bool) -> None:
        self._pulse = pulse
        self._episodic = episodic
        self._before = UNKNOWN
        self._known = False
        self._running = False

    def take(self, trigger: Truth, axis: Axis) -> Toggles:
        """The places of a piece at which attempts start."""
        must, may = trigger.must, trigger.may
        if axis.start == axis.stop:
            return np.empty(0, np.int64)
        found = _all_places(must) if self._pulse else self._edges(must, may, axis)
        if self._episodic:
            found = self._first_of_episodes(found, may, axis)
        false_at_last = not (len(may) and may[-1] == axis.stop)
        true_at_last = len(must) > 0 and must[-1] == axis.stop
        self._before = FALSE if false_at_last else TRUE if true_at_last else UNKNOWN
        self._known = self._known or _first_known(must, may, axis) < axis.stop
        return found

    def _edges(self, must: Toggles, may: Toggles, axis: Axis) -> Toggles:
        begins = must[0::2]
        if not len(begins):
            return begins
        fresh = np.ones(len(begins), bool) if may is must else np.isin(begins, may[0::2])
        if begins[0] == axis.start:
            fresh[0] = self._before == FALSE
        if not self._known and begins[0] == _first_known(must, may, axis):
            fresh[0] = True
        return begins[fresh]

    def _first_of_episodes(self, found: Toggles, may: Toggles, axis: Axis) -> Toggles:
        """The first start of each stretch in which the trigger is not false."""
        episode = np.searchsorted(may[0::2], found, "right") - 1
        first = np.ones(len(found), bool)
        first[1:] = episode[1:] != episode[:-1]
        goes_on = self._running and len(may) > 0 and may[0] == axis.start
        if goes_on:
            first &= episode != 0
        last = len(may) // 2 - 1
        self._running = (
            last >= 0
            and bool(may[-1] == axis.stop)
            and ((goes_on and last == 0) or bool((episode == last).any()))
        )
        return found[first]


def _first_known(must: Toggles, may: Toggles, axis: Axis) -> int:
    """The first place at which a trigger is true or false; the end of the axis if there is none."""
    true = int(must[0]) if len(must) else axis.stop
    false = int(may[1]) if len(may) and may[0] == axis.start else axis.start
    return min(true, false)


def _all_places(toggles: Toggles) -> Toggles:
    counts = toggles[1::2] - toggles[0::2]
    behind = np.cumsum(counts)
    total = int(behind[-1]) if len(behind) else 0
    made: Toggles = np.arange(total) + np.repeat(toggles[0::2] - (behind - counts), counts)
    return made
