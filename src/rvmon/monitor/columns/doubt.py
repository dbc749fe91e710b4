"""Where a trigger may have been hidden, as stretches; see `rvmon.formula.state.StateOp.DOUBT`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.axis import Axis
from rvmon.monitor.columns.leaves import Truth, known_truth
from rvmon.monitor.columns.past import moved_on
from rvmon.monitor.columns.stretches import (
    complement,
    holds_at_last,
    in_at_least,
    nowhere,
    unknown_in,
)

if TYPE_CHECKING:
    from rvmon.monitor.columns.stretches import Toggles


class Doubt:
    """Follows a trigger from piece to piece; `rvmon.runtime.past.doubt` for whole stretches.

    Args:
        pulse: whether it starts an attempt wherever it is true.
    """

    def __init__(self, pulse: bool) -> None:
        self._pulse = pulse
        self._must, self._may = False, False
        """Whether the trigger was true, or not false, at the last place so far."""
        self._in_doubt = False
        """Whether the stretch that the last piece ends with is one in which a trigger may hide."""

    def take(self, operands: Sequence[Truth], axis: Axis) -> Truth:
        """Where it may be so in a piece, and where it was so before in the same stretch."""
        (trigger,) = operands
        if axis.start == axis.stop:
            return known_truth(nowhere())
        must, may = trigger.must, trigger.may
        ends = self._must, self._may
        self._must, self._may = holds_at_last(must, axis.stop), holds_at_last(may, axis.stop)
        if trigger.known and not self._in_doubt and ends[0] == ends[1]:
            return known_truth(nowhere())
        over = partial(complement, start=axis.start, stop=axis.stop)
        hidden = unknown = unknown_in(must, may, axis.start, axis.stop)
        if not self._pulse:
            must_before, may_before = moved_on(must, ends[0], axis), moved_on(may, ends[1], axis)
            fresh = in_at_least(2, [unknown, over(may_before)])
            lost = in_at_least(2, [over(must_before), may_before])
            hidden = in_at_least(2, [may, in_at_least(1, [fresh, lost])])
        made = self._behind_first(hidden, may, axis)
        self._in_doubt = holds_at_last(made, axis.stop)
        if not len(made):
            return known_truth(made)
        return Truth(in_at_least(2, [made, over(hidden)]), made)

    def _behind_first(self, hidden: Toggles, may: Toggles, axis: Axis) -> Toggles:
        """Each stretch of `may` from the first place on at which a trigger may be hidden in it."""
        starts, stops = may[0::2], may[1::2]
        found = np.append(hidden[0::2], axis.stop)[np.searchsorted(hidden[0::2], starts)]
        if self._in_doubt and len(may) and may[0] == axis.start:
            found[0] = axis.start
        doubtful = found < stops
        return np.stack((found[doubtful], stops[doubtful]), 1).ravel()
