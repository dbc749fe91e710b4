"""`S` with an interval, incrementally: the merged instants at which it holds or will hold."""

from __future__ import annotations

from collections import deque

from rvmon.formula.state import FALSE, TRUE, UNKNOWN

NEVER = 1 << 63


class _Run:
    """One Boolean reading of `left S[low, high] right`.

    Each position s with `right` true makes the operator true at s + low … s + high, until `left`
    is false. These stretches are merged where they touch, so that their number is bounded by
    low / (high − low) and not by the number of samples.

    Source: AUTOMATA 4; interval marking after Basin, Klaedtke and Zalinescu 2011.
    """

    __slots__ = ("gap", "growing", "high", "left", "low", "right", "stretches")

    def __init__(self, low: int, high: int | None, gap: int) -> None:
        self.low = low
        self.high = high
        self.gap = gap
        self.left = True
        self.right = False
        self.growing = False
        self.stretches: deque[list[int]] = deque()

    def step(self, t: int, last: int, left: bool, right: bool) -> bool:
        """Take the operands at `t`; those given before were true of all positions up to `last`."""
        if self.growing:
            self.stretches[-1][1] = NEVER if self.high is None else last + self.high
            self.growing = False
        if not self.left and self.right:
            self._mark(last + self.low, NEVER if self.high is None else last + self.high)
        self.left, self.right = left, right
        if not left:
            self.stretches.clear()
            return right and self.low == 0
        if right:
            self._mark(t + self.low, NEVER)
            self.growing = True
        stretches = self.stretches
        while stretches and stretches[0][1] < t:
            stretches.popleft()
        return bool(stretches) and stretches[0][0] <= t

    def _mark(self, start: int, end: int) -> None:
        if self.stretches and start - self.gap <= self.stretches[-1][1]:
            self.stretches[-1][1] = end
        else:
            self.stretches.append([start, end])

    def next_change(self, t: int) -> int:
        """The next instant after `t` at which the value changes, the operands staying."""
        if not self.stretches:
            return NEVER
        start, end = self.stretches[0]
        return start if start > t else min(end + 1, NEVER)


class Since:
    """`left S[low, high] right` with Kleene's values: a pessimistic and an optimistic reading.

    Args:
        low: least distance in ticks.
        high: greatest distance, `None` if unbounded.
        gap: ticks between two positions that are neighbours for sure (1 in `time sampled`).
    """

    __slots__ = ("optimistic", "pessimistic", "wake")

    def __init__(self, low: int, high: int | None, gap: int) -> None:
        self.pessimistic = _Run(low, high, gap)
        self.optimistic = _Run(low, high, gap)
        self.wake = NEVER

    def step(self, t: int, last: int, left: int, right: int) -> int:
        """The value at `t`.

        Args:
            t: the instant of the position.
            last: the instant of the position before; up to there the operands were as given last.
            left: truth of the left operand at `t`.
            right: truth of the right operand at `t`.
        """
        worse, better = self.pessimistic, self.optimistic
        holds = worse.step(t, last, left == TRUE, right == TRUE)
        may_hold = better.step(t, last, left != FALSE, right != FALSE)
        self.wake = min(worse.next_change(t), better.next_change(t))
        return TRUE if holds else UNKNOWN if may_hold else FALSE


class Previous:
    """`Y`: the operand at the position before, false at the first.

    Args:
        gap: ticks between two positions, where that is fixed.
    """

    __slots__ = ("gap", "seen", "wake")

    def __init__(self, gap: int) -> None:
        self.gap = gap
        self.seen = FALSE
        self.wake = NEVER

    def step(self, t: int, operand: int) -> int:
        """The value at `t`; the operand was as given last at all positions up to the one before."""
        value, self.seen = self.seen, operand
        self.wake = t + self.gap if value != operand else NEVER
        return value
