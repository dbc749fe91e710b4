"""Operators that look at the position before."""

from __future__ import annotations

from rvmon.formula.state import FALSE
from rvmon.runtime.past import doubt
from rvmon.runtime.table import NEVER


class Previous:
    """`Y`: the operand at the position before, false at the first.

    Args:
        gap: ticks between two positions, where that is fixed.

    Attributes:
        wake: when its value changes though the operand stays; `NEVER` if it does not.
    """

    __slots__ = ("gap", "seen", "wake")
    STATE = ("seen", "wake")

    def __init__(self, gap: int) -> None:
        self.gap = gap
        self.seen = FALSE
        self.wake = NEVER

    def step(self, t: int, operand: int) -> int:
        """The value at `t`; the operand was as given last at all positions up to the one before."""
        value, self.seen = self.seen, operand
        self.wake = t + self.gap if value != operand else NEVER
        return value


class Hidden:
    """Follows the truth of a trigger; see `rvmon.formula.state.StateOp.DOUBT`.

    Args:
        pulse: whether it starts an attempt wherever it is true.
        every: whether no trigger is sure.
        gap: ticks between two positions; 1 where only samples are positions.

    Attributes:
        wake: as of `Previous`.
    """

    __slots__ = ("_every", "_gap", "_now", "_pulse", "_value", "wake")
    STATE = ("_now", "_value", "wake")

    def __init__(self, pulse: bool, every: bool, gap: int) -> None:
        self._pulse = pulse
        self._every = every
        self._gap = gap
        self._now = FALSE
        self._value = FALSE
        self.wake = NEVER

    def step(self, t: int, now: int) -> int:
        """Take the truth at the position `t`; that given before held at all positions between."""
        self._value = doubt(self._now, now, self._value, self._pulse, self._every)
        self._now = now
        changes = doubt(now, now, self._value, self._pulse, self._every) != self._value
        self.wake = t + self._gap if changes else NEVER
        return self._value
