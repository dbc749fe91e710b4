"""Sources of traces: whatever may be given as one, the way to read it, its pieces for the core."""

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
    """A finished trace, and how it is to be taken."""

    # gives samples; one that has columns has `pieces` as well: see
    # `rvmon.recordings.recording.FileRecording`
    recording: Recording
    until: int | None = None  # the end of the trace in ticks, if it is not its last sample
    is_cut: bool = False  # whether what comes after that end is left out
    # passes samples and batches on as they are read, with a progress bar
    shown: Callable[[Iterator[Any]], Iterator[Any]] = iter
    # called with each sample or batch once it was judged, and the run, which goes on
    taken: Callable[[Any, native.Monitor], object] | None = None

    @property
    def names(self) -> frozenset[str] | None:
        """The signals and events that have a source; `None`: all."""
        return self.recording.names

    @property
    def end(self) -> int | None:
        """The end of the trace in ticks; `None`: its last sample."""
        return self.recording.end if self.until is None else self.until

    @property
    def outages(self) -> Sequence[Outage]:
        """The stretches that were lost."""
        return getattr(self.recording, "outages", ())

    def samples(self) -> Iterator[Sample]:
        """The samples; what lies behind the end is not read, and may be broken."""
        until, samples = self.until, self.shown(iter(self.recording))
        if until is None or not self.is_cut:
            return samples
        return takewhile(lambda sample: sample.t <= until, samples)

    def pieces(self) -> Iterator[Batch | Sample]:
        """The recording in order: rows as columns where it has such, else samples."""
        read = getattr(self.recording, "pieces", None)
        if read is None:
            yield from self.samples()
            return
        pieces, is_cut = self.shown(read()), self.is_cut and self.until is not None
        yield from pieces_up_to(pieces, self.until or 0) if is_cut else pieces


def pieces_up_to(pieces: Iterable[Batch | Sample], end: int) -> Iterator[Batch | Sample]:
    """Pieces of a recording up to an instant (ticks); those behind it are not read."""
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
    """The arguments of `Spec.reading`; it says what they mean."""

    time: str | None
    columns: Mapping[str, str] | None
    nan: str | None
    no_update: Any
    binding: str | Path | None
    clock: str | None


class ReadingArguments(SchemaArguments, total=False):
    """The arguments that `Spec.evaluate` and its kin have in common; it says what they mean."""

    sources: Iterable[str] | None
    allow_missing: bool | Iterable[str]


class Reading(Struct, frozen=True):
    """The options of `Spec.evaluate` and its kin about a trace."""

    schema: Schema  # the declared names, and how the trace gives them
    # the signals and events that can arrive; `None`: those that the trace has
    sources: frozenset[str] | None = None
    # the names that a trace in columns may lack though requirements read them; whether all
    allowed: bool | tuple[str, ...] = False


def recording_of(
    trace: Any, schema: Schema, *, ordered: bool, sources: frozenset[str] | None = None
) -> Recording:
    """A trace as a recording; it need not be read yet.

    Args:
        trace: a path, a table (columns by name, an Arrow table, a data frame), a list of paths or
            of tables that are one recording, a recording, or an iterable of `(t, values)` with t in
            seconds.
        schema: the declared names, and how the trace gives them; a recording says so itself.
        ordered: whether a stamp that is before the one above it is an error.
        sources: the names that can arrive; default those that the trace has.

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
    """Pairs `(t, values)`, t in seconds, as a recording.

    Names that are absent are no update, `None` and NaN are unknown.
    """

    names: frozenset[str] | None = None  # `None`: any may come
    end: int | None = None  # `None`: it ends with its last item

    def __init__(self, trace: Any, schema: Schema, *, ordered: bool = True) -> None:
        """Take what can be gone through; values of names that are not declared stay as they are."""
        if not isinstance(trace, Iterable):
            raise TraceError(
                "expected a path, columns by name (arrays, a table, a data frame) or (t, values) "
                f"pairs, found {type(trace).__name__}"
            )
        self.rows = Rows(schema, "item", ordered=ordered)  # turns its rows into samples
        self._trace = trace
        self._schema = schema

    def __iter__(self) -> Iterator[Sample]:
        """Samples, equal stamps merged."""
        return self.rows.samples(self._read())

    def _read(self) -> Iterator[Row]:
        """Number from 0, ticks and values of each item."""
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
