"""Pieces of Parquet files: the types and order of columns stay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rvmon.clipping.piece import Copied, Piece
from rvmon.clipping.stamps import stamp_number, stamp_text
from rvmon.readers.csv_rows import Layout, read_layout
from rvmon.readers.parquet import parquet_batches, parquet_file
from rvmon.readers.tables import arrow_cells
from rvmon.trace.schema import Stamps
from rvmon.trace.stamps import ticks_of_stamp


def clip_parquet(path: Path, piece: Piece, out: Path) -> Copied:
    """Write a piece of a file, and report what is in it.

    Raises:
        RvmonError: there is no pyarrow.
        TraceError: the file cannot be read.
        OSError: a file cannot be read or written.
    """
    schema = parquet_file(path).schema_arrow
    if piece.held:  # the row that brings values along lacks others
        for place, field in enumerate(schema):
            schema = schema.set(place, field.with_nullable(True))
    import pyarrow
    from pyarrow import parquet

    layout = read_layout(list(schema.names), piece.schema)
    copied = Copied()
    with parquet.ParquetWriter(out, schema) as writer:
        if piece.held:
            writer.write_table(_start(piece, layout, schema))
        for arrays in parquet_batches(path, list(schema.names)):
            stamps = arrow_cells(arrays[layout.time])
            instants = [ticks_of_stamp(stamp, layout.stamps) for stamp in stamps]
            kept = [t for t in instants if piece.holds(t)]
            if kept:
                mask = pyarrow.array(list(map(piece.holds, instants)))
                batch = pyarrow.RecordBatch.from_arrays(arrays, schema=schema)
                writer.write_batch(batch.filter(mask))
                copied.note(*kept)
            if piece.ordered and instants and instants[-1] > piece.stop:
                break
    return copied


def _start(piece: Piece, layout: Layout, schema: Any) -> Any:
    """A row of the values that are brought along."""
    import pyarrow

    cells: list[Any] = [None] * len(layout.header)
    for column in layout.signals:
        cells[column.index] = piece.held.get(column.name)
    arrays = [
        pyarrow.nulls(1, field.type) if cell is None else pyarrow.array([cell]).cast(field.type)
        for cell, field in zip(cells, schema, strict=True)
    ]
    arrays[layout.time] = _stamp(piece.start, layout.stamps, schema.field(layout.time).type)
    return pyarrow.table(arrays, schema=schema)


def _stamp(ticks: int, stamps: Stamps, kind: Any) -> Any:
    """An instant, or the nearest one before it that the column can hold."""
    import pyarrow

    if pyarrow.types.is_timestamp(kind):
        exact = pyarrow.array([ticks], pyarrow.timestamp("ns", kind.tz))
        return exact.cast(kind, safe=False)
    if stamps.unit == "iso":
        return pyarrow.array([stamp_text(ticks, stamps)]).cast(kind)
    number = stamp_number(ticks, stamps)
    if pyarrow.types.is_integer(kind):
        number = int(number // 1)
    return pyarrow.array([number]).cast(kind)
