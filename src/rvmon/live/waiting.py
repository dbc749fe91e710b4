"""Samples that wait to be judged, and what was lost because too many did."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

Values = Mapping[str, Any]

_MOST_MOMENTS = 100_000
"""So many instants of what was lost in a row are kept: some ten megabytes."""


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


@dataclass(frozen=True, slots=True)
class Names:
    """What samples speak of.

    Attributes:
        signals: the signals.
        momentary: what says something of an instant only: events; `None`: all, as each sample is a
            position.
        ignoring: signals that cannot be declared unknown, as they `ignore NaN`.
    """

    signals: tuple[str, ...]
    momentary: frozenset[str] | None
    ignoring: frozenset[str]


@dataclass(slots=True)
class Lost:
    """Samples of a robot, one after the other, for which there was no room.

    Attributes:
        robot: whose they were.
        t: the instant of the first, ns.
        count: how many they were.
        names: what they spoke of.
        moments: the instants at which there may be something, with the names of what: occurrences
            of events, positions; `None` if there were too many to be kept, or what was lost cannot
            be declared unknown.
    """

    robot: str
    t: int
    count: int = 0
    names: set[str] = field(default_factory=set)
    moments: list[tuple[int, tuple[str, ...]]] | None = field(default_factory=list)

    def add(self, sample: Offered, known: Names) -> None:
        """One more sample is lost."""
        self.count += 1
        self.names.update(sample.values)
        gone = tuple(name for name in sample.values if _is_momentary(name, sample.values, known))
        if gone and self.moments is not None:
            self.moments.append((sample.t, gone))
        too_many = self.moments is not None and len(self.moments) > _MOST_MOMENTS
        if too_many or not known.ignoring.isdisjoint(_known(sample.values)):
            self.moments = None


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
    for. The first two values of a signal always find room: before them it is not born, and what is
    lost then would be excused (SEMANTICS 1). It is not locked.

    Args:
        room: so many samples may wait.
        names: what samples speak of.
    """

    def __init__(self, room: int, names: Names) -> None:
        self.room = room
        self._entries: deque[Entry] = deque()
        self._losing: dict[str, Lost] = {}
        self.expect(names)

    def __len__(self) -> int:
        return len(self._entries)

    def expect(self, names: Names) -> None:
        """Samples are of another specification from now on."""
        self._names = names
        self._unborn: dict[str, Counter[str]] = {}

    @property
    def is_full(self) -> bool:
        """Whether the next sample would be lost."""
        return len(self._entries) >= self.room

    @property
    def robots(self) -> Collection[str]:
        """The robots whose samples came."""
        return self._unborn.keys()

    def put(self, sample: Offered) -> bool:
        """Have a sample wait; return whether there was room."""
        unborn = self._unborn.get(sample.robot)
        if unborn is None:
            unborn = self._unborn[sample.robot] = Counter(dict.fromkeys(self._names.signals, 2))
        if len(self._entries) < self.room or (unborn and _bears(unborn, sample.values)):
            if unborn:
                unborn -= Counter(_known(sample.values))
            self._losing.pop(sample.robot, None)
            self._entries.append(sample)
            return True
        lost = self._losing.get(sample.robot)
        if lost is None:
            lost = self._losing[sample.robot] = Lost(sample.robot, sample.t)
            self._entries.append(lost)
        lost.add(sample, self._names)
        if lost.moments is None:  # a new run will begin
            del self._unborn[sample.robot]
        return False

    def put_new_run(self, why: str) -> None:
        """Have new runs begin behind all that wait."""
        self._losing.clear()
        self._unborn.clear()
        self._entries.append(NewRun(why))

    def take(self, most: int) -> list[Entry]:
        """Take what has waited longest, at most so many entries."""
        taken = [self._entries.popleft() for _ in range(min(most, len(self._entries)))]
        for one in taken:
            if isinstance(one, Lost) and self._losing.get(one.robot) is one:
                del self._losing[one.robot]
        return taken


def _known(values: Values) -> list[str]:
    return [name for name, value in values.items() if value is not None and value == value]


def _is_momentary(name: str, values: Values, known: Names) -> bool:
    return known.momentary is None or (name in known.momentary and values[name] is not False)


def _bears(unborn: Collection[str], values: Values) -> bool:
    return any(name in unborn for name in _known(values))
