"""Whatever a program or a person takes for a trace, as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rvmon.readers.gaps import Gaps
from rvmon.trace.sample import Recording
from rvmon.trace.schema import Schema


def recording_of(trace: Any, schema: Schema, *, time: str, ordered: bool, gaps: Gaps) -> Recording:
    """A trace as a recording; it need not be read yet.

    Args:
        trace: a path, a table (columns by name, an Arrow table, a data frame), a recording, or an
            iterable of `(t, values)` with t in seconds.
        schema: the declared names.
        time: the time column of columns; if its name ends in `_ns`, integer ticks.
        ordered: whether a stamp that is before the one above it is an error.
        gaps: values that stand for no update; a recording says so itself.

    Raises:
        TraceError: the trace cannot be read.
    """
    if isinstance(trace, str | Path):
        from rvmon.readers.recording import FileRecording

        return FileRecording(trace, schema, ordered=ordered, gaps=gaps)
    from rvmon.readers.rows import RowRecording, Rows
    from rvmon.readers.tables import columns_by_name

    columns = columns_by_name(trace)
    if columns is not None:
        from rvmon.readers.columns import Table

        table = Table(columns, schema, time)
        rows = Rows(schema, "row", ordered=ordered)
        return RowRecording(table.layout.names, lambda: table.rows(gaps), rows)
    if hasattr(trace, "names") and hasattr(trace, "end"):
        recording: Recording = trace
        return recording
    from rvmon.readers.pairs import expect_pairs, pair_rows

    expect_pairs(trace)
    rows = Rows(schema, "item", ordered=ordered)
    return RowRecording(None, lambda: pair_rows(trace, schema, gaps), rows)
