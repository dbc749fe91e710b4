"""Samples that wait to be judged, and what was lost because too many did."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
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
class Lost:
    """Samples of a robot, one after the other, for which there was no room.

    Attributes:
        robot: whose they were.
        t: the instant of the first, ns.
        last: of the last, ns.
        count: how many they were.
        names: what they spoke of.
        occurrences: the instants at which events may have occurred, with their names; `None` if
            there were too many to be kept.
    """

    robot: str
    t: int
    last: int
    count: int = 0
    names: set[str] = field(default_factory=set)
    occurrences: list[tuple[int, tuple[str, ...]]] | None = field(default_factory=list)

    def add(self, t: int, values: Values, events: frozenset[str], most: int) -> None:
        """One more sample is lost.

        Args:
            t: its instant, ns.
            values: what it said.
            events: the names that are events.
            most: so many occurrences are kept.
        """
        self.last = t
        self.count += 1
        self.names.update(values)
        occurred = tuple(name for name in values if name in events and values[name] is not False)
        if occurred and self.occurrences is not None:
            self.occurrences.append((t, occurred))
            if len(self.occurrences) > most:
                self.occurrences = None


@dataclass(frozen=True, slots=True)
class NewRun:
    """From here on each robot begins a new run.

    Attributes:
        why: one sentence for people.
    """

    why: str


Entry = Offered | Lost | NewRun


class Waiting:
    """A queue with room for so many samples; what finds it full is lost, and counted.

    What was lost stands in the queue where it would have stood: one `Lost` for all samples of a
    robot between two that were taken, so that at most twice as many entries wait as there is room
    for. It is not locked.

    Args:
        room: so many samples may wait.
    """

    def __init__(self, room: int) -> None:
        self.room = room
        self._entries: deque[Entry] = deque()
        self._losing: dict[str, Lost] = {}

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def is_full(self) -> bool:
        """Whether the next sample would be lost."""
        return len(self._entries) >= self.room

    def put(self, sample: Offered, events: frozenset[str]) -> bool:
        """Have a sample wait; tell whether there was room.

        Args:
            sample: the sample.
            events: the names that are events.
        """
        if len(self._entries) < self.room:
            self._losing.pop(sample.robot, None)
            self._entries.append(sample)
            return True
        lost = self._losing.get(sample.robot)
        if lost is None:
            lost = self._losing[sample.robot] = Lost(sample.robot, sample.t, sample.t)
            self._entries.append(lost)
        lost.add(sample.t, sample.values, events, self.room)
        return False

    def put_new_run(self, why: str) -> None:
        """Have new runs begin behind all that wait."""
        self._losing.clear()
        self._entries.append(NewRun(why))

    def take(self, most: int) -> list[Entry]:
        """Take what has waited longest, at most so many entries."""
        if len(self._entries) <= most:
            taken = list(self._entries)
            self._entries.clear()
            self._losing.clear()
            return taken
        taken = [self._entries.popleft() for _ in range(most)]
        for one in taken:
            if isinstance(one, Lost) and self._losing.get(one.robot) is one:
                del self._losing[one.robot]
        return taken
