"""Where a trigger may have been hidden, as positions go by."""

from __future__ import annotations

from rvmon.formula.state import FALSE, TRUE, UNKNOWN

NEVER = 1 << 63


class Hidden:
    """Follows the truth of a trigger; see `rvmon.formula.state.StateOp.DOUBT`.

    Args:
        pulse: whether it starts an attempt wherever it is true.
        every: whether no trigger is sure.
        gap: ticks between two positions; 1 where only samples are positions.

    Attributes:
        wake: when its value changes though the trigger stays; `NEVER` if it does not.

    Source: SEMANTICS, section 3 (Doubt).
    """

    __slots__ = ("_every", "_gap", "_now", "_pulse", "_value", "wake")

    def __init__(self, pulse: bool, every: bool, gap: int) -> None:
        self._pulse = pulse
        self._every = every
        self._gap = gap
        self._now = FALSE
        self._value = FALSE
        self.wake = NEVER

    def step(self, t: int, now: int) -> int:
        """Take the truth at the position `t`; that given before held at all positions between."""
        self._value = self._after(self._now, now, self._value)
        self._now = now
        changes = self._after(now, now, self._value) != self._value
        self.wake = t + self._gap if changes else NEVER
        return self._value

    def _after(self, before: int, now: int, value: int) -> int:
        """The value at a position, from the truths there and at the one before, and its value."""
        if now == FALSE:
            return FALSE
        if self._pulse:
            hidden = self._every or now == UNKNOWN
        elif self._every:
            hidden = before != TRUE
        else:
            hidden = before == UNKNOWN or (now == UNKNOWN and before == FALSE)
        if hidden:
            return UNKNOWN
        return TRUE if value != FALSE else FALSE
