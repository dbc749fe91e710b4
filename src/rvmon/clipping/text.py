"""Pieces of CSV and of JSON lines: rows are copied as they stand."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from io import TextIOWrapper
from pathlib import Path

from rvmon.clipping.piece import Copied, Piece, stamp_number, stamp_text
from rvmon.readers.csv_rows import Layout, csv_samples, read_layout, split_lines
from rvmon.readers.jsonl_rows import jsonl_samples
from rvmon.readers.line_chunks import bounded_lines
from rvmon.readers.places import created, opened
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import stamps_of


class _Copied:
    """Lines as they are read, of which those of the last row can be asked for."""

    def __init__(self, lines: Iterable[str]) -> None:
        self._lines = lines
        self._read: list[str] = []

    def __iter__(self) -> Iterator[str]:
        for line in self._lines:
            self._read.append(line)
            yield line

    def taken(self) -> str:
        """The lines since this was asked last, each with an end."""
        text = "".join(self._read)
        self._read.clear()
        return text if text.endswith("\n") else f"{text}\n"


def clip_text(path: str, piece: Piece, out: Path, *, is_csv: bool) -> Copied:
    """Write a piece of a text, and report what is in it.

    Raises:
        TraceError: a row up to the end of the piece cannot be read.
        OSError: a file cannot be read or written.
    """
    copied = Copied()
    with (
        opened(path) as (plain, _),
        TextIOWrapper(plain, encoding="utf-8-sig", newline="") as text,
        created(out) as packed,
        TextIOWrapper(packed, encoding="utf-8", newline="") as made,
    ):
        lines = _Copied(bounded_lines(text))
        if is_csv:
            split = split_lines(lines)
            layout = read_layout(next(split)[1], piece.schema)
            made.write(lines.taken())
            made.write(_csv_start(piece, layout))
            rows = csv_samples(split, layout)
        else:
            made.write(_json_start(piece))
            rows = jsonl_samples(lines, piece.schema, Counter())
        for _, t, _ in rows:
            row = lines.taken()
            if piece.holds(t):
                made.write(row)
                copied.note(t)
            elif piece.ordered and t > piece.stop:
                break
    return copied


def _csv_start(piece: Piece, layout: Layout) -> str:
    if not piece.held:
        return ""
    cells = [""] * len(layout.header)
    cells[layout.time] = stamp_text(piece.start, layout.stamps)
    for column in layout.signals:
        if column.name in piece.held:
            value = piece.held[column.name]
            cells[column.index] = str(value).lower() if isinstance(value, bool) else str(value)
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(cells)
    return line.getvalue()


def _json_start(piece: Piece) -> str:
    if not piece.held:
        return ""
    stamps = _stamps(piece.schema)
    is_text = stamps.unit == "iso"
    stamp = stamp_text(piece.start, stamps) if is_text else stamp_number(piece.start, stamps)
    columns = piece.schema.columns
    values = {columns.get(name, name): value for name, value in piece.held.items()}
    return json.dumps({stamps.column: stamp, **values}, ensure_ascii=False) + "\n"


def _stamps(schema: Schema) -> Stamps:
    """How a line of its own says when: each may choose where it is not given."""
    return schema.stamps or stamps_of("t_ns")
