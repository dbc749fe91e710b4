"""A recording looked over: ranges, rates, gaps, and which truth values look like events."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from rvmon.errors import TraceError
from rvmon.readers.recording import FileRecording
from rvmon.starter.column import Column, Profile, Shape, Shapes
from rvmon.starter.course import Course
from rvmon.starter.shapes import shapes_of
from rvmon.trace.sample import Value
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.stamps import stamps_of
from rvmon.trace.time import TICKS_PER_SECOND

MOST_NAMED = 3
"""Names that a message lists; the rest is counted."""

FEW = 5
"""Of fewer occurrences nobody knows whether they are regular."""

STEADY = 3
"""What keeps coming has no gap of more than so many times the mean one."""

MOST_INSTANTS = 10_000
"""Occurrences that are kept of one name."""

EVENT_SHARE = 0.1
"""Truth values that are true in single samples only, and in at most this share, are events."""


def profile_of(path: str, time: str | None = None) -> Profile:
    """Look a recording over, as `rvmon run` will read it.

    Args:
        path: of the recording.
        time: the column of stamps and its unit, as `Spec.reading` takes it.

    Raises:
        TraceError: the file cannot be read; place and cause are named.
    """
    stamps = None if time is None else stamps_of(time)
    shapes = shapes_of(path, stamps)
    if not shapes.declared:
        raise TraceError(f"{path}: no signal or event is found ({_reasons(shapes.left_out)})")
    schema = Schema(
        {name: shape.kind for name, shape in shapes.declared.items() if shape.kind is not None},
        {name: shape.fields for name, shape in shapes.declared.items() if shape.kind is None},
        stamps=stamps,
    )
    return followed(FileRecording(path, schema, ordered=False), shapes)


def bound_profile(path: str, schema: Schema) -> Profile:
    """Look over what a recording says of the names that are declared; errors as of `profile_of`."""
    recording = FileRecording(path, schema, ordered=False)
    kinds: dict[str, Kind | None] = {**schema.signals, **dict.fromkeys(schema.events)}
    there = {
        name: Shape(kind, (), schema.events.get(name, {}), schema.units.get(name, ""))
        for name, kind in kinds.items()
        if recording.names is None or name in recording.names
    }
    absent = dict.fromkeys((name for name in kinds if name not in there), "nothing feeds it")
    return followed(recording, Shapes(there, absent))


def followed(recording: FileRecording, shapes: Shapes) -> Profile:
    """Follow names from sample to sample.

    Args:
        recording: has these names; it is read once.
        shapes: what they are.

    Raises:
        TraceError: it cannot be read, or none of them has a value.
    """
    path = recording.path
    followed = {name: _Followed(shape) for name, shape in shapes.declared.items()}
    start = end = samples = 0
    for sample in recording:
        if not samples:
            start = sample.t
            for one in followed.values():
                one.course.start = start
        end = sample.t
        samples += 1
        for name, one in followed.items():
            one.take(sample.t, sample.values.get(name, _NOTHING), first=samples == 1)
    columns = [one.column(name, start, end) for name, one in followed.items()]
    silent = {one.name: "no value in the recording" for one in columns if not one.updates}
    kept = tuple(one for one in columns if one.updates)
    left_out = {**shapes.left_out, **silent}
    if not kept:
        raise TraceError(f"{path}: no signal or event is found ({_reasons(left_out)})")
    late, outages = recording.rows.lateness, tuple(recording.outages)
    return Profile(path, kept, left_out, start, end, samples, late, outages)


def _reasons(left_out: Mapping[str, str]) -> str:
    """Why nothing can be declared, each reason with the first of its names."""
    if not left_out:
        return "there is only time"
    by_reason: dict[str, list[str]] = {}
    for name, why in left_out.items():
        by_reason.setdefault(why, []).append(f"`{name}`")
    listed = []
    for why, names in by_reason.items():
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        listed.append(f"{', '.join(names[:MOST_NAMED])}{more}: {why}")
    return "; ".join(listed)


_NOTHING: Mapping[str, bool] = {}
"""Stands for a name that a sample does not speak of."""


class _Followed:
    """One name from sample to sample."""

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.updates = 0
        self.first: int | None = None
        self.last: int | None = None
        self.longest = 0
        self.low = math.inf
        self.high = -math.inf
        self.unknown = False
        self.instants: list[int] = []
        self.trues = 0
        self.falses = 0
        self.before = False
        self.runs_are_single = True
        self.silent = 0
        self.course = Course(0)

    def take(self, t: int, value: Value, *, first: bool) -> None:
        if value is _NOTHING:
            self.unknown |= first
            self.silent += 1
            return
        if self.last is not None:
            self.longest = max(self.longest, t - self.last)
        self.first = t if self.first is None else self.first
        self.last = t
        self.updates += 1
        self.course.note(t, value)
        match value:
            case bool():
                self._truth(t, value)
            case int() | float() if value == value:
                self.low, self.high = min(self.low, value), max(self.high, value)
            case None | float():
                self.unknown = True
            case str():
                pass
            case _:
                self._occurred(t)

    def _truth(self, t: int, value: bool) -> None:
        if value:
            self.trues += 1
            self.runs_are_single &= not self.before
            if not self.before or self.shape.kind is None or not self.falses:
                self._occurred(t)
        else:
            self.falses += 1
        self.before = value

    def _occurred(self, t: int) -> None:
        if len(self.instants) < MOST_INSTANTS:
            self.instants.append(t)

    def _looks_like_event(self, start: int, end: int) -> bool:
        if self.shape.kind is not Kind.BOOL or not self.trues:
            return False
        if not self.falses:  # only ever reported when true
            return self.silent > self.trues and not self._keeps_coming(start, end)
        return self.runs_are_single and self.trues <= EVENT_SHARE * (self.trues + self.falses)

    def _keeps_coming(self, start: int, end: int) -> bool:
        """Whether it is reported all the time: what is always true is no event."""
        if self.trues < FEW or self.first is None:
            return False
        return max(self.longest, self.first - start, end - (self.last or end)) <= (
            STEADY * (end - start) / self.trues
        )

    def column(self, name: str, start: int, end: int) -> Column:
        """What is to be reported of it, of a recording between these instants."""
        span = 0 if self.first is None or self.last is None else self.last - self.first
        event = self._looks_like_event(start, end)
        return Column(
            name,
            replace(self.shape, kind=None) if event else self.shape,
            event,
            self.trues if event else self.updates,
            self.low if self.low <= self.high else None,
            self.high if self.low <= self.high else None,
            (self.updates - 1) * TICKS_PER_SECOND / span if span > 0 else 0.0,
            self.longest,
            0 if self.last is None else max(self.longest, end - self.last),
            self.first,
            self.unknown,
            tuple(self.instants),
            self.course,
        )
