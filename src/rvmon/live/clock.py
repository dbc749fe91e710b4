"""The clocks of a driver: wall time, or the time of a simulation."""

from __future__ import annotations

import time
from collections.abc import Callable
from threading import Lock
from typing import Protocol

from rvmon.errors import TraceError
from rvmon.trace.time import TICKS_PER_SECOND, format_ticks, whole_ticks

FAR_NS = 365 * 86_400 * TICKS_PER_SECOND
"""Stamps farther than this from the clock belong to another epoch."""

_AHEAD_NS = 10 * TICKS_PER_SECOND
"""Stamps farther than this ahead of a wall clock are refused: if accepted, they would make all
later samples late until the clock has caught up."""

Change = Callable[[int, int], None]
"""Called with the instants, ns, before and after a clock was set."""


class Clock(Protocol):
    """A source of time for a driver; thread-safe."""

    def now_ns(self) -> int:
        """The current instant, ns."""
        ...

    def seconds_until(self, t_ns: int) -> float | None:
        """The seconds to sleep until an instant; `None`: until the clock is set."""
        ...

    def on_change(self, callback: Change) -> None:
        """Register a callback for changes of the clock."""
        ...


class WallClock:
    """Nanoseconds since its creation, or since 1970, by the monotonic clock of the machine.

    It does not jump when the system time is set, by hand or by NTP.

    Args:
        since_1970: whether it starts at the time in UTC, as the stamps of messages do, instead of
            0, which is easier to read.
    """

    def __init__(self, *, since_1970: bool = False) -> None:
        began = time.time_ns() if since_1970 else 0
        self._offset = began - time.monotonic_ns()

    def now_ns(self) -> int:
        """The instant, ns."""
        return time.monotonic_ns() + self._offset

    def seconds_until(self, t_ns: int) -> float:
        """The seconds to sleep until an instant."""
        return max(0, t_ns - self.now_ns()) / TICKS_PER_SECOND

    def on_change(self, callback: Change) -> None:
        """Ignored, as it is never set."""


class SimulatedClock:
    """A clock that stands still until it is set, by the topic `/clock` of a simulator or by a test.

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
        """Set the clock, also backwards, as when a simulation restarts.

        Raises:
            TraceError: `t_ns` is not an instant.
        """
        with self._lock:
            before, self._now = self._now, whole_ticks(t_ns)
        # Called without the lock: a callback may set the clock again.
        for callback in tuple(self._callbacks):
            callback(before, self._now)

    def seconds_until(self, t_ns: int) -> float | None:
        """0 if the clock has reached the instant, else `None`."""
        return 0.0 if t_ns <= self._now else None

    def on_change(self, callback: Change) -> None:
        """Register a callback for changes of the clock."""
        self._callbacks.append(callback)


def refuse_far(t_ns: int, now_ns: int) -> None:
    """Refuse a stamp that has another epoch than a wall clock or is too far ahead of it.

    Raises:
        TraceError: the stamp is refused.
    """
    if not now_ns - FAR_NS < t_ns < now_ns + _AHEAD_NS:
        far = "years from" if abs(t_ns - now_ns) > FAR_NS else "ahead of"
        raise TraceError(
            f"the stamp {format_ticks(t_ns)} is {far} the clock, which shows "
            f"{format_ticks(now_ns)}: synchronise the clocks of the machines, or use the time of "
            "the stamps: a stamp in each line and no --realtime, in Python a clock of their epoch, "
            "such as WallClock(since_1970=True)"
        )
