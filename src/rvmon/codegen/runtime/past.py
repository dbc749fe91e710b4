"""Past operators and numbers of generated monitors."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

NEVER = 1 << 63
FALSE, UNKNOWN, TRUE = 0, 1, 2


class Stretches:
    """One Boolean reading of `left S[low, high] right`: the merged instants at which it holds.

    Source: interval marking after Basin, Klaedtke and Zalinescu 2011.
    """

    __slots__ = ("gap", "growing", "high", "left", "low", "right", "runs")

    def __init__(self, low: int, high: int | None, gap: int) -> None:
        self.low = low
        self.high = NEVER if high is None else high
        self.gap = gap
        self.left = True
        self.right = False
        self.growing = False
        self.runs: deque[list[int]] = deque()

    def step(self, t: int, last: int, left: bool, right: bool) -> bool:
        """Take the operands at `t`; those given before held at all positions up to `last`."""
        if self.growing:
            self.runs[-1][1] = last + self.high
            self.growing = False
        if not self.left and self.right:
            self.mark(last + self.low, last + self.high)
        self.left, self.right = left, right
        runs = self.runs
        if not left:
            runs.clear()
            return right and self.low == 0
        if right:
            self.mark(t + self.low, NEVER)
            self.growing = True
        while runs and runs[0][1] < t:
            runs.popleft()
        return bool(runs) and runs[0][0] <= t

    def mark(self, start: int, end: int) -> None:
        """Add the stretch from `start` to `end`."""
        if self.runs and start - self.gap <= self.runs[-1][1]:
            self.runs[-1][1] = end
        else:
            self.runs.append([start, end])

    def next_change(self, t: int) -> int:
        """The next instant after `t` at which the value changes, the operands staying."""
        if not self.runs:
            return NEVER
        start, end = self.runs[0]
        return start if start > t else min(end + 1, NEVER)


class Since:
    """`left S[low, high] right` with Kleene's values: a pessimistic and an optimistic reading."""

    __slots__ = ("optimistic", "pessimistic", "wake")

    def __init__(self, low: int, high: int | None, gap: int) -> None:
        self.pessimistic = Stretches(low, high, gap)
        self.optimistic = Stretches(low, high, gap)
        self.wake = NEVER

    def step(self, t: int, last: int, left: int, right: int) -> int:
        """The value at `t`; `last` is the position before."""
        worse, better = self.pessimistic, self.optimistic
        holds = worse.step(t, last, left == TRUE, right == TRUE)
        may_hold = better.step(t, last, left != FALSE, right != FALSE)
        self.wake = min(worse.next_change(t), better.next_change(t))
        return TRUE if holds else UNKNOWN if may_hold else FALSE


class Previous:
    """The operand at the position before, false at the first."""

    __slots__ = ("gap", "seen", "wake")

    def __init__(self, gap: int) -> None:
        self.gap = gap
        self.seen = FALSE
        self.wake = NEVER

    def step(self, t: int, operand: int) -> int:
        """The value at `t`."""
        value, self.seen = self.seen, operand
        self.wake = t + self.gap if value != operand else NEVER
        return value


class History:
    """The last two updates of a signal."""

    __slots__ = ("at", "before", "before_at", "last", "updates")

    def __init__(self) -> None:
        self.updates = 0
        self.last: Any = None
        self.before: Any = None
        self.at = self.before_at = 0

    def update(self, t: int, value: Any) -> int:
        """Take an update; returns whether it brought another value."""
        first = not self.updates
        self.before, self.before_at = self.last, self.at
        self.last, self.at = value, t
        self.updates = 1 if first else 2
        if first:
            return FALSE
        if value is None or self.before is None:
            return UNKNOWN
        return TRUE if value != self.before else FALSE

    def prev(self, now: Any) -> Any:
        """The value before; `now` is the signal's value."""
        return self.before if self.updates == 2 and now is not None else None

    def delta(self, now: Any) -> Any:
        """The difference of the last two values."""
        before = self.prev(now)
        if before is None or isinstance(before, str) or isinstance(now, str):
            return None
        return finite(_minus, now, before)

    def rate(self, now: Any) -> Any:
        """The difference per second."""
        difference = self.delta(now)
        if difference is None:
            return None
        return finite(_ratio, difference * 1000000000, self.at - self.before_at)


def _minus(left: float, right: float) -> float:
    return left - right


def _ratio(left: float, right: float) -> float:
    return left / right


def number(value: Any) -> Any:
    """A payload's field; NaN is unknown."""
    return None if value != value else value


def finite(operation: Callable[..., float], *values: Any) -> float | None:
    """The result of an operation; unknown if an operand is, or if it is no finite number."""
    for value in values:
        if value is None or isinstance(value, str):
            return None
    try:
        result = operation(*values)
        return result if math.isfinite(result) else None
    except (ValueError, OverflowError, ZeroDivisionError):
        return None


def compared(operation: Callable[[Any, Any], bool], left: Any, right: Any) -> int:
    """The truth of a comparison."""
    if left is None or right is None:
        return UNKNOWN
    return TRUE if operation(left, right) else FALSE
