"""Past operators and numbers."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from rvmon.runtime.values import FALSE, NEVER, TRUE, UNKNOWN
from rvmon.trace.sample import calculated

if TYPE_CHECKING:
    from collections.abc import Callable


class Since:
    """`left S[low, high] right` with Kleene's values: the merged stretches in which it holds.

    Each position s with `right` true makes it true at s + low … s + high, until `left` is false.
    These stretches are merged where they touch, so that their number is bounded by
    low / (high − low) and not by the number of samples.

    As soon as an operand is unknown there are two readings: this one takes the unknown for false,
    the one beside it for true, until both agree again.

    Source: interval marking after Basin, Klaedtke and Zalinescu 2011.
    """

    __slots__ = ("better", "gap", "growing", "high", "left", "low", "right", "runs")

    STATE = __slots__

    def __init__(self, low: int, high: int | None, gap: int) -> None:
        self.low = low
        self.high = NEVER if high is None else high
        self.gap = gap
        self.left = True
        self.right = False
        self.growing = False
        self.runs: deque[list[int]] = deque()
        self.better: Since | None = None

    def step(self, t: int, last: int, left: int, right: int) -> tuple[int, int]:
        """Take the operands at `t`; those given before held at all positions up to `last`.

        Returns the value, and when it changes by time alone, the operands staying.
        """
        if left == UNKNOWN or right == UNKNOWN or self.better is not None:
            return self._step_both(t, last, left, right)
        runs = self.runs
        if self.growing:
            runs[-1][1] = last + self.high
            self.growing = False
        elif self.right and not self.left:
            self.mark(last + self.low, last + self.high)
        self.right = right == TRUE
        self.left = left == TRUE
        if not self.left:
            runs.clear()
            return (TRUE if self.right and self.low == 0 else FALSE), NEVER
        if right:
            # As `mark`, in place: it is what samples come to most often.
            start = t + self.low
            if runs and start - self.gap <= runs[-1][1]:
                runs[-1][1] = NEVER
            else:
                runs.append([start, NEVER])
            self.growing = True
        while runs:
            start, end = runs[0]
            if end >= t:
                if start > t:
                    return FALSE, start
                return TRUE, end + 1 if end < NEVER else NEVER
            runs.popleft()
        return FALSE, NEVER

    def _step_both(self, t: int, last: int, left: int, right: int) -> tuple[int, int]:
        better = self.better or self.copy()
        self.better = None
        holds, wake = self.step(t, last, _worse(left), _worse(right))
        may_hold, other = better.step(t, last, _better(left), _better(right))
        if not self._same(better):
            self.better = better
        return (TRUE if holds else UNKNOWN if may_hold else FALSE), min(wake, other)

    def mark(self, start: int, end: int) -> None:
        """Add the stretch from `start` to `end`."""
        if self.runs and start - self.gap <= self.runs[-1][1]:
            self.runs[-1][1] = end
        else:
            self.runs.append([start, end])

    def copy(self) -> Since:
        """The same, independent from now on."""
        made = Since(self.low, self.high, self.gap)
        made.left, made.right, made.growing = self.left, self.right, self.growing
        made.runs = deque([list(one) for one in self.runs])
        made.better = None if self.better is None else self.better.copy()
        return made

    def _same(self, other: Since) -> bool:
        """Whether they have come to remember the same."""
        mine = (self.left, self.right, self.growing)
        return mine == (other.left, other.right, other.growing) and self.runs == other.runs

    @property
    def memory(self) -> tuple[object, ...]:
        """What it remembers, by value."""
        better = None if self.better is None else self.better.memory
        return self.left, self.right, self.growing, [*map(tuple, self.runs)], better


def _worse(truth: int) -> int:
    return TRUE if truth == TRUE else FALSE


def _better(truth: int) -> int:
    return FALSE if truth == FALSE else TRUE


def within(
    end: int | None, t: int, last: int, high: int, left: bool, right: bool
) -> tuple[int | None, bool, int]:
    """One reading of `left S[0, high] right` at `t`.

    Args:
        end: the last instant at which it holds as of the position before; `None` if `right` was
            true there.
        t: the position.
        last: the position before.
        high: the bound.
        left: the left operand.
        right: the right operand.

    Returns:
        The new `end`, the value, and the instant at which it changes by time alone.
    """
    if end is None:
        end = last + high
    if right:
        return None, True, NEVER
    if not left:
        return -NEVER, False, NEVER
    return end, end >= t, end + 1 if end >= t else NEVER


def beyond(
    start: int | None, t: int, last: int, low: int, left: bool, right: bool
) -> tuple[int | None, bool, int]:
    """One reading of `left S[low, inf) right` at `t`, with a `low` above 0.

    Args:
        start: the first instant at which it holds; `None` if there is none; `True` if at the
            position before, `right` was true and `left` was not.
        t: the position.
        last: the position before.
        low: the bound.
        left: the left operand.
        right: the right operand.

    Returns:
        The new `start`, the value, and the instant at which it changes by time alone.
    """
    if start is True:
        start = last + low
    if not left:
        return True if right else None, False, NEVER
    if start is None:
        if not right:
            return None, False, NEVER
        start = t + low
    return start, start <= t, start if start > t else NEVER


def doubt(before: int, now: int, value: int, pulse: bool, every: bool = False) -> int:
    """Whether a trigger may have been hidden at a position.

    Args:
        before: the truth of the trigger at the position before.
        now: its truth.
        value: what this was at the position before.
        pulse: whether the trigger starts an attempt wherever it is true.
        every: whether no trigger is sure.

    Source: SEMANTICS, section 3 (Doubt).

    >>> doubt(FALSE, UNKNOWN, FALSE, False), doubt(UNKNOWN, FALSE, UNKNOWN, False)
    (1, 0)
    >>> doubt(UNKNOWN, TRUE, UNKNOWN, True)
    2
    """
    if now == FALSE:
        return FALSE
    if every:
        hidden = pulse or before != TRUE
    else:
        starts = now == UNKNOWN and (pulse or before == FALSE)
        hidden = starts or (before == UNKNOWN and not pulse)
    return UNKNOWN if hidden else TRUE if value else FALSE


class History:
    """The last two updates of a signal."""

    __slots__ = ("at", "before", "before_at", "last", "updates")

    STATE: tuple[str, ...] = __slots__

    def __init__(self) -> None:
        self.updates = 0
        self.last: Any = None
        self.before: Any = None
        self.at = self.before_at = 0

    def copy(self) -> History:
        """The same, independent from now on."""
        made = History()
        made.updates, made.last, made.before = self.updates, self.last, self.before
        made.at, made.before_at = self.at, self.before_at
        return made

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


finite = calculated


def number(value: Any) -> Any:
    """A payload's field; NaN is unknown."""
    return None if value != value else value


def compared(operation: Callable[[Any, Any], bool], left: Any, right: Any) -> int:
    """The truth of a comparison."""
    if left is None or right is None:
        return UNKNOWN
    return TRUE if operation(left, right) else FALSE
