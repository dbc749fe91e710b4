"""Recordings as blocks of columns, for engines that judge by arrays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block, up_to
from rvmon.readers.columns import TableRecording
from rvmon.readers.places import local_path
from rvmon.readers.recording import FileRecording, can_be_read_again
from rvmon.readers.source import Source
from rvmon.readers.steps import LOOKED_AT

Fillable = Callable[[], frozenset[str]]
"""Gives the names of which "no update" may be read as what was there before."""


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a recording.

    Attributes:
        names: declared ones.
        rows: how many there are; `None` if nobody has counted.
        read: gives the blocks, from the first on, at each call.
    """

    names: tuple[str, ...]
    rows: int | None
    read: Callable[[], Iterator[Block]]


def columns_of(source: Source, fillable: Fillable) -> Columns:
    """The columns of a recording; the first block is read.

    Args:
        source: the recording.
        fillable: of signals, and of events, which then do not occur.

    Raises:
        NotPlainError: there are none, or so far as one can see now; so does reading them.
    """
    if source.row_by_row:
        raise NotPlainError(source.row_by_row)
    until = source.until if source.is_cut else None

    def read() -> Iterator[Block]:
        return source.shown(_blocks_of(source.recording, fillable, until))

    begun = read()
    first = next(begun, None)
    if first is None:
        raise NotPlainError("it has no rows")
    ready = [chain([first], begun)]
    rows = None
    if isinstance(source.recording, TableRecording):
        rows = len(source.recording.columns[source.recording.layout.stamps.column])
    return Columns(tuple(first.columns), rows, lambda: ready.pop() if ready else read())


def _blocks_of(recording: Any, fillable: Fillable, until: int | None) -> Iterator[Block]:
    if isinstance(recording, FileRecording):
        return file_blocks(recording, fillable, until)
    if isinstance(recording, TableRecording):
        return table_blocks(recording, fillable, until)
    held = getattr(recording, "held_blocks", None)
    if held is None:
        raise NotPlainError("its samples come one by one")
    return (up_to(until, block) for block in held)


def table_blocks(
    table: TableRecording, fillable: Fillable, until: int | None = None
) -> Iterator[Block]:
    """A table in memory as blocks of columns; see `file_blocks`."""
    from rvmon.readers.arrays import block_of_table

    yield up_to(until, block_of_table(table.columns, table.layout, table._schema, fillable))


def file_blocks(
    recording: FileRecording, fillable: Fillable, until: int | None = None
) -> Iterator[Block]:
    """A recording as blocks of columns; memory does not grow with its length.

    Args:
        recording: a file.
        fillable: gives the names of which "no update" may be read as what was there before: of
            signals the value, of events that they do not occur.
        until: rows behind this instant (ticks) are left out.

    Raises:
        NotPlainError: it has to be read row by row; a block before may have been given out.
    """
    if not can_be_read_again(recording.path):
        raise NotPlainError("it is a stream")
    if recording.is_of_messages:
        raise NotPlainError("its messages come one by one")
    if recording._schema.gaps:
        raise NotPlainError("values that stand for no update are looked for in rows")
    seen = Counter[str]()
    for block in _noted(recording, _blocks(recording, fillable(), seen)):
        own = up_to(until, block)
        yield own
        if len(own.times) < len(block.times):
            if seen:
                raise NotPlainError("undeclared names are counted up to the end only")
            return
    for name, count in seen.items():
        recording.ignored[name] = count


def _noted(recording: FileRecording, blocks: Iterable[Block]) -> Iterator[Block]:
    """The same blocks; the first stamps are noted once as many have come as are looked at."""
    first: list[int] = []
    for block in blocks:
        if len(first) < LOOKED_AT:
            first += block.times[: LOOKED_AT - len(first)].tolist()
            if len(first) == LOOKED_AT and recording.names is not None:
                recording.rows.first = first
        yield block


def _blocks(
    recording: FileRecording, fillable: frozenset[str], seen: Counter[str]
) -> Iterator[Block]:
    """The blocks of its format; where each line has names of its own, undeclared ones count."""
    path, schema = recording.path, recording._schema
    if recording._format == "csv":
        from rvmon.readers.csv_blocks import csv_blocks

        return csv_blocks(path, schema, fillable)
    if recording._format == "parquet":
        from rvmon.readers.parquet_blocks import parquet_blocks

        return parquet_blocks(local_path(path), schema, fillable)
    from rvmon.readers.jsonl_blocks import jsonl_blocks

    return jsonl_blocks(path, schema, fillable, ignored=seen)
