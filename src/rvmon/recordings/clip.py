"""Clipping: writes a piece of a recording in the same format. Parquet is clipped here."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from rvmon.errors import RvmonError, TraceError, writing
from rvmon.files import staged
from rvmon.recordings import FORMATS, MESSAGE_FORMATS
from rvmon.recordings.clip_piece import Copied, Piece, stamp_number, stamp_text
from rvmon.recordings.csv_rows import Layout
from rvmon.recordings.parquet import parquet_batches, parquet_file, parquet_layout
from rvmon.recordings.places import endings_of, local_path
from rvmon.recordings.recording import JOINED, FileRecording, can_be_read_again, format_of
from rvmon.texts import cannot_read
from rvmon.trace.schema import Stamps
from rvmon.trace.time import TIME_LIMIT, format_stamp

CLIPPED = {
    "csv": "CSV",
    "jsonl": "JSON lines",
    "parquet": "Parquet",
    "mcap": "MCAP",
    "ros1": "bags of ROS 1",
    "ros2": "bags of ROS 2",
}
"""The formats that can be clipped, with their names for messages."""


def refuse_place(path: str, out: str | None) -> None:
    """Check, before any work is done, that a piece of a recording can be written to a place.

    Raises:
        RvmonError: the recording cannot be clipped, or `out` has the ending of another format, or
            `out` exists where a bag would be a new folder.
        TraceError: the recording has no known format.
    """
    form = format_of(path)
    if not can_be_read_again(path):
        name = "standard input" if path == "-" else path
        raise RvmonError(f"{name} can be read once only: save the recording first")
    if form in ("tables", JOINED):
        raise RvmonError(f"{path} is several files: clip each of them, by --from and --to")
    if form not in CLIPPED:
        listed = ", ".join(CLIPPED.values())
        raise RvmonError(f"{path}: this format cannot be clipped; these can: {listed}")
    if out is None:
        return
    if form == "ros2" and local_path(path).is_dir():
        if os.path.lexists(out):
            raise RvmonError(f"cannot write {out}: it exists already, and a bag needs a new folder")
        return
    ending = endings_of(out)[0]
    if FORMATS.get(ending) != form:
        fitting = " or ".join(one for one, other in FORMATS.items() if other == form)
        raise RvmonError(f"cannot write {out}: a piece of {path} ends in {fitting}")
    if form not in ("csv", "jsonl") and endings_of(out)[1]:
        raise RvmonError(f"cannot write {out}: only text is packed")


def clip(path: str, piece: Piece, out: str) -> Copied:
    """Write a piece of a recording, whole or not at all.

    Raises:
        TraceError: the recording cannot be read, or the piece is empty.
        RvmonError: the piece cannot be written.
    """
    with writing(out), staged(out) as made:
        try:
            copied = _written(path, piece, made)
        except UnicodeDecodeError as error:
            raise TraceError(cannot_read(path, error)) from None
        except TraceError as error:
            message = str(error)
            raise TraceError(message if path in message else f"{path}: {message}") from None
        if not copied.count:
            where = f"from {format_stamp(piece.start)} on"
            if piece.stop < TIME_LIMIT:
                where = f"between {format_stamp(piece.start)} and {format_stamp(piece.stop)}"
            raise TraceError(f"{path}: there is nothing {where}")
    return copied


def _written(path: str, piece: Piece, out: Path) -> Copied:
    form = format_of(path)
    if form in MESSAGE_FORMATS.values():
        from rvmon.recordings.clip_messages import clip_messages

        return clip_messages(path, form, piece, out)
    if form == "parquet":
        return clip_parquet(local_path(path), piece, out)
    from rvmon.recordings.clip_piece import clip_text

    return clip_text(path, piece, out, is_csv=form == "csv")


def clip_parquet(path: Path, piece: Piece, out: Path) -> Copied:
    """Write a piece of a Parquet file, and report what was copied."""
    schema = parquet_file(path).schema_arrow
    if piece.held:  # the first row, made for carried-in values, has no cells in other columns
        for place, field in enumerate(schema):
            schema = schema.set(place, field.with_nullable(True))
    import numpy as np
    import pyarrow
    from pyarrow import parquet

    copied = Copied()
    with parquet.ParquetWriter(out, schema) as writer:
        if piece.held:
            writer.write_table(_start(piece, parquet_layout(path, piece.schema), schema))
        stamps = FileRecording(path, piece.without_names, ordered=piece.ordered).stamps()
        ahead = np.empty(0, np.int64)
        for arrays in parquet_batches(path, schema.names):
            # Batches of columns with dictionaries may be shorter than those of stamps alone.
            while len(ahead) < len(arrays[0]):
                ahead = np.concatenate([ahead, next(stamps)[1]])
            instants, ahead = np.split(ahead, [len(arrays[0])])
            held, is_over = piece.held_of(instants)
            if held.any():
                batch = pyarrow.RecordBatch.from_arrays(arrays, schema=schema)
                writer.write_batch(batch.filter(pyarrow.array(held)))
                copied.note(*instants[held].tolist())
            if is_over:
                break
    return copied


def _start(piece: Piece, layout: Layout, schema: Any) -> Any:
    """The row of values carried in from before the piece, as a table."""
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
    """An instant as a column of one stamp; the nearest one before it that the type can hold."""
    import pyarrow

    if pyarrow.types.is_timestamp(kind):
        exact = pyarrow.array([ticks], pyarrow.timestamp("ns", kind.tz))
        return exact.cast(kind, safe=False)
    if pyarrow.types.is_duration(kind):
        return pyarrow.array([ticks], pyarrow.duration("ns")).cast(kind, safe=False)
    if stamps.unit == "iso":
        return pyarrow.array([stamp_text(ticks, stamps)]).cast(kind)
    number = stamp_number(ticks, stamps)
    if pyarrow.types.is_integer(kind):
        number = int(number // 1)
    return pyarrow.array([number]).cast(kind)
