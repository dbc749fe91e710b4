"""CSV text in pieces: rows as columns where a piece is plain, else one by one."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import BinaryIO

from rvmon.readers import line_chunks
from rvmon.readers.batch import Batch, NotPlainError
from rvmon.readers.csv_rows import Layout, csv_samples, split_lines
from rvmon.readers.line_chunks import bounded_lines, is_short_of_memory
from rvmon.readers.rows import Row

LARGE = 1 << 22
"""Bytes from which on a text is worth importing Arrow, if that is installed."""

_MARK = b"\xef\xbb\xbf"
"""That some editors begin a text with."""

ODD = 1 << 14
"""Bytes of a piece that is read row by row if a cell of it is odd."""

ReadPiece = Callable[[bytes, Layout], Batch]


def csv_batches(
    file: BinaryIO, size: int, layout_of: Callable[[Iterator[tuple[int, list[str]]]], Layout]
) -> Iterator[Batch | Iterator[Row]]:
    """The rows of a text, in order.

    Args:
        file: is read from its start.
        size: bytes that it has, about.
        layout_of: reads the header off the rows.

    Raises:
        TraceError: with the line's number.
        UnicodeDecodeError: it is no text.
    """
    read, each = _reader(size)
    texts = whole_pieces(file, each)
    first = next(texts, b"").removeprefix(_MARK)
    header, _, body = first.partition(b"\n")
    if header.count(b'"') % 2 or b"\r" in header[:-1]:  # it goes on, or ends elsewhere
        yield _rows_behind(first, texts, layout_of)
        return
    layout = layout_of(split_lines([header.decode() + "\n"]))
    line = 1
    for text in _with(body, texts):
        if text.count(b'"') % 2:  # a cell may go on in the next piece
            yield csv_samples(split_lines(_lines(text, texts), line), layout)
            return
        yield from _batches(text, layout, read, line)
        line += text.count(b"\n")


def _batches(
    text: bytes, layout: Layout, read: ReadPiece, line: int
) -> Iterator[Batch | Iterator[Row]]:
    """The rows of a piece behind so many lines; of one with an odd cell by halves."""
    try:
        batch = read(text, layout)
    except NotPlainError:
        half = text.rfind(b"\n", 0, len(text) // 2) + 1
        if len(text) < ODD or not half or text.count(b'"', 0, half) % 2:
            yield csv_samples(split_lines(_lines(text, ()), line), layout)
            return
        yield from _batches(text[:half], layout, read, line)
        yield from _batches(text[half:], layout, read, line + text.count(b"\n", 0, half))
    else:
        yield replace(batch, first=line + 1)


def _reader(size: int) -> tuple[ReadPiece, int]:
    """What reads pieces, and so many bytes at a time."""
    if size >= LARGE or "pyarrow.csv" in sys.modules:
        with suppress(ImportError):
            if not is_short_of_memory():
                from rvmon.readers.csv_arrow import arrow_batch

                return arrow_batch, 4 * line_chunks.BLOCK
    from rvmon.readers.csv_numbers import number_batch

    return number_batch, line_chunks.BLOCK


def _with(body: bytes, texts: Iterator[bytes]) -> Iterator[bytes]:
    if body:
        yield body
    yield from texts


def whole_pieces(file: BinaryIO, size: int) -> Iterator[bytes]:
    r"""A file in pieces of whole lines; the last line may lack its end."""
    rest = b""
    while piece := file.read(size):
        whole, newline, tail = piece.rpartition(b"\n")
        if newline:
            yield rest + whole + newline
            rest = tail
        else:
            rest += piece
    if rest:
        yield rest


def _lines(text: bytes, texts: Iterable[bytes]) -> Iterator[str]:
    """The lines of a piece, and of those behind it."""
    for one in _with(text, iter(texts)):
        yield from bounded_lines(io.StringIO(one.decode(), newline=""))


def _rows_behind(
    first: bytes,
    texts: Iterator[bytes],
    layout_of: Callable[[Iterator[tuple[int, list[str]]]], Layout],
) -> Iterator[Row]:
    rows = split_lines(_lines(first, texts))
    yield from csv_samples(rows, layout_of(rows))
