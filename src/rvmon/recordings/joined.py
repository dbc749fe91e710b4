"""Recordings of several files, as written by loggers that make a file for each topic."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from heapq import merge
from itertools import takewhile
from operator import attrgetter
from typing import TYPE_CHECKING, Protocol

from rvmon.errors import TraceError
from rvmon.recordings.places import name_of, named_errors
from rvmon.recordings.rows import Row, Rows
from rvmon.trace.sample import Health, Outage, Recording, Sample
from rvmon.trace.schema import BY_NAME, Schema

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

_FEW = 64  # fewer rows than this are joined one by one


class File(Recording, Protocol):
    """One of the files or tables of a joined recording."""

    path: str
    ignored: Counter[str]
    rows: Rows

    @property
    def unread(self) -> Sequence[str]:
        """The columns for which no name is declared."""

    @property
    def outages(self) -> Sequence[Outage]:
        """The outages of the file."""

    def parts(self) -> Iterator[Batch | Sample]:
        """Yield the file in order, as batches of columns where possible; may be empty."""

    def doubts(self) -> list[Health]:
        """The doubts about the stamps and the end of the file."""


class Joined:
    """A recording of several files: their samples merged by time, each with its own file's names.

    A name is that of a column, or `FILE.COLUMN`. `FILE` is the file's name without the prefix that
    all files share: `status.armed` is the column `armed` of `log_17_status_0.csv`. Only rows of its
    own file update a name: no value is copied into rows of other files, nothing is resampled.
    """

    count = 0  # the number of rows is not known

    def __init__(self, files: Sequence[File], rows: Rows) -> None:
        self.files = files
        self.rows = rows
        found: dict[str, str] = {}
        for file in files:
            for name in sorted(file.names or ()):
                if name in found:
                    raise TraceError(
                        f"`{name}` is in {found[name]} and in {file.path}: declare "
                        f"`FILE.{name}` of the file that is meant, or leave the column out"
                    )
                found[name] = file.path
        # declared names that have a file; `None`: any may occur
        is_known = all(file.names is not None for file in files)
        self.names: frozenset[str] | None = frozenset(found) if is_known else None
        # the last instant, ticks; `None` unless every file gives its end
        ends = [file.end for file in files if file.end is not None]
        self.end = max(ends) if len(ends) == len(files) else None
        # the columns for which no name is declared
        self.unread = [column for file in files for column in file.unread]
        self.ignored = sum((file.ignored for file in files), Counter[str]())
        self.outages = sorted(_outages_of(files), key=lambda outage: outage.since)

    def blocks(self) -> Iterator[Batch | list[Row]]:
        """Yield the rows in order of time.

        Rows between the ends of two batches come as a batch if there are enough of them; the rows
        at the instant at which a batch ends come one by one.

        Raises:
            TraceError: a file cannot be read; the message names the file.
        """
        from rvmon.recordings.batch import outer_join

        number = 1
        heads = [head for head in map(_Head, self.files) if head.is_there]
        while heads:
            # All files have been read up to `until`. The file whose part ends first may still give
            # rows of that instant and later ones.
            until = min(head.instant(-1) for head in heads)
            before = [own for head in heads if (own := head.take_before(until)) is not None]
            count = sum(len(batch.times) for batch in before)
            joined = outer_join(before, number) if count >= _FEW else None
            # Conflicting values of one instant need no note here: each file has noted its own.
            apart = [batch.samples() for batch in before] if joined is None else []
            rows = [*merge(*apart, key=attrgetter("t"))]
            rows += [sample for head in heads for sample in head.take_at(until)]
            if joined is not None:
                yield joined
                number += len(joined.times)
            yield [(number + place, sample.t, sample.values) for place, sample in enumerate(rows)]
            number += len(rows)
            heads = [head for head in heads if head.is_there]

    def pieces(self) -> Iterator[Batch | Sample]:
        """Yield the recording in order, as batches and samples; errors as in `blocks`."""
        return self.rows.pieces(self.blocks())

    def __iter__(self) -> Iterator[Sample]:
        """Yield samples in order of time, with equal stamps merged; errors as in `blocks`."""
        for piece in self.pieces():
            yield from (piece,) if isinstance(piece, Sample) else piece.samples()

    def stamp_doubts(self) -> list[Health]:
        """The doubts about each file: its rows, its stamps and its end."""
        return [doubt for file in self.files for doubt in (*file.rows.doubts(), *file.doubts())]


class _Head:
    """The reading position in a file: a sample, or the rows of a batch not taken yet."""

    def __init__(self, file: File) -> None:
        self._path, self._parts = file.path, file.parts()
        self.is_there = True
        self._read_on()

    def _read_on(self) -> None:
        with named_errors(self._path):
            self._part = next(self._parts, None)
        self.is_there = self._part is not None

    def instant(self, place: int) -> int:
        """The first (`place` 0) or last (-1) instant of the current part, ticks."""
        part = self._part
        assert part is not None, "it is there"
        return part.t if isinstance(part, Sample) else int(part.times[place])

    def take_before(self, until: int) -> Batch | None:
        """Take the rows before an instant (ticks) off a batch; `None` if there are none."""
        part = self._part
        if part is None or isinstance(part, Sample):
            return None
        count = int(part.times.searchsorted(until))
        self._part = part.cut(count, len(part.times))
        return part.cut(0, count) if count else None

    def take_at(self, until: int) -> Iterator[Sample]:
        """Take the samples at an instant (ticks), reading further parts as needed."""
        while self.is_there and self.instant(0) == until:
            part = self._part
            if isinstance(part, Sample):
                yield part
            elif part is not None:
                count = int(part.times.searchsorted(until, "right"))
                yield from part.samples(0, count)
                self._part = part.cut(count, len(part.times))
                if count < len(part.times):
                    return
            self._read_on()


def topics_of(paths: Sequence[str]) -> list[tuple[str, str]]:
    """By file, its name, and the name without the common prefix and the instance number `_0`.

    >>> topics_of(["log_17_odom_0.csv", "log_17_status_0.csv"])
    [('log_17_odom_0', 'odom'), ('log_17_status_0', 'status')]
    """
    stems = [name_of(path).partition(".")[0] for path in paths]
    alike = sum(1 for _ in takewhile(lambda ones: len({*ones}) == 1, zip(*stems, strict=False)))
    cut = stems[0][:alike].rfind("_") + 1 if len(stems) > 1 else 0
    return [(stem, re.sub(r"_0$", "", stem[cut:])) for stem in stems]


def schemas_of(paths: Sequence[str], of_messages: Sequence[bool], schema: Schema) -> list[Schema]:
    """The schema of each file, in which names `FILE.COLUMN` of that file read its column."""
    return [
        replace(schema, stamps=None) if is_of_messages else _schema_of(topics, schema)
        for is_of_messages, topics in zip(of_messages, topics_of(paths), strict=True)
    ]


def _schema_of(topics: tuple[str, str], schema: Schema) -> Schema:
    fields = [f"{name}.{field}" for name, own in schema.events.items() for field in own]
    own = {
        name: name.removeprefix(f"{topic}.")
        for topic in topics
        for name in (*schema.signals, *schema.events, *fields)
        if name.startswith(f"{topic}.")
    }
    for name, column in schema.columns.items():
        leading = [topic for topic in topics if column.startswith(f"{topic}.")]
        own[name] = column.removeprefix(f"{leading[0]}.") if leading else column
    return replace(schema, columns=own, binding=BY_NAME)


def _outages_of(parts: Sequence[File]) -> Iterator[Outage]:
    """The outages of all files; an outage of a whole file concerns the names of that file only."""
    for part in parts:
        for outage in part.outages:
            yield replace(outage, names=part.names) if outage.names is None else outage
