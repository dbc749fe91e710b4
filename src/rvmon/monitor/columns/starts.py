"""Where attempts start (SEMANTICS 3), from the stretches of a trigger."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.axis import Axis
from rvmon.monitor.columns.leaves import Truth
from rvmon.monitor.columns.stretches import counted, holds_at, holds_at_last

if TYPE_CHECKING:
    from rvmon.monitor.columns.stretches import Toggles


class Starts:
    """Follows a trigger from piece to piece; `rvmon.runtime.starts.Starts` for whole stretches.

    Args:
        pulse: whether it starts an attempt at every position where it holds.
        episodic: whether one starts where it is no longer false, and runs until it is again.
    """

    def __init__(self, pulse: bool, episodic: bool) -> None:
        self._pulse = pulse
        self._episodic = episodic
        self._may = False
        """Whether it was not false at the last place so far."""

    def take(self, trigger: Truth, axis: Axis) -> Toggles:
        """The places of a piece at which attempts start."""
        if axis.start == axis.stop:
            return np.empty(0, np.int64)
        before, self._may = self._may, holds_at_last(trigger.may, axis.stop)
        if self._pulse and not self._episodic:
            firsts = trigger.must[0::2]
            return counted(firsts, trigger.must[1::2] - firsts)
        begins: Toggles = trigger.may[0::2]
        if before and len(begins) and begins[0] == axis.start:
            begins = begins[1:]
        if self._episodic or trigger.known:
            return begins
        return begins[holds_at(trigger.must, begins) > 0]
