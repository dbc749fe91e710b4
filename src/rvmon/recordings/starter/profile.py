"""A recording looked over: the kinds of its values from text alone, ranges, rates and gaps."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import TextIOWrapper
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from msgspec.structs import replace

from rvmon.errors import TimeOrderError, TraceError
from rvmon.recordings import MESSAGE_FORMS
from rvmon.recordings.batch import NO_UPDATE, UNKNOWN, YES, Batch, Cells, NotPlainError
from rvmon.recordings.cells import cells_of_values
from rvmon.recordings.csv_batch import Parsed, csv_batches
from rvmon.recordings.csv_dialect import bare_names, name_and_unit, opened_as_csv
from rvmon.recordings.csv_rows import read_layout
from rvmon.recordings.csv_text import CsvText
from rvmon.recordings.joined import topics_of
from rvmon.recordings.places import bounded_lines, files_of, local_path, named_errors, opened
from rvmon.recordings.recording import JOINED, FileRecording, format_of, messages_of
from rvmon.recordings.starter.declarations import SeenValues, message_shapes, shapes_seen
from rvmon.recordings.starter.observed_values import (
    Column,
    Profile,
    Shape,
    Shapes,
    Updates,
    reasons_of,
)
from rvmon.recordings.values import as_declared
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Gaps, Kind, Schema, Stamps
from rvmon.trace.stamps import DEFAULT_COLUMNS, stamps_among, stamps_of
from rvmon.units import UnknownUnitError, parse_unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

RARE = 0.2
"""A JSON object under a key of fewer lines than this share is taken for the payload of an event."""

AT_ONCE = 8192  # samples of which the columns are looked at together

Recorded = tuple["NDArray[np.int64]", Mapping[str, Updates]]
"""The instants of some samples, and of each name its updates there."""


def shapes_of(path: str, stamps: Stamps | None = None) -> Shapes:
    """Look at the names and values of a recording."""
    form = format_of(path)
    if form == JOINED:
        return _of_files(files_of(path), stamps)
    if form in MESSAGE_FORMS:
        return message_shapes(messages_of(path))
    with named_errors(path):
        if form == "parquet":
            return _of_parquet(path, stamps)
        if form == "csv":
            return _of_csv(path, stamps)
        with opened(path) as (plain, _), TextIOWrapper(plain, "utf-8-sig", newline="") as text:
            return _of_json(bounded_lines(text), stamps)


def _of_files(paths: Sequence[str], stamps: Stamps | None) -> Shapes:
    """The names of several files; what two of them have is called `FILE.NAME`."""
    found = [shapes_of(path, stamps) for path in paths]
    counts = Counter(name for shapes in found for name in (*shapes.declared, *shapes.left_out))
    declared: dict[str, Shape] = {}
    left_out: dict[str, str] = {}
    for shapes, (_, topic) in zip(found, topics_of(paths), strict=True):
        full = {name: name if counts[name] == 1 else f"{topic}.{name}" for name in counts}
        declared |= {full[name]: shape for name, shape in shapes.declared.items()}
        left_out |= {full[name]: why for name, why in shapes.left_out.items()}
    return Shapes(declared, left_out)


def _of_csv(path: str, stamps: Stamps | None) -> Shapes:
    with opened_as_csv(path, stamps) as (plain, _):
        text: CsvText[Parsed] = CsvText(plain)
        header = text.header()
        others = [name for name in header if stamps is None or name != stamps.column]
        possible = [*others, *(name_and_unit(name)[0] for name in others)]
        schema = Schema(dict.fromkeys(possible, Kind.LABEL), {}, stamps=stamps)
        names, schema = bare_names(header, schema)
        layout = replace(read_layout(names, schema), is_look=True)
        seen = {column.name: SeenValues() for column in layout.columns}
        for piece in csv_batches(text, layout, frozenset()):
            if isinstance(piece, Batch):
                for name, cells in piece.signals.items():
                    seen[name].add_texts(cells.labels or ())
                continue
            for _, _, values, *_ in piece:
                for name, value in values.items():
                    seen[name].add_texts([str(value)])
    found = shapes_seen(seen)
    named = zip(names, map(name_and_unit, header), strict=True)
    units = {name: unit for name, (bare, unit) in named if name == bare}
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
    from rvmon.recordings.parquet import parquet_cells

    seen: dict[str, SeenValues] = {}
    for columns in parquet_cells(local_path(path)):
        if stamps is None:
            stamps_among(columns, Schema({}, {}))
        for name, cells in columns.items():
            entry = seen.setdefault(name, SeenValues())
            for cell in cells:
                if cell is not None:
                    entry.add(cell)
    return shapes_seen(_without_time(seen, stamps))


def _without_time(seen: Mapping[str, SeenValues], stamps: Stamps | None) -> dict[str, SeenValues]:
    times = DEFAULT_COLUMNS if stamps is None else (stamps.column,)
    return {name: entry for name, entry in seen.items() if name not in times}


def _of_json(lines: Iterable[str], stamps: Stamps | None) -> Shapes:
    decode = msgspec.json.Decoder().decode
    seen: dict[str, SeenValues] = {}
    events: dict[str, SeenValues] = {}
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
                events.setdefault(name, SeenValues()).add_payload({})
        _collect(fields, "", seen)
    return shapes_seen({**_without_time(_without_rare_objects(seen, count), stamps), **events})


def _collect(fields: Mapping[str, Any], prefix: str, seen: dict[str, SeenValues]) -> None:
    for key, value in fields.items():
        name = prefix + key
        if value is None:
            if not prefix:  # it is listed as left out, if it never says more
                seen.setdefault(name, SeenValues())
            continue
        entry = seen.setdefault(name, SeenValues())
        if isinstance(value, dict):
            entry.add_payload(value)
            _collect(value, name + ".", seen)
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for payload in value:
                entry.add_payload(payload)
        else:
            entry.add(value)


def _without_rare_objects(seen: Mapping[str, SeenValues], lines: int) -> dict[str, SeenValues]:
    """The names to declare: of an object either its parts, or, if it is rare, itself alone."""
    kept: dict[str, SeenValues] = {}
    for name, entry in seen.items():
        inside = any(name.startswith(event + ".") for event in kept if kept[event].payloads)
        if inside:
            continue
        parts = any(other.startswith(name + ".") for other in seen)
        if entry.payloads and parts and entry.payloads >= RARE * lines:
            continue
        kept[name] = entry
    return kept


MOST_NAMED = 3  # names that a message lists; the rest is counted


def profile_of(path: str, time: str | None = None) -> Profile:
    """Look a recording over, as `rvmon run` will read it; `time` as `Spec.reading` takes it.

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
    return followed(path, schema, shapes)


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
    return followed(path, schema, Shapes(there, absent))


