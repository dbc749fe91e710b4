"""Whatever a program or a person takes for a trace, as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.trace.sample import Recording, Trace
from rvmon.trace.schema import Schema

if TYPE_CHECKING:
    from rvmon.readers.columns import TableRecording
    from rvmon.readers.pairs import PairRecording
    from rvmon.readers.recording import FileRecording


def recording_of(
    trace: Any, schema: Schema, *, ordered: bool, sources: frozenset[str] | None = None
) -> Recording:
    """A trace as a recording; it need not be read yet.

    Args:
        trace: a path, a table (columns by name, an Arrow table, a data frame), a recording, or an
            iterable of `(t, values)` with t in seconds.
        schema: the declared names, and how the trace gives them; a recording says so itself.
        ordered: whether a stamp that is before the one above it is an error.
        sources: the names that can arrive; default those that the trace has.

    Raises:
        TraceError: the trace cannot be read.
    """
    recording: FileRecording | TableRecording | PairRecording | None = _of_columns_or_lines(
        trace, schema, ordered=ordered
    )
    if recording is None and hasattr(trace, "names") and hasattr(trace, "end"):
        given: Recording = trace
        return given if sources is None else Trace(tuple(given), sources, given.end)
    if recording is None:
        from rvmon.readers.pairs import PairRecording

        recording = PairRecording(trace, schema, ordered=ordered)
    if sources is not None:
        recording.names = sources
    return recording


def _of_columns_or_lines(
    trace: Any, schema: Schema, *, ordered: bool
) -> FileRecording | TableRecording | None:
    """A file or a table as a recording; `None` if it is neither."""
    if isinstance(trace, str | Path):
        from rvmon.readers.recording import FileRecording

        return FileRecording(trace, schema, ordered=ordered)
    from rvmon.readers.tables import columns_by_name

    columns = columns_by_name(trace)
    if columns is None:
        return None
    from rvmon.readers.columns import TableRecording

    return TableRecording(columns, schema, ordered=ordered)
