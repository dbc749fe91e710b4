"""What a recording holds under one name: data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite

from rvmon.starter.course import Course
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Shape:
    """What the values of one name look like, before time is looked at.

    Attributes:
        kind: of a signal; `None` for an event.
        labels: the values of a label signal, in order of appearance.
        fields: of an event with payload.
        unit: of a number, as the messages say it; empty if they do not.
        source: the topic; empty of columns.
    """

    kind: Kind | None
    labels: tuple[str, ...] = ()
    fields: Mapping[str, Kind] = field(default_factory=dict)
    unit: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class Shapes:
    """The names of a recording that a specification can declare, and those that it cannot.

    Attributes:
        declared: by name, in order of appearance.
        left_out: by name, why.
    """

    declared: Mapping[str, Shape]
    left_out: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Column:
    """One name of a recording.

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
    instants: tuple[int, ...] = ()
    course: Course = field(default_factory=lambda: Course(0))

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
