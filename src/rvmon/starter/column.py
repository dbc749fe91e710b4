"""What a recording holds under one name, and how that goes over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite

from rvmon.trace.sample import Outage, Value
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

FEW = 5
"""Of fewer occurrences nobody knows whether they are regular."""

STEADY = 3
"""What keeps coming has no gap of more than so many times the mean one."""

MOST_INSTANTS = 10_000
"""Occurrences that are kept of one name."""

EVENT_SHARE = 0.1
"""Truth values that are true in single samples only, and in at most this share, are events."""


@dataclass(frozen=True, slots=True)
class Shape:
    """What the values of one name look like, before time is looked at.

    Attributes:
        kind: of a signal; `None` for an event.
        labels: the values of a label signal, in order of appearance.
        fields: of an event with payload.
        unit: of a number, as the messages say it; empty if they do not.
        source: the topic; empty of columns.
        is_part: whether it comes with other fields, in each message of its topic.
    """

    kind: Kind | None
    labels: tuple[str, ...] = ()
    fields: Mapping[str, Kind] = field(default_factory=dict)
    unit: str = ""
    source: str = ""
    is_part: bool = False


@dataclass(frozen=True, slots=True)
class Shapes:
    """The names of a recording that a specification can declare, and those that it cannot.

    Attributes:
        declared: by name, in order of appearance.
        left_out: by name, why.
    """

    declared: Mapping[str, Shape]
    left_out: Mapping[str, str]


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


@dataclass(slots=True)
class Column:
    """One name of a recording, followed from sample to sample.

    Attributes:
        name: as in the recording.
        shape: what its values look like; of a guessed event without a kind.
        guessed_event: whether its truth values were taken for an event.
        updates: how often it was updated, or occurred.
        low: least number seen; `None` if it is no number.
        high: greatest number seen.
        rate: updates per second; 0 if there were too few.
        longest_gap: between two updates, ticks.
        longest_silence: the same, or from the last update to the end.
        first: the instant of the first update, ticks; `None` if there was none.
        gaps_in_value: whether it is unknown somewhere: at the first sample, or by a value.
        instants: of an event its occurrences, of a truth value where it became true; ticks.
        course: how it goes over time.
    """

    name: str
    shape: Shape
    guessed_event: bool = False
    updates: int = 0
    low: float | None = None
    high: float | None = None
    rate: float = 0.0
    longest_gap: int = 0
    longest_silence: int = 0
    first: int | None = None
    gaps_in_value: bool = False
    instants: list[int] = field(default_factory=list)
    course: Course = field(default_factory=lambda: Course(0))
    _last: int = 0
    _trues: int = 0
    _falses: int = 0
    _silent: int = 0
    _before: bool = False
    _runs_are_single: bool = True

    @property
    def is_finite(self) -> bool:
        """Whether it is a number, and nowhere an infinite one."""
        return self.low is not None and self.high is not None and isfinite(self.high - self.low)

    @property
    def changes(self) -> bool:
        """Whether it is such a number, and not always the same."""
        return self.is_finite and self.low != self.high

    @property
    def is_event(self) -> bool:
        """Whether it is declared as an event."""
        return self.shape.kind is None

    def pass_over(self, *, first: bool) -> None:
        """A sample does not speak of it."""
        self.gaps_in_value |= first
        self._silent += 1

    def take(self, t: int, value: Value) -> None:
        """Take an update."""
        if self.first is None:
            self.first = t
        else:
            self.longest_gap = max(self.longest_gap, t - self._last)
        self._last = t
        self.updates += 1
        self.course.note(t, value)
        match value:
            case bool():
                self._truth(t, value)
            case int() | float() if value == value:
                self.low = value if self.low is None else min(self.low, value)
                self.high = value if self.high is None else max(self.high, value)
            case None | float():
                self.gaps_in_value = True
            case str():
                pass
            case _:
                self._occurred(t)

    def _truth(self, t: int, value: bool) -> None:
        if value:
            self._trues += 1
            self._runs_are_single &= not self._before
            if not self._before or self.is_event or not self._falses:
                self._occurred(t)
        else:
            self._falses += 1
        self._before = value

    def _occurred(self, t: int) -> None:
        if len(self.instants) < MOST_INSTANTS:
            self.instants.append(t)

    def end(self, start: int, end: int) -> None:
        """Take in between which instants the recording was."""
        if self.first is None:
            return
        span = self._last - self.first
        self.rate = (self.updates - 1) * TICKS_PER_SECOND / span if span > 0 else 0.0
        self.longest_silence = max(self.longest_gap, end - self._last)
        if self.shape.kind is Kind.BOOL and self._trues and self._is_like_event(start, end):
            self.shape = replace(self.shape, kind=None)
            self.guessed_event, self.updates = True, self._trues

    def _is_like_event(self, start: int, end: int) -> bool:
        if self._falses:
            most = EVENT_SHARE * (self._trues + self._falses)
            return self._runs_are_single and self._trues <= most
        # It is only ever reported when true: what keeps coming is always true, and no event; nor is
        # what others bring along.
        if self.shape.is_part:
            return False
        longest = max(self.longest_silence, (self.first or start) - start)
        keeps_coming = self._trues >= FEW and longest <= STEADY * (end - start) / self._trues
        return self._silent > self._trues and not keeps_coming


@dataclass(frozen=True, slots=True)
class Profile:
    """A recording, looked over.

    Attributes:
        path: of the recording.
        columns: that are declared, in order.
        left_out: by name, why.
        start: the first instant, ticks.
        end: the last instant, ticks.
        samples: how many.
        lateness: how far its time goes backwards at most, ticks; 0 if it is in order.
        outages: what it lost, as far as it says so.
    """

    path: str
    columns: tuple[Column, ...]
    left_out: Mapping[str, str]
    start: int
    end: int
    samples: int
    lateness: int
    outages: tuple[Outage, ...] = ()
