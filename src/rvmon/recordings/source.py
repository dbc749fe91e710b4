"""Sources of traces: makes a recording of what callers pass as a trace, and yields its pieces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from msgspec import Struct

from rvmon.errors import TraceError
from rvmon.recordings.joined import Joined
from rvmon.recordings.places import JOINT
from rvmon.recordings.rows import Row, Rows
from rvmon.recordings.values import as_declared, plain
from rvmon.trace.sample import Outage, Recording, Sample, Trace
from rvmon.trace.schema import Gaps, Kind, Schema
from rvmon.trace.time import ticks_of_seconds

if TYPE_CHECKING:
    from rvmon import native
    from rvmon.recordings.batch import Batch
    from rvmon.recordings.recording import FileRecording
    from rvmon.recordings.table_recording import TableRecording


class Source(Struct, frozen=True):
    """A finished trace with the options for reading it."""

    # gives samples; if it has columns it has a method `pieces`, too: see
    # `rvmon.recordings.recording.FileRecording`
    recording: Recording
    until: int | None = None  # the end of the trace in ticks, if not the end of the recording
    is_cut: bool = False  # whether the samples after `until` are left out
    # wraps the iterator of samples and batches, for example to draw a progress bar
    shown: Callable[[Iterator[Any]], Iterator[Any]] = iter
    # called after each sample or batch was judged, with it and the monitor, which continues
    taken: Callable[[Any, native.Monitor], object] | None = None

    @property
    def names(self) -> frozenset[str] | None:
        """The signals and events that have a source; `None`: all."""
        return self.recording.names

    @property
    def end(self) -> int | None:
        """The end of the trace in ticks; `None`: it ends with its last sample."""
        return self.recording.end if self.until is None else self.until

    @property
    def outages(self) -> Sequence[Outage]:
        """The outages of the recording."""
        return getattr(self.recording, "outages", ())

    def samples(self) -> Iterator[Sample]:
        """The samples; if the trace is cut, reading stops at its end, so the rest may be broken."""
        until, samples = self.until, self.shown(iter(self.recording))
        if until is None or not self.is_cut:
            return samples
        return takewhile(lambda sample: sample.t <= until, samples)

    def pieces(self) -> Iterator[Batch | Sample]:
        """Yield the recording in order, as batches of columns where possible, else as samples."""
        read = getattr(self.recording, "pieces", None)
        if read is None:
            yield from self.samples()
            return
        pieces, is_cut = self.shown(read()), self.is_cut and self.until is not None
        yield from pieces_up_to(pieces, self.until or 0) if is_cut else pieces


def pieces_up_to(pieces: Iterable[Batch | Sample], end: int) -> Iterator[Batch | Sample]:
    """Yield pieces of a recording up to an instant (ticks), and stop reading after it."""
    for piece in pieces:
        if isinstance(piece, Sample):
            if piece.t > end:
                return
            yield piece
        else:
            kept = piece.up_to(end)
            if len(kept.times):
                yield kept
            if len(kept.times) < len(piece.times):
                return


class SchemaArguments(TypedDict, total=False):
    """The arguments of `Spec.reading`, which documents them."""

    time: str | None
    columns: Mapping[str, str] | None
    nan: str | None
    no_update: Any
    binding: str | Path | None
    clock: str | None


class ReadingArguments(SchemaArguments, total=False):
    """The arguments common to `Spec.evaluate`, which documents them, and similar methods."""

    sources: Iterable[str] | None
    allow_missing: bool | Iterable[str]


class Reading(Struct, frozen=True):
    """The options for reading a trace, of `Spec.evaluate` and similar methods."""

    schema: Schema  # the declared names, and how the trace provides them
    # the signals and events that can arrive; `None`: those that the trace has
    sources: frozenset[str] | None = None
    # the names that a trace in columns may lack although requirements read them; `True`: all
    allowed: bool | tuple[str, ...] = False


def recording_of(
    trace: Any, schema: Schema, *, ordered: bool, sources: frozenset[str] | None = None
) -> Recording:
    """Make a recording of whatever a caller passes as a trace; samples are mostly read later.

    Args:
        trace: a path, a table (columns by name, an Arrow table, a data frame), a list of paths or
            of tables that form one recording, a recording, or an iterable of `(t, values)` with t
            in seconds.
        schema: the declared names, and how the trace provides them; not used for a recording.
        ordered: whether a stamp before that of the previous row is an error.
        sources: the names that can arrive; default: those that the trace has.

    Raises:
        TraceError: the trace cannot be read.
    """
    recording = _of_columns_or_lines(trace, schema, ordered=ordered)
    if recording is None and hasattr(trace, "names") and hasattr(trace, "end"):
        given: Recording = trace
        return given if sources is None else Trace(tuple(given), sources, given.end)
    if recording is None:
        recording = PairRecording(trace, schema, ordered=ordered)
    if sources is not None:
        recording.names = sources
    return recording


def _of_columns_or_lines(
    trace: Any, schema: Schema, *, ordered: bool
) -> FileRecording | TableRecording | Joined | PairRecording | None:
    """A file or a table, or several, as a recording; `None` if it is neither."""
    from rvmon.recordings.tables import columns_by_name

    listed = trace if isinstance(trace, list | tuple) and trace else [None]
    if all(isinstance(part, str | Path) for part in listed):
        trace = JOINT.join(map(str, listed))
    if isinstance(trace, str | Path):
        from rvmon.recordings.places import one_recording
        from rvmon.recordings.recording import FileRecording

        return FileRecording(one_recording(str(trace)), schema, ordered=ordered)
    first = listed[0]
    if isinstance(first, Mapping) and any(isinstance(cell, float | int) for cell in first.values()):
        raise TraceError(
            "expected columns or (t, values) pairs, found a list of rows by name: give pairs, "
            'such as `[(row.pop("t"), row) for row in rows]`, or a data frame of them'
        )
    from rvmon.recordings.table_recording import TableRecording

    if columns_by_name(listed[0]) is not None:
        tables = [
            TableRecording(columns_by_name(part) or {}, schema, ordered=ordered) for part in listed
        ]
        for number, table in enumerate(tables, 1):
            table.path = f"table {number}"
        return Joined(tables, Rows(schema, "joined row", ordered=ordered))
    columns = columns_by_name(trace)
    return None if columns is None else TableRecording(columns, schema, ordered=ordered)


class PairRecording:
    """A recording of pairs `(t, values)`, t in seconds.

    A name that is absent from `values` is not updated; one with `None` or NaN becomes unknown.
    """

    names: frozenset[str] | None = None  # `None`: any may occur
    end: int | None = None  # `None`: it ends with its last item

    def __init__(self, trace: Any, schema: Schema, *, ordered: bool = True) -> None:
        """Take an iterable of pairs; values of undeclared names stay as they are.

        Raises:
            TraceError: `trace` is not iterable.
        """
        if not isinstance(trace, Iterable):
            raise TraceError(
                "expected a path, columns by name (arrays, a table, a data frame) or (t, values) "
                f"pairs, found {type(trace).__name__}"
            )
        self.rows = Rows(schema, "item", ordered=ordered)  # turns its rows into samples
        self._trace = trace
        self._schema = schema

    def __iter__(self) -> Iterator[Sample]:
        """Yield samples in order of time, with equal stamps merged."""
        return self.rows.samples(self._read())

    def _read(self) -> Iterator[Row]:
        """Yield the number (from 0), ticks and values of each item."""
        for number, item in enumerate(self._trace):
            match item:
                case [t, Mapping() as values]:
                    yield number, ticks_of_seconds(t), _values(values, self._schema)
                case _:
                    raise TraceError(
                        f"item {number} of the trace: expected (t, values) with values by name, "
                        f"found {item!r}"
                    )


def _values(values: Mapping[str, Any], schema: Schema) -> dict[str, Any]:
    declared, gaps = {}, schema.gaps
    for name, given in values.items():
        value = plain(given)
        if gaps and gaps.holds(value):
            continue
        if name in schema.events:
            declared[name] = _occurrence(value, schema.events[name], gaps)
        elif name in schema.signals:
            declared[name] = as_declared(value, schema.signals[name])
        else:
            declared[name] = value
    return declared


def _occurrence(value: Any, fields: Mapping[str, Kind], gaps: Gaps) -> Any:
    if isinstance(value, Mapping):
        plains = {field: plain(scalar) for field, scalar in value.items()}
        return {
            field: as_declared(scalar, fields[field]) if field in fields else scalar
            for field, scalar in plains.items()
            if not gaps.holds(scalar)
        }
    if isinstance(value, tuple | list):
        return tuple(_occurrence(payload, fields, gaps) for payload in value)
    return as_declared(value, Kind.BOOL)
