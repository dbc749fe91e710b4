"""How a name goes over time, in a bounded number of stretches."""

from __future__ import annotations

from dataclasses import dataclass, field

from rvmon.trace.sample import Value

MOST = 160
"""Stretches of a course."""


@dataclass(slots=True)
class Stretch:
    """What was said in a stretch of time.

    Attributes:
        updates: how often; of an event its occurrences.
        low: least number; `None` if there is none.
        high: greatest number.
    """

    updates: int = 0
    low: float | None = None
    high: float | None = None

    def join(self, other: Stretch) -> None:
        """Take the stretch behind this one in."""
        self.updates += other.updates
        if other.low is not None and other.high is not None:
            self.low = other.low if self.low is None else min(self.low, other.low)
            self.high = other.high if self.high is None else max(self.high, other.high)


@dataclass(slots=True)
class Course:
    """The stretches from the first instant on, all of one length, which doubles as time goes on.

    Attributes:
        start: the first instant, ticks.
        length: of a stretch, ticks.
        stretches: in order.
        labels: the number that each label is drawn at.
    """

    start: int
    length: int = 1 << 16
    stretches: list[Stretch] = field(default_factory=list)
    labels: dict[str, int] = field(default_factory=dict)

    def note(self, t: int, value: Value) -> None:
        """Take an update; of an event also that nothing happened.

        Args:
            t: its instant, not before the start.
            value: what was said.
        """
        place = max(0, t - self.start) // self.length
        while place >= MOST:
            for first in range(0, len(self.stretches) - 1, 2):
                self.stretches[first].join(self.stretches[first + 1])
            self.stretches = self.stretches[::2]
            self.length *= 2
            place = max(0, t - self.start) // self.length
        while len(self.stretches) <= place:
            self.stretches.append(Stretch())
        one = self.stretches[place]
        one.updates += 1
        if isinstance(value, str):
            number: float = self.labels.setdefault(value, len(self.labels))
        elif isinstance(value, bool | int | float):
            number = float(value)
        else:
            return
        if number == number and abs(number) != float("inf"):
            one.low = number if one.low is None else min(one.low, number)
            one.high = number if one.high is None else max(one.high, number)

    def until(self, end: int) -> list[Stretch]:
        """The stretches up to an instant, those in which nothing was said too."""
        count = max(1, min(MOST, -(-(end - self.start + 1) // self.length)))
        return self.stretches + [Stretch() for _ in range(count - len(self.stretches))]
