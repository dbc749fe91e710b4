"""A recording on disk as a sequence of samples, whatever its format."""

from __future__ import annotations

import os
import sys
from collections import Counter, deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import replace
from itertools import islice
from math import inf
from pathlib import Path
from stat import S_ISFIFO
from typing import TYPE_CHECKING, BinaryIO, TypeVar

from rvmon.errors import TraceError
from rvmon.recordings import ARRAYS, FORMATS, MESSAGE_FORMS, form_of_folder, places
from rvmon.recordings.csv_dialect import bare_names, opened_as_csv
from rvmon.recordings.csv_rows import Layout, read_layout
from rvmon.recordings.csv_text import CsvText
from rvmon.recordings.joined import Joined, schemas_of
from rvmon.recordings.rows import LOOKED_AT, Row, Rows, doubt_unit
from rvmon.trace.sample import Health, HealthKind, Outage, Sample
from rvmon.trace.schema import BY_NAME, Schema, Stamps
from rvmon.trace.stamps import stamps_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch
    from rvmon.recordings.csv_batch import Parsed
    from rvmon.recordings.messages.file import MessageFile

_Piece = TypeVar("_Piece")

_SECONDS = stamps_of("t")

JOINED = "joined"  # the format of several files that are one recording: `odom.csv + status.csv`


_UNITS = {"parquet": "row", JOINED: "joined row"}  # the word for a row in errors; default: line


