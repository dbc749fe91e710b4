"""The bounded queue of samples and losses, and the timers of robots."""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

Values = Mapping[str, Any]


@dataclass(slots=True)
class Offered:
    """A sample as it was offered."""

    robot: str  # the name of its robot
    t: int  # its instant, ns
    values: Values  # as for `Monitor.step_ns`


@dataclass(slots=True)
class Dropped:
    """Consecutive samples of a robot that found the queue full."""

    robot: str  # the name of the robot
    first: int  # the least of their instants, ns
    last: int  # the greatest
    count: int = 0  # their number
    names: set[str] = field(default_factory=set)  # the names that they update

    def add(self, sample: Offered) -> None:
        """Add a lost sample."""
        self.count += 1
        self.names.update(sample.values)
        self.first, self.last = min(self.first, sample.t), max(self.last, sample.t)


class OutageReport(Enum):
    """The kinds of reports on outages."""

    LOST = "lost"
    FOUND = "found"
    MISSED = "missed"


@dataclass(frozen=True, slots=True)
class Gap:
    """A report on an outage of a robot; see `Monitor.lose_ns`, `found_ns` and `miss`."""

    robot: str  # the name of the robot
    kind: OutageReport  # of the report
    names: Collection[str] | None  # signals and events; `None`: all
    since: int = 0  # the first instant of the outage, ns; for `FOUND` its last instant
    until: int | None = None  # the last instant, ns; `None`: not yet known
    why: str = ""  # a phrase for the input health


@dataclass(frozen=True, slots=True)
class NewRun:
    """A mark in the queue at which each robot begins a new run."""

    why: str


Entry = Offered | Dropped | Gap | NewRun


class Waiting:
    """A bounded queue of samples; a sample that finds it full is counted as dropped.

    Drops keep their place in the queue. One `Dropped` stands for all samples of a robot dropped
    between two queued ones, so that samples and drops are at most `room` plus the number of robots.
    Not thread-safe.
    """

    def __init__(self, room: int) -> None:
        self.room = room
        self.robots: set[str] = set()
        self._entries: deque[Entry] = deque()
        self._losing: dict[str, Dropped] = {}

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def is_full(self) -> bool:
        """Whether the next sample would be lost."""
        return len(self._entries) >= self.room

    def put(self, sample: Offered) -> bool:
        """Queue a sample; returns whether there was room."""
        self.robots.add(sample.robot)
        if not self.is_full:
            self._losing.pop(sample.robot, None)
            self._entries.append(sample)
            return True
        lost = self._losing.get(sample.robot)
        if lost is None:
            lost = self._losing[sample.robot] = Dropped(sample.robot, sample.t, sample.t)
            self._entries.append(lost)
        lost.add(sample)
        return False

    def put_gap(self, gap: Gap) -> None:
        """Queue a report on an outage, regardless of `room`."""
        self.robots.add(gap.robot)
        # Samples lost after this report are a new outage.
        self._losing.pop(gap.robot, None)
        self._entries.append(gap)

    def put_new_run(self, why: str) -> None:
        """Queue the start of new runs, regardless of `room`."""
        self._losing.clear()
        self._entries.append(NewRun(why))

    def take(self, most: int) -> list[Entry]:
        """Remove the oldest entries, at most `most`."""
        taken = [self._entries.popleft() for _ in range(min(most, len(self._entries)))]
        for dropped in taken:
            # The entry has left the queue, so further losses need a new one.
            if isinstance(dropped, Dropped) and self._losing.get(dropped.robot) is dropped:
                del self._losing[dropped.robot]
        return taken


class Timers:
    """The next due instant (ns) of each robot: a heap with lazy deletion."""

    def __init__(self) -> None:
        self._queue: list[tuple[int, str]] = []
        self._next: dict[str, int] = {}

    @property
    def first(self) -> int | None:
        """A lower bound of the next due instant; `None` if no timer is set."""
        return self._queue[0][0] if self._queue else None

    def set(self, robot: str, t: int) -> None:
        """Set the timer of a robot, unless it is set to an earlier instant."""
        known = self._next.get(robot)
        if known is None or t < known:
            self._next[robot] = t
            heapq.heappush(self._queue, (t, robot))

    def forget(self, robot: str) -> None:
        """Cancel the timer of a robot."""
        self._next.pop(robot, None)

    def take_due(self, now: int) -> Iterator[tuple[int, str]]:
        """The robots due by `now`, each with its instant; timers may be set during iteration."""
        while self._queue and self._queue[0][0] <= now:
            t, robot = heapq.heappop(self._queue)
            if self._next.get(robot) == t:  # else the entry is outdated
                del self._next[robot]
                yield t, robot
