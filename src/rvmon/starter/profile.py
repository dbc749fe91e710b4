"""A recording looked over: the kinds of its values from text alone, ranges, rates and gaps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from io import TextIOWrapper
from typing import Any

import msgspec

from rvmon.errors import TraceError
from rvmon.readers.csv_dialect import name_and_unit, opened_as_csv
from rvmon.readers.csv_rows import split_lines
from rvmon.readers.found import files_of
from rvmon.readers.joined import topics_of
from rvmon.readers.messages.forms import MESSAGE_FORMS
from rvmon.readers.naming import DEFAULT_COLUMNS, stamps_among
from rvmon.readers.places import bounded_lines, local_path, named_errors, opened
from rvmon.readers.recording import JOINED, FileRecording, format_of, messages_of
from rvmon.starter.column import Column, Profile, Shape, Shapes
from rvmon.starter.declared import Seen, message_shapes, shapes_seen
from rvmon.trace.schema import Kind, Schema, Stamps
from rvmon.trace.stamps import stamps_of
from rvmon.units import UnknownUnitError, parse_unit

RARE = 0.2
"""A JSON object under a key of fewer lines than this share is taken for the payload of an event."""


def shapes_of(path: str, stamps: Stamps | None = None) -> Shapes:
    """Look at the names and values of a recording.

    Args:
        path: of it.
        stamps: where it says when; default `t` or `t_ns`.

    Raises:
        TraceError: the file cannot be read, or has no time column.
    """
    form = format_of(path)
    if form == JOINED:
        return _of_files(files_of(path), stamps)
    if form in MESSAGE_FORMS:
        return message_shapes(messages_of(path))
    with named_errors(path):
        if form == "parquet":
            return _of_parquet(path, stamps)
        source = opened_as_csv(path, stamps) if form == "csv" else opened(path)
        with source as (plain, _), TextIOWrapper(plain, "utf-8-sig", newline="") as text:
            look = _of_csv if form == "csv" else _of_json
            return look(bounded_lines(text), stamps)


def _of_files(paths: Sequence[str], stamps: Stamps | None) -> Shapes:
    """The names of several files; what two of them have is called `FILE.NAME`."""
    found = [shapes_of(path, stamps) for path in paths]
    counts = Counter(name for one in found for name in (*one.declared, *one.left_out))
    declared: dict[str, Shape] = {}
    left_out: dict[str, str] = {}
    for shapes, (_, topic) in zip(found, topics_of(paths), strict=True):
        full = {name: name if counts[name] == 1 else f"{topic}.{name}" for name in counts}
        declared |= {full[name]: shape for name, shape in shapes.declared.items()}
        left_out |= {full[name]: why for name, why in shapes.left_out.items()}
    return Shapes(declared, left_out)


def _of_csv(text: Iterable[str], stamps: Stamps | None) -> Shapes:
    rows = split_lines(text)
    try:
        _, header = next(rows)
    except StopIteration:
        raise TraceError("is empty: expected a header with a time column `t`") from None
    named = [name_and_unit(column) for column in header]
    names = [
        column if name in header else name for (name, _), column in zip(named, header, strict=True)
    ]
    if stamps is None:
        stamps_among(names, Schema({}, {}))
    columns = [Seen() for _ in header]
    for _, row in rows:
        for seen, cell in zip(columns, row, strict=False):
            if cell:
                seen.add_text(cell)
    found = shapes_seen(_without_time(dict(zip(names, columns, strict=True)), stamps))
    units = dict(named)
    declared = {
        name: replace(shape, unit=units[name] if _is_measured(shape, units.get(name, "")) else "")
        for name, shape in found.declared.items()
    }
    return replace(found, declared=declared)


def _is_measured(shape: Shape, unit: str) -> bool:
    """Whether a number has a unit that is one."""
    try:
        return bool(unit) and shape.kind is Kind.REAL and parse_unit(unit) is not None
    except UnknownUnitError:
        return False


def _of_parquet(path: str, stamps: Stamps | None) -> Shapes:
    from rvmon.readers.parquet import parquet_cells

    seen: dict[str, Seen] = {}
    for columns in parquet_cells(local_path(path)):
        if stamps is None:
            stamps_among(columns, Schema({}, {}))
        for name, cells in columns.items():
            entry = seen.setdefault(name, Seen())
            for cell in cells:
                if cell is not None:
                    entry.add(cell)
    return shapes_seen(_without_time(seen, stamps))


def _without_time(seen: Mapping[str, Seen], stamps: Stamps | None) -> dict[str, Seen]:
    times = DEFAULT_COLUMNS if stamps is None else (stamps.column,)
    return {name: entry for name, entry in seen.items() if name not in times}


def _of_json(lines: Iterable[str], stamps: Stamps | None) -> Shapes:
    decode = msgspec.json.Decoder().decode
    seen: dict[str, Seen] = {}
    events: dict[str, Seen] = {}
    count = 0
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            fields = decode(line)
            if isinstance(fields, dict) and not count and stamps is None:
                stamps_among(fields, Schema({}, {}))
        except TraceError as error:
            raise TraceError(f"line {number}: {error}") from None
        except (msgspec.DecodeError, RecursionError) as error:
            raise TraceError(f"line {number}: not a JSON object ({error})") from None
        if not isinstance(fields, dict):
            raise TraceError(f'line {number}: expected an object such as {{"t": 0.5, "x": 1}}')
        count += 1
        listed = fields.get("events")
        if isinstance(listed, list) and all(isinstance(name, str) for name in listed):
            del fields["events"]
            for name in listed:
                events.setdefault(name, Seen()).add_payload({})
        _collect(fields, "", seen)
    return shapes_seen({**_without_time(_without_rare_objects(seen, count), stamps), **events})


def _collect(fields: Mapping[str, Any], prefix: str, seen: dict[str, Seen]) -> None:
    for key, value in fields.items():
        name = prefix + key
        if value is None:
            continue
        entry = seen.setdefault(name, Seen())
        if isinstance(value, dict):
            entry.add_payload(value)
            _collect(value, name + ".", seen)
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for payload in value:
                entry.add_payload(payload)
        else:
            entry.add(value)


def _without_rare_objects(seen: Mapping[str, Seen], lines: int) -> dict[str, Seen]:
    """The names to declare: of an object either its parts, or, if it is rare, itself alone."""
    kept: dict[str, Seen] = {}
    for name, entry in seen.items():
        inside = any(name.startswith(event + ".") for event in kept if kept[event].payloads)
        if inside:
            continue
        parts = any(other.startswith(name + ".") for other in seen)
        if entry.payloads and parts and entry.payloads >= RARE * lines:
            continue
        kept[name] = entry
    return kept


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
