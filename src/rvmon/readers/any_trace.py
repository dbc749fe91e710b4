"""Whatever a program or a person takes for a trace, as a recording."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rvmon.trace.sample import Recording, Sample, Trace
from rvmon.trace.schema import Schema
from rvmon.trace.time import ticks_of_seconds


def is_table(trace: Any) -> bool:
    """Whether a trace is columns by name."""
    return hasattr(trace, "column_names") or isinstance(trace, Mapping)


def recording_of(trace: Any, schema: Schema, *, ordered: bool) -> Recording:
    """A trace as a recording; it need not be read yet.

    Args:
        trace: a path, columns by name (arrays, an Arrow table), a recording, or an iterable of
            `(t, values)` with t in seconds.
        schema: the declared names, and what columns are called.
        ordered: whether a stamp of a file that is before the one above it is an error.

    Raises:
        TraceError: the trace cannot be read.
    """
    if isinstance(trace, str | Path):
        from rvmon.readers.recording import FileRecording

        return FileRecording(trace, schema, ordered=ordered)
    if hasattr(trace, "names") and hasattr(trace, "end"):
        recording: Recording = trace
        return recording
    if is_table(trace):
        from rvmon.readers.columns import trace_of_columns
        from rvmon.readers.tables import table_of

        table = table_of(trace, schema)
        return trace_of_columns(table.columns, schema, table.time)
    from rvmon.readers.pairs import pairs_of

    return Trace(tuple(Sample(ticks_of_seconds(t), values) for t, values in pairs_of(trace)))