class FileRecording:
    """A recording on disk, read as a stream: memory does not grow with its length."""

    def __init__(self, path: str | Path, schema: Schema, *, ordered: bool = True) -> None:
        """Open the recording and read its header.

        Args:
            path: a file, an address, or `-` for standard input. Text may be compressed (`.csv.gz`,
                `.jsonl.zst`).
            schema: the names that the spec declares, and how the recording provides them.
            ordered: whether a stamp before that of the previous row is an error. Under `max delay`
                rows are sorted instead.

        Raises:
            TraceError: the file cannot be opened, its ending is unknown or its header wrong.
        """
        self.path = str(path)  # the file, `-` for standard input
        self._schema = schema
        self._ordered = ordered
        # how often each undeclared name was read. Messages are not counted: a bag is recorded for
        # more than one purpose, so undeclared topics are no mistake.
        self.ignored: Counter[str] = Counter()
        self._format = format_of(self.path)
        brings_stamps = self.is_of_messages and self._format not in ARRAYS
        if brings_stamps and schema.stamps is not None:
            raise TraceError(f"{self.path}: messages have stamps of their own: use --clock")
        if self._format not in (*MESSAGE_FORMS, JOINED) and schema.binding != BY_NAME:
            message = "bindings and clocks are for messages, as in bags and MCAP files: use --map"
            raise TraceError(f"{self.path}: {message}")
        # false for a stream, which can be read once only
        self.can_be_read_again = can_be_read_again(self.path)
        if not self.can_be_read_again and self._format in ("csv", "parquet"):
            message = "is a pipe: pipes hold JSON lines; keep other recordings in a file"
            raise TraceError(f"{self.path}: {message}")
        unit = "message" if self.is_of_messages else _UNITS.get(self._format, "line")
        self.rows = Rows(schema, unit, ordered=ordered)  # turns its rows into samples
        self._open_file: BinaryIO | None = None
        self._stamps = schema.stamps or _SECONDS
        # declared names that have a column or topic; `None` for JSON lines, where any may occur
        self.names: frozenset[str] | None = None
        # the end that messages give for the recording, ticks; `None`: it ends with its last sample
        self.end: int | None = None
        self._messages: MessageFile | None = None
        self._joined: Joined | None = None
        self._first_text: tuple[CsvText[Parsed], Layout] | None = None
        self._text: CsvText[Parsed] | None = None
        if self._format == "csv":
            with (
                places.named_errors(self.path),
                opened_as_csv(self.path, schema.stamps) as (plain, _),
            ):
                text: CsvText[Parsed] = CsvText(plain)
                layout = self._layout(text)
            self._take_names(layout)
            self._first_text = (text, layout) if text.is_whole else None
        elif self._format == "parquet":
            from rvmon.recordings.parquet import parquet_layout

            with places.named_errors(self.path):
                self._take_names(parquet_layout(places.local_path(self.path), schema))
        elif self.is_of_messages:
            from rvmon.recordings.messages.file import MessageFile

            with places.named_errors(self.path):
                self._messages = MessageFile(self.path, self._format, schema)
            self.names, self.end = self._messages.names, self._messages.end
        elif self._format == JOINED:
            paths = places.files_of(self.path)
            of_messages = [format_of(path) in MESSAGE_FORMS for path in paths]
            files = zip(paths, schemas_of(paths, of_messages, schema), strict=True)
            parts = [FileRecording(*file, ordered=ordered) for file in files]
            self._joined = Joined(parts, self.rows)
            self.ignored, self.names = self._joined.ignored, self._joined.names
            self.end = self._joined.end

    @property
    def is_of_messages(self) -> bool:
        """Whether the recording holds messages of topics instead of columns."""
        return self._format in MESSAGE_FORMS

    @property
    def unread(self) -> Sequence[str]:
        """The columns, or topics and fields, for which no name is declared."""
        held = self._messages or self._joined
        return list(self.ignored) if held is None else held.unread

    @property
    def outages(self) -> Sequence[Outage]:
        """The outages, in order of time; a table or text has none."""
        held = self._messages or self._joined
        return () if held is None else held.outages

    def end_findings(self, until: int) -> None:
        """Leave samples after an instant (ticks) out of the findings about rows."""
        for one in (self, *(() if self._joined is None else self._joined.files)):
            one.rows.until = until

    def _take_names(self, layout: Layout) -> None:
        self.names = layout.names
        self._stamps = layout.stamps
        for name in layout.ignored:
            self.ignored[name] += 1

    def __iter__(self) -> Iterator[Sample]:
        """Yield samples in order of time, with equal stamps merged.

        Raises:
            TraceError: with file and line; also if there is no sample.
        """
        return self._with_a_sample(self.samples())

    def _with_a_sample(self, read: Iterator[_Piece]) -> Iterator[_Piece]:
        with places.named_errors(self.path):
            yield from read
            if not self.rows.count:
                raise TraceError("holds no sample")

    def samples(self) -> Iterator[Sample]:
        """Yield samples as `__iter__` does; there may be none, and errors do not name the file."""
        if self._joined is not None:
            yield from self._joined
        else:
            with closing(self._each_row()) as rows:  # a wrong row must not leave the file open
                yield from self.rows.samples(rows)

    def _each_row(self) -> Generator[Row]:
        if self._messages is not None:
            yield from self._messages.rows(ordered=self._ordered)
        else:
            for piece in self._batches():
                yield from piece.numbered() if hasattr(piece, "numbered") else piece

    def pieces(self) -> Iterator[Batch | Sample]:
        """Yield the recording in order, as batches of columns where possible, else as samples.

        Raises:
            TraceError: with file and line; also if there is no sample.
        """
        return self._with_a_sample(self.parts())

    def parts(self) -> Iterator[Batch | Sample]:
        """Yield pieces as `pieces` does; there may be none, and errors do not name the file."""
        if self._joined is not None:
            yield from self._joined.pieces()
        elif self._messages is None and self.can_be_read_again and self._ordered:
            with closing(self._batches()) as batches:
                yield from self.rows.pieces(batches)
        else:
            yield from self.samples()

    def stamps(self) -> Generator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Yield, for some rows at a time in file order, the line (or number) of each and its ticks.

        A row of several lines has the number of its last line. Both arrays are int64[n].

        Raises:
            TraceError: with file and line; the rows before a wrong one are yielded first.
        """
        import numpy as np

        with places.named_errors(self.path), closing(self._batches()) as batches:
            for piece in batches:
                if isinstance(piece, Iterator):
                    rows: list[tuple[int, int]] = []
                    try:
                        rows.extend((line, t) for line, t, *_ in piece)
                    finally:  # the rows before a wrong one count, too
                        if rows:
                            lines, times = np.array(rows, np.int64).T
                            yield lines, times
                elif piece.lines is None:
                    yield piece.first + np.arange(len(piece.times)), piece.times
                else:
                    yield piece.lines, piece.times

    def _batches(self) -> Generator[Batch | Iterator[Row]]:
        if self._format == "parquet":
            from rvmon.recordings.parquet import parquet_batches_of

            yield from parquet_batches_of(places.local_path(self.path), self._schema)
            return
        if self._first_text is not None:
            first_text, self._first_text = self._first_text, None
            yield from self._csv_batches(*first_text)
            return
        with self._opened() as (plain, raw):
            self._open_file = raw if self.can_be_read_again else None
            if self._format == "csv":
                text: CsvText[Parsed] = CsvText(plain)
                yield from self._csv_batches(text, self._layout(text))
            else:
                from rvmon.recordings.jsonl_batch import jsonl_batches

                yield from jsonl_batches(plain, self._schema, self.ignored, self._take_stamps)

    def _csv_batches(
        self, text: CsvText[Parsed], layout: Layout
    ) -> Iterator[Batch | Iterator[Row]]:
        from rvmon.recordings.csv_batch import csv_batches

        self._text = text
        yield from csv_batches(text, layout, self._schema.ignoring)

    def _take_stamps(self, stamps: Stamps) -> None:
        self._stamps = stamps

    @property
    def fraction_read(self) -> float:
        """The fraction of the file that has been read, 0 to 1; 0 if unknown."""
        if self._messages is not None:
            return min(1.0, self.rows.count / (self._messages.count or inf))
        if self._open_file is None or self._open_file.closed:
            return 0.0
        return self._open_file.tell() / max(1, os.fstat(self._open_file.fileno()).st_size)

    def stamp_doubts(self) -> list[Health]:
        """The doubts about the stamps.

        Stamps of columns are in doubt if the first ones look like milliseconds; these are read here
        if nothing was read before. Stamps of messages are in doubt if the headers of those read
        disagree with the log.
        """
        if self._messages is not None:
            return self._messages.skew.doubts()
        if self._joined is not None:
            return self._joined.stamp_doubts()
        first = self.rows.first
        if not first and self._stamps.unit == "s" and self.path != "-":
            bare = replace(self._schema, signals={}, events={})
            again = FileRecording(self.path, bare, ordered=self._ordered)
            with places.named_errors(self.path):
                deque(islice(again.samples(), LOOKED_AT), 0)
            first, self._stamps = again.rows.first, again._stamps
        return doubt_unit(first, self._stamps)

    def health(self) -> list[Health]:
        """The findings of reading: undeclared names, conflicts, doubts about stamps and the end."""
        ignored = [
            Health(HealthKind.IGNORED, name, count, remark="not declared in the spec")
            for name, count in self.ignored.items()
        ]
        return ignored + self.rows.doubts() + self.doubts()

    def doubts(self) -> list[Health]:
        """The doubts about the stamps and the end of the recording."""
        return self.stamp_doubts() + self._cut_off()

    def _cut_off(self) -> list[Health]:
        """The doubt about the last cell, which may be cut off if its line has no end."""
        if self._text is None or not self._text.lost:
            return []
        names = ", ".join(f"`{name}`" for name in sorted(self._text.lost))
        remark = (
            f"it has no end: if it was cut off, {names} had another value, so it is unknown; "
            "if not, end the line"
        )
        return [Health(HealthKind.CUT, "the last line", remark=remark)]

    def _layout(self, text: CsvText[Parsed]) -> Layout:
        known, source, start = self._schema.layouts, text.rest, text.start
        end = source.find(b"\n", start) + 1
        found: Layout | None = known.get(source[start:end])
        if found is not None:
            text.cut(end)
            return found
        found = read_layout(*bare_names(text.header(), self._schema))
        known.clear()
        if text.rest is source:  # else the header went on beyond the block that was at hand
            known[source[start : text.start]] = found
        return found

    def _opened(self) -> AbstractContextManager[tuple[BinaryIO, BinaryIO]]:
        """Open the text: its plain bytes, and the raw file, whose position tells the progress."""
        if self.path == "-":
            return nullcontext((sys.stdin.buffer, sys.stdin.buffer))
        if self._format == "csv":
            return opened_as_csv(self.path, self._schema.stamps)
        return places.opened(self.path)


def messages_of(path: str) -> MessageFile:
    """Open a recording of messages to inspect its topics.

    Raises:
        TraceError: the recording has columns, or is several files.
    """
    recording = FileRecording(path, Schema({}, {}))
    if recording._joined is not None:
        raise TraceError(f"{path}: bindings are proposed for one file at a time: name a single one")
    if recording._messages is None:
        raise TraceError(f"{path}: has columns and no topics: use --map")
    return recording._messages


def can_be_read_again(path: str) -> bool:
    """Whether a recording is a file or address, not a stream that can be read once only."""
    if path == "-" or places.is_address(path):
        return path != "-"
    try:
        return not S_ISFIFO(os.stat(path).st_mode)
    except OSError:
        return True


_INSTEAD = {
    ".rv": "it is a specification, and a recording is expected here",
    ".yaml": "a ROS 2 bag is named by its folder",
    ".json": "write an object per line, to a .jsonl file",
    ".xlsx": "export it as .csv",
    **dict.fromkeys((".txt", ".tsv", ".dat"), "name a table of text .csv; its separator is found"),
}
"""The fix, by the ending of a file that is not a recording."""


def format_of(path: str) -> str:
    """The format of a recording by its path.

    Raises:
        TraceError: there is no such file, its ending is unknown, or its format cannot be packed.
    """
    if path == "-":
        return "jsonl"
    if places.JOINT in path and not os.path.lexists(path):
        return JOINED
    if not places.is_address(path) and (form := form_of_folder(path)):
        return form
    if places.is_address(path) and path.endswith("/"):
        return "ros2"
    suffix, packed = places.endings_of(path)
    if suffix not in FORMATS and not places.is_address(path):
        with places.named_errors(path):
            os.listdir(path) if os.path.isdir(path) else os.stat(path)
    if suffix not in FORMATS:
        ending = (
            f"the ending `{suffix}` is not a known format" if suffix else "the name has no ending"
        )
        fix = _INSTEAD.get(suffix, f"use one of {', '.join(FORMATS)}")
        raise TraceError(f"{path}: {ending}: {fix}")
    if packed and FORMATS[suffix] not in ("csv", "jsonl"):
        raise TraceError(f"{path}: only text is read packed: unpack it first")
    return FORMATS[suffix]