def followed(path: str, schema: Schema, shapes: Shapes) -> Profile:
    """Follow names over time; a recording that is not in order is put in order."""
    with named_errors(path):
        try:
            return _followed(FileRecording(path, schema), shapes)
        except TimeOrderError:
            return _followed(FileRecording(path, schema, ordered=False), shapes)


def _followed(recording: FileRecording, shapes: Shapes) -> Profile:
    columns = {name: Column(name, shape) for name, shape in shapes.declared.items()}
    start = end = None
    samples = 0
    for times, updates in _updates(recording.pieces(), columns):
        if start is None:
            start = int(times[0])
            for column in columns.values():
                column.course.start = start
        end = int(times[-1])
        samples += len(times)
        for name, (own_times, values, known) in updates.items():
            columns[name].take(own_times, values, known)
    if start is None or end is None:
        raise TraceError("holds no sample")
    end = max(end, recording.end or end)
    for column in columns.values():
        column.end(start, end, samples)
    silent = {
        name: "no value in the recording" for name, column in columns.items() if not column.updates
    }
    kept = tuple(column for column in columns.values() if column.updates)
    left_out = {**shapes.left_out, **silent}
    if not kept:
        raise TraceError(f"no signal or event is found ({_reasons(left_out)})")
    late, outages = recording.rows.lateness, tuple(recording.outages)
    return Profile(recording.path, kept, left_out, start, end, samples, late, outages)


def _updates(pieces: Iterable[Batch | Sample], columns: Mapping[str, Column]) -> Iterator[Recorded]:
    waiting: list[Sample] = []
    for piece in pieces:
        is_plain = isinstance(piece, Batch) and (np.diff(piece.times) > 0).all()
        if waiting and (is_plain or len(waiting) >= AT_ONCE):
            yield _of_samples(waiting, columns)
            waiting = []
        if isinstance(piece, Sample):
            waiting.append(piece)
        elif is_plain:
            yield _of_batch(piece, columns)
        else:
            waiting += piece.samples()
    if waiting:
        yield _of_samples(waiting, columns)


def _of_batch(batch: Batch, columns: Mapping[str, Column]) -> Recorded:
    times = batch.times
    found = {
        name: columns[name].updates_in(times, signal) for name, signal in batch.signals.items()
    }
    for name, event in batch.events.items():
        given = event.states != NO_UPDATE
        values = np.where(event.with_payload, np.nan, event.states == YES)
        found[name] = times[given], values[given], (event.states != UNKNOWN)[given]
    return times, found


def _of_samples(samples: Sequence[Sample], columns: Mapping[str, Column]) -> Recorded:
    updates: dict[str, tuple[list[int], list[Value]]] = {}
    for sample in samples:
        for name, value in sample.values.items():
            instants, values = updates.setdefault(name, ([], []))
            instants.append(sample.t)
            values.append(value)
    found: dict[str, Updates] = {}
    for name, (instants, values) in updates.items():
        times = np.array(instants, np.int64)
        kind = columns[name].shape.kind
        if kind is None:
            numbers = [float(value) if isinstance(value, bool) else math.nan for value in values]
            known = np.array([value is not None for value in values])
            found[name] = times, np.array(numbers), known
        else:
            found[name] = columns[name].updates_in(times, _cells(values, kind))
    return np.array([sample.t for sample in samples], np.int64), found


def _cells(values: Sequence[Value], kind: Kind) -> Cells:
    """Values of a signal, none of which stands for no update; unsigned ones may take 64 bits."""
    try:
        return cells_of_values(values, kind, Gaps(), ...)
    except NotPlainError:
        reals = [value if value is None else as_declared(value, Kind.REAL) for value in values]
        return cells_of_values(reals, Kind.REAL, Gaps(), ...)


def _reasons(left_out: Mapping[str, str]) -> str:
    """Why nothing can be declared, each reason with the first of its names."""
    quoted = {f"`{name}`": why for name, why in left_out.items()}
    return "; ".join(reasons_of(quoted, MOST_NAMED)) or "there is only time"
