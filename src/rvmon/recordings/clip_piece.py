"""Pieces of a recording. Rows of CSV and JSON lines are clipped here, and copied unchanged."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from fractions import Fraction
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from msgspec import Struct, field

from rvmon.recordings.csv_dialect import bare_names
from rvmon.recordings.csv_rows import CopiedLines, Layout, read_layout, split_lines
from rvmon.recordings.last_updates import LastUpdates, first_of, last_of
from rvmon.recordings.places import bounded_lines, created, opened
from rvmon.recordings.recording import FileRecording
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import stamps_of, ticks_of_stamp
from rvmon.trace.time import TICKS_PER_SECOND, TICKS_PER_UNIT, TIME_LIMIT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch


class Piece(Struct, frozen=True):
    """A stretch of a recording."""

    start: int  # its first instant, ticks
    stop: int  # its last instant, ticks
    schema: Schema  # the declared names, and how the recording names them
    ordered: bool = True  # whether no sample is late, so that reading stops after the piece
    # carried-in values: by name, those that signals have from before the start
    held: Mapping[str, Value] = field(default_factory=dict)

    def holds(self, t: Any) -> Any:
        """Whether an instant (ticks) lies in the piece; for an array, a mask."""
        return (self.start <= t) & (t <= self.stop)

    def held_of(self, instants: NDArray[Any]) -> tuple[NDArray[Any], bool]:
        """A mask of the instants that lie in the piece, and whether no later instant can.

        `instants`: in order of the rows. In an ordered recording nothing after the first instant
        beyond the end belongs to the piece, even if time goes back there, which is an error.
        """
        import numpy as np

        held = self.holds(instants)
        if not self.ordered:
            return held, False
        is_after = np.maximum.accumulate(instants > self.stop)
        return held & ~is_after, bool(is_after[-1])

    @property
    def without_names(self) -> Schema:
        """The schema without names, to read stamps only: most rows lie outside of the piece."""
        return replace(self.schema, signals={}, events={})


class Copied(Struct):
    """A count of the samples copied to a piece, without the carried-in values."""

    count: int = 0
    first: int = TIME_LIMIT
    last: int = -TIME_LIMIT

    def note(self, *instants: int) -> None:
        """Count copied samples by their instants (ticks)."""
        self.count += len(instants)
        self.first = min(self.first, *instants)
        self.last = max(self.last, *instants)


def values_before(
    pieces: Iterable[Batch | Sample],
    start: int,
    schema: Schema,
    stale_after: Mapping[str, int],
    *,
    ordered: bool,
) -> dict[str, Value]:
    """The values that signals carry into a piece: their last ones before its start.

    A signal with an update at the start carries none. `stale_after`: by signal, the age (ticks)
    above which a value is not carried.

    >>> from rvmon.trace.schema import Kind
    >>> schema = Schema({"speed": Kind.REAL, "ready": Kind.BOOL}, {"go": {}})
    >>> first = {"speed": 1.0, "ready": True, "go": True}
    >>> samples = [Sample(0, first), Sample(9, {"ready": False})]
    >>> values_before(samples, 9, schema, {}, ordered=True)
    {'speed': 1.0}
    """
    last: dict[str, tuple[int, Value]] = {}
    names = schema.signals.keys()
    updates = LastUpdates(names, schema.ignoring)
    for piece in pieces:
        if first_of(piece) <= start:
            own = piece if isinstance(piece, Sample) else piece.up_to(start)
            for name, (t, value) in updates.last_in(own, names):
                if name not in last or t >= last[name][0]:
                    last[name] = t, value
        if ordered and last_of(piece) > start:  # do not read on: the rest may be broken
            break
    held: dict[str, Value] = {}
    for name in names:
        t, known = last.get(name, (start, None))
        if t < start and known is not None and start - t <= stale_after.get(name, start - t):
            held[name] = known
    return held


_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def stamp_text(ticks: int, stamps: Stamps) -> str:
    """An instant as the text of a cell, exactly.

    >>> stamp_text(1_500_000, Stamps("t", "ms")), stamp_text(-1, Stamps("t", "iso"))
    ('1.5', '1969-12-31T23:59:59.999999999Z')
    """
    if stamps.unit == "iso":
        seconds, rest = divmod(ticks, TICKS_PER_SECOND)
        whole = _EPOCH + timedelta(seconds=seconds)
        return f"{whole:%Y-%m-%dT%H:%M:%S}.{rest:09d}Z"
    per_unit = TICKS_PER_UNIT[stamps.unit]
    whole_units, rest = divmod(abs(ticks), per_unit)
    digits = f"{rest:0{len(str(per_unit)) - 1}d}".rstrip("0") if rest else ""
    return f"{'-' if ticks < 0 else ''}{whole_units}{'.' + digits if digits else ''}"


def stamp_number(ticks: int, stamps: Stamps) -> int | float:
    """An instant as a number that reads as this instant, or as the nearest possible one before it.

    >>> stamp_number(2 * 10**9, Stamps("t", "s")), stamp_number(10**8, Stamps("t", "s"))
    (2, 0.1)
    """
    whole, rest = divmod(ticks, TICKS_PER_UNIT[stamps.unit])
    if not rest:
        return whole
    number = float(Fraction(ticks, TICKS_PER_UNIT[stamps.unit]))
    while ticks_of_stamp(number, stamps) > ticks:
        number = math.nextafter(number, -math.inf)
    return number


def clip_text(path: str, piece: Piece, out: Path, *, is_csv: bool) -> Copied:
    """Write a piece of a CSV or JSON lines file, and report what was copied."""
    with (
        opened(path) as (plain, _),
        TextIOWrapper(plain, encoding="utf-8-sig", newline="") as text,
        created(out) as packed,
        TextIOWrapper(packed, encoding="utf-8", newline="") as made,
    ):
        lines = bounded_lines(text)
        header = 0
        if is_csv:
            heading = CopiedLines(lines)
            header, cells = next(split_lines(heading))
            made.write(heading.taken())
            made.write(_csv_start(piece, read_layout(*bare_names(cells, piece.schema))))
        else:
            made.write(_json_start(piece))
        recording = FileRecording(path, piece.without_names, ordered=piece.ordered)
        with closing(recording.stamps()) as stamps:
            return _copy(lines, header, stamps, piece, made)


def _copy(
    lines: Iterator[str],
    line: int,
    stamps: Iterator[tuple[NDArray[Any], NDArray[Any]]],
    piece: Piece,
    made: TextIO,
) -> Copied:
    """Copy the rows of a piece; `lines` starts after line `line`, `stamps`: `FileRecording.stamps`.

    A row consists of the lines after that of the previous row, up to its own line.
    """
    copied = Copied()
    for ends, instants in stamps:
        held, is_over = piece.held_of(instants)
        if held.any():
            copied.note(*instants[held].tolist())
            for end, is_held in zip(ends.tolist(), held.tolist(), strict=True):
                row = "".join(islice(lines, end - line))
                line = end
                if is_held:
                    made.write(row)
        else:
            line += sum(1 for _ in islice(lines, int(ends[-1]) - line))
        if is_over:
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
    stamps = piece.schema.stamps or stamps_of("t_ns")
    is_text = stamps.unit == "iso"
    stamp = stamp_text(piece.start, stamps) if is_text else stamp_number(piece.start, stamps)
    columns = piece.schema.columns
    values = {columns.get(name, name): value for name, value in piece.held.items()}
    return json.dumps({stamps.column: stamp, **values}, ensure_ascii=False) + "\n"
