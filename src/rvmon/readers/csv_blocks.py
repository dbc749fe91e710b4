"""Plain CSV files as columns, a block of the file at a time: memory does not grow with the file."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.readers.batch import NotPlainError
from rvmon.readers.blocks import Block
from rvmon.readers.csv_numbers import READERS, plain_values, text_cells
from rvmon.readers.csv_rows import Column, Layout, read_layout
from rvmon.readers.decimals import Cells, instants, truth_values
from rvmon.readers.line_chunks import BLOCK, is_short_of_memory, whole_lines
from rvmon.readers.plain import Seam, expect_plain_columns, held_values
from rvmon.trace.schema import Schema

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ODD = (b'"', b" ", b"\t", b"\0")

LARGE = 1 << 22
"""Bytes from which on a file is read by Arrow, if that is installed, so many at a time."""


def csv_blocks(
    path: str | Path, schema: Schema, fillable: frozenset[str] = frozenset()
) -> Iterator[Block]:
    """Read a plain CSV file.

    Plain is: numbers and truth values without quotes, spaces, labels and payloads, instants
    that increase, no empty cell but of names that are fillable. Of small files, and without Arrow,
    decimals have 15 digits at most, and truth values are 0 and 1.

    Args:
        path: of the file.
        schema: the declared names.
        fillable: the names of which "no update" may be read as what was there before: of signals
            the value, of events that they do not occur.

    Raises:
        NotPlainError: it is not; the blocks before were right.
    """
    by_arrow = _arrow_reader(path)
    layout = seam = block = None
    for text in whole_lines(path, LARGE if by_arrow else BLOCK):
        if any(odd in text for odd in _ODD):
            raise NotPlainError("it has quoted or odd characters")
        body = text
        if layout is None or seam is None:
            header, _, body = text.partition(b"\n")
            layout = _plain_layout(header, schema)
            seam = Seam(layout)
        if body:
            rows = body, layout, fillable, seam.held
            block = (by_arrow and by_arrow(*rows)) or _block(*rows)
            yield seam.joined(block)
    if block is None:
        raise NotPlainError("it has no rows")


def _arrow_reader(path: str | Path) -> Callable[..., Block | None] | None:
    """What reads large files on all cores, if it is installed."""
    with suppress(OSError, ImportError):
        if os.path.getsize(path) >= LARGE and not is_short_of_memory():
            from rvmon.readers.csv_arrow_blocks import arrow_block

            return arrow_block
    return None


def _plain_layout(header: bytes, schema: Schema) -> Layout:
    names = header.decode().split(",")
    if max(map(len, names)) > csv.field_size_limit():
        raise NotPlainError("it has very long cells")
    try:
        layout = read_layout(names, schema)
    except TraceError:
        raise NotPlainError("its header cannot be read") from None
    expect_plain_columns(layout)
    return layout


def _block(body: bytes, layout: Layout, fillable: frozenset[str], held: Mapping[str, Any]) -> Block:
    cells = text_cells(body, len(layout.header))
    times = plain_values(instants(cells(layout.time), layout.stamps.unit))
    columns: dict[str, NDArray[Any]] = {
        column.name: _values(cells(column.index), column, fillable, held)
        for column in layout.signals
    }
    for column in layout.events:
        columns[column.name] = _occurrences(cells(column.index), column.name, fillable)
    return Block(times, columns)


def _values(
    cells: Cells, column: Column, fillable: frozenset[str], held: Mapping[str, Any]
) -> NDArray[Any]:
    """The values of a column; gaps of a signal are filled with what it holds."""
    read = READERS[column.kind]
    given = cells.ends > cells.starts
    if given.all():
        return plain_values(read(cells))
    before = held.get(column.name)
    if column.name not in fillable or not (given[0] or before is not None):
        raise NotPlainError(f"`{column.name}` has gaps that may matter")
    rows = np.flatnonzero(given)
    some = np.array([], np.dtype(type(before)))
    if len(rows):
        some = plain_values(read(Cells(cells.text, cells.starts[rows], cells.ends[rows])))
    return held_values(some, given, before)


def _occurrences(cells: Cells, name: str, fillable: frozenset[str]) -> NDArray[np.bool_]:
    """Where an event occurs; an empty cell says that it does not."""
    given = np.flatnonzero(cells.ends > cells.starts)
    if len(given) < len(cells.ends) and name not in fillable:
        raise NotPlainError(f"`{name}` has gaps that may matter")
    made = np.zeros(len(cells.ends), bool)
    if len(given):
        made[given] = plain_values(
            truth_values(Cells(cells.text, cells.starts[given], cells.ends[given]))
        )
    return made
