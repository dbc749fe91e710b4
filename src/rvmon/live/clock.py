"""What time it is for a monitor, and when it will be later."""

from __future__ import annotations

import time
from collections.abc import Callable
from threading import Lock
from typing import Protocol

from rvmon.errors import TraceError
from rvmon.trace.time import TICKS_PER_SECOND, format_ticks, whole_ticks

FAR_NS = 365 * 86_400 * TICKS_PER_SECOND
"""Stamps that are so far from the clock are of another epoch."""

_AHEAD_NS = 10 * TICKS_PER_SECOND
"""Stamps that are so far ahead of a clock that runs by itself are wrong: taken, they would make all
others late until it has come there."""

Change = Callable[[int, int], None]
"""Called with the instants, ns, before and after somebody set a clock."""


class Clock(Protocol):
    """Time as a driver takes it; to be asked from any thread."""

    def now_ns(self) -> int:
        """The instant, ns."""
        ...

    def seconds_until(self, t_ns: int) -> float | None:
        """How long to sleep until an instant; `None`: until somebody sets the clock."""
        ...

    def on_change(self, callback: Change) -> None:
        """Have a function called whenever somebody sets the clock."""
        ...


class WallClock:
    """Nanoseconds since it was made, or since 1970, that pass evenly.

    It follows the monotonic clock of the machine: where that of the wall is set, for summer or by
    NTP, this one does not jump.

    Args:
        since_1970: whether it begins with the time of day in UTC, as the stamps of messages do,
            instead of 0, which is easier to read.
    """

    def __init__(self, *, since_1970: bool = False) -> None:
        began = time.time_ns() if since_1970 else 0
        self._offset = began - time.monotonic_ns()

    def now_ns(self) -> int:
        """The instant, ns."""
        return time.monotonic_ns() + self._offset

    def seconds_until(self, t_ns: int) -> float:
        """How long to sleep until an instant."""
        return max(0, t_ns - self.now_ns()) / TICKS_PER_SECOND

    def on_change(self, callback: Change) -> None:
        """Nothing: nobody sets it."""


class SimulatedClock:
    """A clock that stands until it is set, as by the topic `/clock` of a simulator, or by a test.

    >>> clock = SimulatedClock()
    >>> clock.set_ns(5)
    >>> clock.now_ns()
    5
    """

    def __init__(self, now_ns: int = 0) -> None:
        self._now = whole_ticks(now_ns)
        self._callbacks: list[Change] = []
        self._lock = Lock()

    def now_ns(self) -> int:
        """The instant, ns."""
        return self._now

    def set_ns(self, t_ns: int) -> None:
        """Set it; back as well, as a simulation that starts again does.

        Raises:
            TraceError: that is no instant.
        """
        with self._lock:
            before, self._now = self._now, whole_ticks(t_ns)
        for callback in tuple(self._callbacks):
            callback(before, self._now)

    def seconds_until(self, t_ns: int) -> float | None:
        """Nobody knows, but that an instant has come."""
        return 0.0 if t_ns <= self._now else None

    def on_change(self, callback: Change) -> None:
        """Have a function called whenever it is set."""
        self._callbacks.append(callback)


def refuse_far(t_ns: int, now_ns: int) -> None:
    """Refuse a stamp that is of another epoch than a clock that runs by itself, or ahead of it.

    Raises:
        TraceError: it is.
    """
    if not now_ns - FAR_NS < t_ns < now_ns + _AHEAD_NS:
        far = "years from" if abs(t_ns - now_ns) > FAR_NS else "ahead of"
        raise TraceError(
            f"the stamp {format_ticks(t_ns)} is {far} the clock, which shows "
            f"{format_ticks(now_ns)}: set the clocks of the machines alike, or give the driver "
            "the clock of the stamps, such as WallClock(since_1970=True)"
        )
