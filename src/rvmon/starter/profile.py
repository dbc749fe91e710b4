"""A recording looked over: ranges, rates, gaps, and which truth values look like events."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.errors import TraceError
from rvmon.readers.recording import FileRecording
from rvmon.starter.column import Column, Profile, Shape, Shapes
from rvmon.starter.shapes import shapes_of
from rvmon.trace.schema import Kind, Schema
from rvmon.trace.stamps import stamps_of

MOST_NAMED = 3
"""Names that a message lists; the rest is counted."""


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
    columns = [Column(name, shape) for name, shape in shapes.declared.items()]
    start = end = samples = 0
    for sample in recording:
        if not samples:
            start = sample.t
            for one in columns:
                one.course.start = start
        end = sample.t
        samples += 1
        for one in columns:
            if one.name in sample.values:
                one.take(sample.t, sample.values[one.name])
            else:
                one.pass_over(first=samples == 1)
    end = max(end, recording.end or end)
    for one in columns:
        one.end(start, end)
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
