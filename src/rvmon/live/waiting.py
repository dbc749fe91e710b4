"""What waits: samples to be judged, with what was lost before they came, and robots for a time."""

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
    """A sample as it was offered.

    Attributes:
        robot: whose it is.
        t: its instant, ns.
        values: as for `Monitor.step_ns`.
    """

    robot: str
    t: int
    values: Values


@dataclass(slots=True)
class Dropped:
    """Samples of a robot, one after the other, for which there was no room.

    Attributes:
        robot: whose they were.
        first: the least instant of one, ns.
        last: the greatest.
        count: how many they were.
        names: what they spoke of.
    """

    robot: str
    first: int
    last: int
    count: int = 0
    names: set[str] = field(default_factory=set)

    def add(self, sample: Offered) -> None:
        """One more sample is lost."""
        self.count += 1
        self.names.update(sample.values)
        self.first, self.last = min(self.first, sample.t), max(self.last, sample.t)


class Told(Enum):
    """What is told of names that a source may have spoken of."""

    LOST = "lost"
    FOUND = "found"
    MISSED = "missed"


@dataclass(frozen=True, slots=True)
class Gap:
    """What a door lost of a robot; see `Monitor.lose_ns`, `found_ns` and `miss`.

    Attributes:
        robot: whose it was.
        told: what.
        names: of signals and events; `None`: all.
        since: the first instant at which they are lost, ns, or the last of those that are found.
        until: the last instant; `None`: they stay lost.
        why: a phrase for people.
    """

    robot: str
    told: Told
    names: Collection[str] | None
    since: int = 0
    until: int | None = None
    why: str = ""


@dataclass(frozen=True, slots=True)
class NewRun:
    """From here on each robot begins a new run."""

    why: str


Entry = Offered | Dropped | Gap | NewRun


class Waiting:
    """A queue with room for so many samples; what finds it full is lost, and counted.

    What was lost stands in the queue where it would have stood: one `Dropped` for all samples of a
    robot between two that were taken, so that at most twice as many entries wait as there is room
    for. It is not locked.
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
        """Have a sample wait; return whether there was room."""
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
        """Have it be told behind all that waits."""
        self.robots.add(gap.robot)
        self._losing.pop(gap.robot, None)
        self._entries.append(gap)

    def put_new_run(self, why: str) -> None:
        """Have new runs begin behind all that wait."""
        self._losing.clear()
        self._entries.append(NewRun(why))

    def take(self, most: int) -> list[Entry]:
        """Take what has waited longest, at most so many entries."""
        taken = [self._entries.popleft() for _ in range(min(most, len(self._entries)))]
        for one in taken:
            if isinstance(one, Dropped) and self._losing.get(one.robot) is one:
                del self._losing[one.robot]
        return taken


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
