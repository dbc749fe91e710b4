"""What happens when: a queue of calls at integer nanoseconds."""

from __future__ import annotations

import heapq
from collections.abc import Callable


class Schedule:
    """Calls in order of time; calls of one instant in the order in which they were entered.

    Attributes:
        now_ns: the instant of the call that is running.
    """

    def __init__(self) -> None:
        self.now_ns = 0
        self._queue: list[tuple[int, int, Callable[[], None]]] = []
        self._entered = 0

    def at(self, t_ns: int, call: Callable[[], None]) -> None:
        """Enter a call at an instant that is not before now."""
        heapq.heappush(self._queue, (t_ns, self._entered, call))
        self._entered += 1

    def next_ns(self) -> int | None:
        """The instant of the next call, or `None` if there is none."""
        return self._queue[0][0] if self._queue else None

    def run_next(self) -> None:
        """Set the time to that of the next call and make it."""
        self.now_ns, _, call = heapq.heappop(self._queue)
        call()
