"""Pieces cut out of a recording; the rows of CSV and JSON lines are copied as they stand."""

from __future__ import annotations

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime, timedelta
from fractions import Fraction
from io import TextIOWrapper
from pathlib import Path

from msgspec import Struct, field

from rvmon.recordings.csv_rows import CopiedLines, Layout, csv_samples, read_layout, split_lines
from rvmon.recordings.jsonl_rows import jsonl_samples
from rvmon.recordings.places import bounded_lines, created, opened
from rvmon.trace.sample import Sample, Value
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import stamps_of, ticks_of_stamp
from rvmon.trace.time import TICKS_PER_SECOND, TICKS_PER_UNIT, TIME_LIMIT


class Piece(Struct, frozen=True):
    """A stretch of a recording."""

    start: int  # its first instant, ticks
    stop: int  # its last one
    schema: Schema  # the declared names, and how the recording names them
    ordered: bool = True  # whether nothing comes late, so that what lies behind it is not read
    # the values that signals bring along from before its start, by name
    held: Mapping[str, Value] = field(default_factory=dict)

    def holds(self, t: int) -> bool:
        """Whether an instant (ticks) lies in it."""
        return self.start <= t <= self.stop


class Copied(Struct):
    """The part of a recording that is in a piece, without the values carried in from before it."""

    count: int = 0
    first: int = TIME_LIMIT
    last: int = -TIME_LIMIT

    def note(self, *instants: int) -> None:
        """Count what was copied, by its instants (ticks)."""
        self.count += len(instants)
        self.first = min(self.first, *instants)
        self.last = max(self.last, *instants)


def values_before(
    samples: Iterable[Sample],
    start: int,
    schema: Schema,
    stale_after: Mapping[str, int],
    *,
    ordered: bool,
) -> dict[str, Value]:
    """The last values that signals had before an instant, but for those that get one at it.

    `stale_after`: by signal the ticks after which a value counts no more.

    >>> from rvmon.trace.schema import Kind
    >>> schema = Schema({"speed": Kind.REAL, "ready": Kind.BOOL}, {"go": {}})
    >>> first = {"speed": 1.0, "ready": True, "go": True}
    >>> samples = [Sample(0, first), Sample(9, {"ready": False})]
    >>> values_before(samples, 9, schema, {}, ordered=True)
    {'speed': 1.0}
    """
    last: dict[str, tuple[int, Value]] = {}
    for t, values in ((sample.t, sample.values) for sample in samples):
        if t > start:
            if ordered:
                break
            continue
        for name, value in values.items():
            if name in schema.signals and (name not in last or t >= last[name][0]):
                last[name] = t, value
    return {
        name: value
        for name, (t, value) in last.items()
        if t < start and value is not None and value == value
        if start - t <= stale_after.get(name, start - t)
    }


_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def stamp_text(ticks: int, stamps: Stamps) -> str:
    """An instant as a cell of text, exactly.

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
    """An instant as a number that is read as this instant, or as the nearest one before it.

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
    """Write a piece of a text, and report what is in it."""
    copied = Copied()
    with (
        opened(path) as (plain, _),
        TextIOWrapper(plain, encoding="utf-8-sig", newline="") as text,
        created(out) as packed,
        TextIOWrapper(packed, encoding="utf-8", newline="") as made,
    ):
        lines = CopiedLines(bounded_lines(text))
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
    stamps = piece.schema.stamps or stamps_of("t_ns")
    is_text = stamps.unit == "iso"
    stamp = stamp_text(piece.start, stamps) if is_text else stamp_number(piece.start, stamps)
    columns = piece.schema.columns
    values = {columns.get(name, name): value for name, value in piece.held.items()}
    return json.dumps({stamps.column: stamp, **values}, ensure_ascii=False) + "\n"
