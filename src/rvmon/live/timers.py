"""When robots are to be looked at next."""

from __future__ import annotations

import heapq
from collections.abc import Iterator


class Timers:
    """The instant, ns, at which each robot is to be looked at, if it is not looked at before."""

    def __init__(self) -> None:
        self._queue: list[tuple[int, str]] = []
        self._next: dict[str, int] = {}

    @property
    def first(self) -> int | None:
        """The next instant at which one is to be looked at; it may have been, meanwhile."""
        return self._queue[0][0] if self._queue else None

    def set(self, robot: str, t: int) -> None:
        """Have one looked at when an instant has come; the earliest one counts."""
        known = self._next.get(robot)
        if known is None or t < known:
            self._next[robot] = t
            heapq.heappush(self._queue, (t, robot))

    def forget(self, robot: str) -> None:
        """Have it looked at no more."""
        self._next.pop(robot, None)

    def take_due(self, now: int) -> Iterator[tuple[int, str]]:
        """The robots whose time has come, each with that instant; what is set meanwhile counts."""
        while self._queue and self._queue[0][0] <= now:
            t, robot = heapq.heappop(self._queue)
            if self._next.get(robot) == t:  # else it was looked at before
                del self._next[robot]
                yield t, robot
