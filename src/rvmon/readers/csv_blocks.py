"""Plain CSV files as columns, a block of the file at a time: memory does not grow with the file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TraceError
from rvmon.readers.blocks import Block, NotPlainError
from rvmon.readers.csv_rows import Layout, read_layout
from rvmon.readers.decimals import Cells, decimals, nanoseconds, truth_values, whole_numbers
from rvmon.trace.schema import Kind, Schema

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 1 << 20
"""Bytes of a block."""

_ODD = (b'"', b" ", b"\t", b"\0", b"\r")


def csv_blocks(path: str | Path, schema: Schema) -> Iterator[Block]:
    """Read a plain CSV file.

    Plain is: numbers and truth values (0, 1) without quotes, spaces, labels and payloads, no empty
    cell, instants that increase.

    Args:
        path: of the file.
        schema: the declared names.

    Raises:
        NotPlainError: it is not; the blocks before were right.
    """
    last = None
    layout = None
    for text in _pieces(path):
        body = text
        if layout is None:
            header, _, body = text.partition(b"\n")
            layout = _plain_layout(header, schema)
        if body:
            block = _block(body, layout)
            if last is not None and block.times[0] <= last:
                raise NotPlainError
            last = block.times[-1]
            yield block
    if last is None:
        raise NotPlainError


def _pieces(path: str | Path) -> Iterator[bytes]:
    """The file in pieces of whole lines."""
    rest = b""
    try:
        with open(path, "rb") as file:
            while piece := file.read(BLOCK):
                whole, newline, tail = piece.rpartition(b"\n")
                if newline:
                    yield _without_returns(rest + whole + newline)
                    rest = tail
                else:
                    rest += piece
                    if len(rest) > 4 * BLOCK:
                        raise NotPlainError
    except OSError:
        raise NotPlainError from None
    if rest:
        yield _without_returns(rest + b"\n")


def _without_returns(text: bytes) -> bytes:
    if b"\r" in text:
        text = text.replace(b"\r\n", b"\n")
    if not text.isascii() or any(odd in text for odd in _ODD):
        raise NotPlainError
    return text


def _plain_layout(header: bytes, schema: Schema) -> Layout:
    try:
        layout = read_layout(header.decode().split(","), schema)
    except TraceError:
        raise NotPlainError from None
    if any(column.field is not None for column in layout.events):
        raise NotPlainError
    if any(column.kind is Kind.LABEL for column in layout.signals):
        raise NotPlainError
    return layout


def _block(body: bytes, layout: Layout) -> Block:
    text = np.frombuffer(body, np.uint8)
    ends = np.flatnonzero((text == ord(",")) | (text == ord("\n")))
    rows, rest = divmod(len(ends), layout.width)
    if rest:
        raise NotPlainError
    table = ends.reshape(rows, layout.width)
    is_end = text[table] == ord("\n")
    if not is_end[:, -1].all() or is_end[:, :-1].any():
        raise NotPlainError
    starts = np.concatenate(([0], ends[:-1] + 1)).reshape(rows, layout.width)

    def cells(index: int) -> Cells:
        return Cells(text, starts[:, index], table[:, index])

    read = whole_numbers if layout.in_ticks else nanoseconds
    times = _plain(read(cells(layout.time)))
    if not (times[1:] > times[:-1]).all():
        raise NotPlainError
    readers = {Kind.BOOL: truth_values, Kind.INT: whole_numbers, Kind.REAL: decimals}
    columns = {
        column.name: _plain(readers[column.kind](cells(column.index)))
        for column in (*layout.signals, *layout.events)
    }
    return Block(times, columns)


def _plain(values: NDArray[Any] | None) -> NDArray[Any]:
    if values is None:
        raise NotPlainError
    return values
