"""The values of a name in a recording, and their course over time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace

from rvmon.recordings.batch import NO_UPDATE, YES, Cells
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

if TYPE_CHECKING:
    from numpy.typing import NDArray

FEW = 5  # with fewer occurrences nothing is said about regularity
STEADY = 3  # the longest gap of a steady signal, in multiples of the mean gap
MOST_INSTANTS = 10_000  # the most instants that are kept for a name

EVENT_SHARE = 0.1
"""A truth value that is true in single samples only, and in at most this share, is an event."""


class Shape(Struct, frozen=True):
    """A possible declaration of a name."""

    kind: Kind | None  # of a signal; `None` for an event
    labels: tuple[str, ...] = ()  # the values of a label signal, in order of appearance
    fields: Mapping[str, Kind] = field(default_factory=dict)  # payload fields of an event
    unit: str = ""  # the unit of a number, or ""
    source: str = ""  # the topic; "" for a column
    is_part: bool = False  # whether every message of its topic has other fields, too


class Shapes(Struct, frozen=True):
    """The names of a recording that a specification can declare, and those that it cannot."""

    declared: Mapping[str, Shape]
    left_out: Mapping[str, str]  # by name, the reason


def reasons_of(left_out: Mapping[str, str], most: int) -> Iterator[str]:
    """Yield each reason why names are left out, after these names; at most `most` are listed.

    >>> list(reasons_of({"a": "lists", "b": "no value", "c": "lists"}, 1))
    ['a and 1 more: lists', 'b: no value']
    """
    by_reason: dict[str, list[str]] = {}
    for name, why in left_out.items():
        by_reason.setdefault(why, []).append(name)
    for why, names in by_reason.items():
        more = f" and {len(names) - most} more" if len(names) > most else ""
        yield f"{', '.join(names[:most])}{more}: {why}"


MOST = 160  # the most stretches of a course


class Stretch(Struct, frozen=True):
    """The updates in a stretch of time."""

    updates: int  # their number; for an event, also reports that it did not occur
    low: float | None  # least number; `None` if there is none
    high: float | None  # greatest number; `None` if there is none


class Course:
    """The course of values over time, in stretches of equal length.

    The length doubles whenever the recording gets too long for `MOST` stretches.
    """

    def __init__(self) -> None:
        self.start = 0  # the first instant, ticks
        self.length = 1 << 16  # of a stretch, ticks
        self.labels: dict[str, int] = {}  # the number that stands for each label in a drawing
        self._updates = np.zeros(MOST, np.int64)
        self._lows = np.full(MOST, inf)
        self._highs = np.full(MOST, -inf)

    def note(self, times: NDArray[np.int64], numbers: NDArray[Any]) -> None:
        """Take updates; for an event, also reports that it did not occur.

        Args:
            times: int64[n] ticks, ascending, not before the start.
            numbers: [n] the values; those that are not finite are counted, but not drawn.
        """
        self._reach(int(times[-1]))
        places = (times - self.start) // self.length
        self._updates += np.bincount(places, minlength=MOST)
        firsts = np.flatnonzero(np.diff(places, prepend=-1))
        drawn, places = np.isfinite(numbers), places[firsts]
        lows = np.minimum.reduceat(np.where(drawn, numbers, inf), firsts)
        highs = np.maximum.reduceat(np.where(drawn, numbers, -inf), firsts)
        self._lows[places] = np.minimum(self._lows[places], lows)
        self._highs[places] = np.maximum(self._highs[places], highs)

    def _reach(self, t: int) -> None:
        """Lengthen the stretches until they cover an instant."""
        while (t - self.start) // self.length >= MOST:
            self._updates = _halved(np.add, self._updates, 0)
            self._lows = _halved(np.minimum, self._lows, inf)
            self._highs = _halved(np.maximum, self._highs, -inf)
            self.length *= 2

    @property
    def extremes(self) -> set[float]:
        """The least and greatest numbers of all stretches."""
        return {*self._lows.tolist(), *self._highs.tolist()} - {-inf, inf}

    def until(self, end: int) -> list[Stretch]:
        """The stretches up to an instant (ticks), which may be long after the last update."""
        self._reach(end)
        count = max(1, -(-(end - self.start + 1) // self.length))
        stretches = zip(
            *(one[:count].tolist() for one in (self._updates, self._lows, self._highs)), strict=True
        )
        return [
            Stretch(updates, low, high) if low <= high else Stretch(updates, None, None)
            for updates, low, high in stretches
        ]


def _halved(join: np.ufunc, values: NDArray[Any], nothing: float) -> NDArray[Any]:
    """Join pairs of stretches, and append as many empty ones."""
    joined = join(values[::2], values[1::2])
    return np.concatenate((joined, np.full_like(joined, nothing)))


Updates = tuple["NDArray[np.int64]", "NDArray[Any]", "NDArray[np.bool_]"]
"""The arguments of `Column.take`."""


class Column(Struct):
    """A name of a recording, with statistics of its values over time."""

    name: str  # as in the recording
    shape: Shape  # becomes an event if `guessed_event`
    guessed_event: bool = False  # whether its truth values were taken for an event
    updates: int = 0  # the number of updates; for an event, also reports that it did not occur
    occurrences: int = 0  # of an event
    low: float | None = None  # least number seen; `None` if it is no number
    high: float | None = None  # greatest number seen; `None` if it is no number
    rate: float = 0.0  # updates per second; 0 if there were too few
    longest_gap: int = 0  # between two updates, ticks
    longest_silence: int = 0  # the longest gap, also from the last update to the end, ticks
    first: int | None = None  # the instant of the first update, ticks; `None` if there was none
    # whether it was unknown, at the first sample or later
    gaps_in_value: bool = False
    # the first occurrences of an event, or instants where a truth value became true; ticks
    instants: list[int] = field(default_factory=list)
    course: Course = field(default_factory=Course)
    _last: int = 0
    _trues: int = 0
    _falses: int = 0
    _before: bool = False
    _runs_are_single: bool = True

    @property
    def is_finite(self) -> bool:
        """Whether all values are finite numbers."""
        return self.low is not None and self.high is not None and isfinite(self.high - self.low)

    @property
    def changes(self) -> bool:
        """Whether all values are finite numbers, and not all are the same."""
        return self.is_finite and self.low != self.high

    @property
    def is_event(self) -> bool:
        """Whether the name is declared as an event."""
        return self.shape.kind is None

    def updates_in(self, times: NDArray[np.int64], cells: Cells) -> Updates:
        """The updates in rows of a signal, as the arguments of `take`."""
        values: NDArray[Any] = cells.values
        known = values == values
        if cells.states is not None:
            given = cells.states != NO_UPDATE
            known = (known & (cells.states == YES))[given]
            times, values = times[given], values[given]
        if cells.labels is not None:
            numbers = self.course.labels
            places = [0] * len(cells.labels)
            for place in dict.fromkeys(values[known].tolist()):
                places[place] = numbers.setdefault(cells.labels[place], len(numbers))
            values = np.array(places)[values]
        return times, values, known

    def take(
        self, times: NDArray[np.int64], values: NDArray[Any], known: NDArray[np.bool_]
    ) -> None:
        """Take updates.

        Args:
            times: int64[n] ticks, ascending.
            values: [n] numbers, truth values or numbers of labels; for an event, 1 where it occurs,
                0 where it does not, NaN where it occurs with a payload.
            known: bool[n], whether each value is known.
        """
        if not len(times):
            return
        if self.first is None:
            self.first = self._last = int(times[0])
        self.longest_gap = max(self.longest_gap, int(np.diff(times, prepend=self._last).max()))
        self._last = int(times[-1])
        self.updates += len(times)
        self.gaps_in_value |= not known.all()
        self.course.note(times, np.where(known, values, np.nan))
        times, values = times[known], values[known]
        match self.shape.kind:
            case None:
                occurred = times[values != 0]
                self.occurrences += len(occurred)
                self._occurred(occurred)
            case Kind.BOOL:
                self._truths(times, values.astype(np.bool_))
            case Kind.INT | Kind.REAL if len(values):
                low, high = values.min().item() + 0, values.max().item() + 0  # -0 is 0
                self.low = low if self.low is None else min(self.low, low)
                self.high = high if self.high is None else max(self.high, high)
            case _:
                pass

    def _truths(self, times: NDArray[np.int64], values: NDArray[np.bool_]) -> None:
        before = np.concatenate(([self._before], values))[:-1]
        never_false = np.cumsum(~values) + self._falses == 0
        self._occurred(times[values & (~before | never_false)])
        self._runs_are_single &= not (values & before).any()
        self._trues += int(values.sum())
        self._falses += int((~values).sum())
        self._before = bool(values[-1]) if len(values) else self._before

    def _occurred(self, times: NDArray[np.int64]) -> None:
        self.instants += times[: MOST_INSTANTS - len(self.instants)].tolist()

    def end(self, start: int, end: int, samples: int) -> None:
        """Finish the statistics, given the recording's start and end (ticks) and sample count."""
        self.gaps_in_value |= self.first != start
        if self.first is None:
            return
        span = self._last - self.first
        self.rate = (self.updates - 1) * TICKS_PER_SECOND / span if span > 0 else 0.0
        self.longest_silence = max(self.longest_gap, end - self._last)
        if self._is_like_event(start, end, samples - self.updates):
            self.shape = replace(self.shape, kind=None)
            self.guessed_event, self.occurrences = True, self._trues

    def _is_like_event(self, start: int, end: int, silent: int) -> bool:
        if self.shape.kind is not Kind.BOOL or not self._trues:
            return False
        if self._falses:
            most = EVENT_SHARE * (self._trues + self._falses)
            return self._runs_are_single and self._trues <= most
        # The value was never false. If it keeps coming, it is a signal that is always true. If it
        # comes with the other fields of its messages, its reports tell nothing.
        if self.shape.is_part:
            return False
        longest = max(self.longest_silence, (self.first or start) - start)
        keeps_coming = self._trues >= FEW and longest <= STEADY * (end - start) / self._trues
        return silent > self._trues and not keeps_coming


class Profile(Struct, frozen=True):
    """The statistics of a recording."""

    path: str  # of the recording
    columns: tuple[Column, ...]  # those that are declared and have a value, in order
    left_out: Mapping[str, str]  # by name, why it has no column
    start: int  # the first instant, ticks
    end: int  # the last instant, ticks
    samples: int  # their number
    lateness: int  # the most by which a sample was late, ticks; 0 if all are in order
    outages: tuple[Outage, ...] = ()  # the outages that the recording states
