"""Rows as columns: values, what each row says of them, labels, payloads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cached_property
from itertools import repeat
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace

from rvmon.recordings.coalesce import Alternations, Conflicts, coalesce
from rvmon.trace.sample import Sample, Value

if TYPE_CHECKING:
    from numpy.typing import NDArray


NO, UNKNOWN, YES, NO_UPDATE = 0, 1, 2, 255
"""The entries of a row for an event: it does not occur, unknown, it occurs, no update."""


class NotPlainError(Exception):
    """The recording has to be read row by row; the message says why."""


class Cells(Struct, frozen=True, dict=True):
    """The values of a signal or of a field."""

    # float64[n], int64[n] or bool[n]; of labels int32[n], places in `labels`. NaN is unknown
    values: NDArray[Any]
    # uint8[n], `UNKNOWN`, `YES` or `NO_UPDATE`; `None`: there is a value in each row
    says: NDArray[np.uint8] | None = None
    labels: Sequence[str] | None = None  # the labels by place; `None`: these are no labels

    @property
    def first_said(self) -> int | None:
        """The first row that says something, of which there is one."""
        if self.says is None:
            return 0
        said = self.says != NO_UPDATE
        return int(said.argmax()) if said.any() else None

    @property
    def last_said(self) -> int | None:
        """The last row that says something; `None`: there is none."""
        count = len(self.values)
        if not count or self.says is None or self.says[-1] != NO_UPDATE:
            return count - 1 if count else None
        said = (self.says != NO_UPDATE).nonzero()[0]
        return int(said[-1]) if len(said) else None

    @property
    def holds_value(self) -> bool:
        """Whether some row says what it is."""
        unknown = self.unknown
        if self.says is None:
            return len(self.values) > 0 if unknown is None else not unknown.all()
        said = self.says != NO_UPDATE
        return bool((said if unknown is None else said & ~unknown).any())

    @cached_property
    def unknown(self) -> NDArray[np.bool_] | None:
        """The rows that say that it is unknown, by NaN or otherwise; `None`: there is none."""
        found = None if self.says is None else self.says == UNKNOWN
        if holds_nan(self.values):
            nan = np.isnan(self.values)
            if self.says is not None:
                nan &= self.says == YES
            found = nan if found is None else found | nan
        return found if found is not None and found.any() else None

    def cut(self, start: int, stop: int) -> Cells:
        """Some of the rows."""
        says = None if self.says is None else self.says[start:stop]
        return Cells(self.values[start:stop], says, self.labels)

    def spread(self, rows: NDArray[np.intp], count: int) -> Cells:
        """The same at some of more rows; the others say nothing."""
        values = np.zeros(count, self.values.dtype)
        values[rows] = self.values
        return Cells(values, _spread(self.says, rows, count), self.labels)

    def of_rows(self, start: int, stop: int) -> Iterator[Any]:
        """The values of rows as in samples; `NO_UPDATE` itself where there is none."""
        values = self.values[start:stop].tolist()
        says = repeat(YES) if self.says is None else self.says[start:stop].tolist()
        for value, said in zip(values, says, strict=False):
            if said == NO_UPDATE:
                yield _NOTHING
            elif said == UNKNOWN:
                yield None
            else:
                yield value if self.labels is None else self.labels[value]


class Occurrences(Struct, frozen=True):
    """The occurrences of an event."""

    says: NDArray[np.uint8]  # uint8[n]
    # by name; a row with a value of one has a payload
    fields: Mapping[str, Cells] = field(default_factory=dict)

    @property
    def with_payload(self) -> NDArray[np.bool_]:
        """Whether it comes with a payload, bool[n]."""
        found = np.zeros(len(self.says), np.bool_)
        for cells in self.fields.values():
            found |= np.True_ if cells.says is None else cells.says != NO_UPDATE
        found &= self.says == YES
        return found

    def cut(self, start: int, stop: int) -> Occurrences:
        """Some of the rows."""
        fields = {name: cells.cut(start, stop) for name, cells in self.fields.items()}
        return Occurrences(self.says[start:stop], fields)

    def spread(self, rows: NDArray[np.intp], count: int) -> Occurrences:
        """As `Cells.spread`."""
        fields = {name: cells.spread(rows, count) for name, cells in self.fields.items()}
        return Occurrences(_spread(self.says, rows, count), fields)

    @property
    def unknown(self) -> NDArray[np.bool_] | None:
        """The rows at which it may occur; `None`: there is none."""
        return self.says == UNKNOWN if UNKNOWN in self.says.tobytes() else None

    def of_rows(self, start: int, stop: int) -> Iterator[Any]:
        """As `Cells.of_rows`."""
        payloads: list[dict[str, Any]] = [{} for _ in range(start, stop)]
        for name, cells in self.fields.items():
            for payload, value in zip(payloads, cells.of_rows(start, stop), strict=True):
                if value is not _NOTHING:
                    payload[name] = value
        for said, payload in zip(self.says[start:stop].tolist(), payloads, strict=True):
            yield (payload or True) if said == YES else _SAID[said]


_NOTHING = object()

_SAID = {NO: False, UNKNOWN: None, NO_UPDATE: _NOTHING}


class Batch(Struct, frozen=True):
    """Some rows of a recording."""

    times: NDArray[np.int64]  # int64[n] ticks; there may be several rows of one instant
    signals: Mapping[str, Cells]  # by name
    events: Mapping[str, Occurrences]  # by name
    first: int = 0  # number of the first row, or of its line
    lines: NDArray[np.int64] | None = None  # int64[n], of each row; `None`: they follow each other
    is_last: bool = False  # whether it is known that no row follows

    def number_of(self, row: int) -> int:
        """The number of a row, or of its line."""
        return self.first + row if self.lines is None else int(self.lines[row])

    def cut(self, start: int, stop: int) -> Batch:
        """Some of the rows."""
        return Batch(
            self.times[start:stop],
            {name: signal.cut(start, stop) for name, signal in self.signals.items()},
            {name: event.cut(start, stop) for name, event in self.events.items()},
            self.first + start,
            None if self.lines is None else self.lines[start:stop],
        )

    def rows(self, start: int, stop: int) -> Iterator[Sample]:
        """Some of the rows, one by one."""
        both: Mapping[str, Cells | Occurrences] = {**self.signals, **self.events}
        columns = {name: one.of_rows(start, stop) for name, one in both.items()}
        for t in self.times[start:stop].tolist():
            found: dict[str, Value] = {}
            for name, cells in columns.items():
                value = next(cells)
                if value is not _NOTHING:
                    found[name] = value
            yield Sample(t, found)

    def samples(self, start: int = 0, stop: int | None = None) -> Iterator[Sample]:
        """Rows as samples, those of one instant merged; see `coalesce`."""
        rows = self.rows(start, len(self.times) if stop is None else stop)
        return coalesce(rows, self.events, Conflicts())

    def numbered(self) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
        """Number, ticks and values of each row."""
        for row, sample in enumerate(self.rows(0, len(self.times))):
            yield self.number_of(row), sample.t, sample.values

    def without(self, names: Set[str]) -> Batch:
        """The rows with nothing of some names."""
        signals = {name: signal for name, signal in self.signals.items() if name not in names}
        events = {name: event for name, event in self.events.items() if name not in names}
        return replace(self, signals=signals, events=events)

    def up_to(self, until: int | None) -> Batch:
        """The rows up to an instant (ticks); all of them without one."""
        if until is None or not len(self.times) or self.times[-1] <= until:
            return self
        return self.cut(0, int(self.times.searchsorted(until, "right")))


def outer_join(batches: Sequence[Batch], first: int) -> Batch | None:
    """Rows of several sources by time, each saying nothing where it has no row.

    Returns:
        `None` if a name is in two of them, or an instant twice in one: these are merged as samples.
    """
    names = [name for batch in batches for name in (*batch.signals, *batch.events)]
    is_twice = any((batch.times[1:] == batch.times[:-1]).any() for batch in batches)
    if is_twice or len(names) > len({*names}):
        return None
    times = np.unique(np.concatenate([batch.times for batch in batches]))
    signals: dict[str, Cells] = {}
    events: dict[str, Occurrences] = {}
    for batch in batches:
        rows = times.searchsorted(batch.times)
        signals |= {name: cells.spread(rows, len(times)) for name, cells in batch.signals.items()}
        events |= {name: own.spread(rows, len(times)) for name, own in batch.events.items()}
    return Batch(times, signals, events, first)


def _spread(
    says: NDArray[np.uint8] | None, rows: NDArray[np.intp], count: int
) -> NDArray[np.uint8]:
    """The entries spread over more rows, with `NO_UPDATE` in the others."""
    made = np.full(count, NO_UPDATE, np.uint8)
    made[rows] = YES if says is None else says
    return made


def without_ignored(batch: Batch, ignoring: frozenset[str]) -> Batch:
    """The rows without NaN and null of signals of which these are no update."""
    own = {name: batch.signals[name] for name in ignoring & batch.signals.keys()}
    changed = {}
    for name, cells in own.items():
        unknown = cells.unknown
        if unknown is not None:
            says = np.full(len(batch.times), YES, np.uint8) if cells.says is None else cells.says
            changed[name] = replace(cells, says=np.where(unknown, np.uint8(NO_UPDATE), says))
    return replace(batch, signals={**batch.signals, **changed}) if changed else batch


def holds_nan(values: NDArray[Any]) -> bool:
    """Whether some number is NaN."""
    if values.dtype.kind != "f" or not len(values):
        return False
    return isnan(values[values.argmax()])  # NaN is above all


def note_batch(batch: Batch, rise: bool, alternations: Alternations, conflicts: Conflicts) -> None:
    """Note how unknown values alternate with known ones, and where there are two of one instant.

    `rise`: whether it is known that each row has an instant of its own.
    """
    for name, cells in batch.signals.items():
        if not rise:
            _note_conflicts(batch, name, cells, conflicts)
        said = _said(cells) if rise else last_said(batch, cells)
        _note(alternations, name, cells.unknown, said, len(batch.times))
    for name, event in batch.events.items():
        bare = event.says != NO_UPDATE
        for path, cells in event.fields.items():
            said = _said(cells)
            bare &= cells.says == NO_UPDATE if cells.says is not None else np.False_
            _note(alternations, f"{name}.{path}", cells.unknown, said, len(batch.times))
        _note(alternations, name, event.unknown, bare, len(batch.times))


def _note(
    alternations: Alternations,
    name: str,
    unknown: NDArray[np.bool_] | None,
    said: NDArray[Any] | None,
    count: int,
) -> None:
    """Note what some rows say, of all if `said` is `None`."""
    if unknown is not None:
        looked_at = unknown if said is None else unknown[said]
        if looked_at.any():
            alternations.found[name].add_all(looked_at)
            return
        count = len(looked_at)
    elif said is not None:
        count = int(np.count_nonzero(said)) if said.dtype.kind == "b" else len(said)
    if count:
        alternations.found[name].add_known(count)


def _said(cells: Cells) -> NDArray[Any] | None:
    """Which rows say something; `None`: all."""
    return None if cells.says is None else cells.says != NO_UPDATE


def last_said(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    """The rows that say something, the last of each instant."""
    rows = _rows_said(batch, cells)
    times = batch.times[rows]
    return rows[np.append(times[1:] != times[:-1], True)] if len(rows) else rows


def _note_conflicts(batch: Batch, name: str, cells: Cells, conflicts: Conflicts) -> None:
    """Count where neighbours of one instant say different things of a signal."""
    rows = _rows_said(batch, cells)
    times, values = batch.times[rows], cells.values[rows]
    differs = values[1:] != values[:-1]
    if cells.says is not None:
        none = cells.says[rows] == UNKNOWN
        differs = (differs & ~(none[1:] & none[:-1])) | (none[1:] != none[:-1])
    found = np.flatnonzero((times[1:] == times[:-1]) & differs)
    if len(found):
        conflicts.add(name, int(times[found[0]]), len(found))


def _rows_said(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    if cells.says is None:
        return np.arange(len(batch.times))
    return np.flatnonzero(cells.says != NO_UPDATE)


def unknown_rows(
    batch: Batch, cells: Cells, *, is_signal: bool
) -> Iterator[tuple[bool, NDArray[np.int64]]]:
    """The instants at which NaN (true), or null, is the last that is said of a signal, or field."""
    unknown = cells.unknown
    if unknown is None:
        return
    rows = last_said(batch, cells) if is_signal else _rows_said(batch, cells)
    rows = rows[unknown[rows]]
    for is_nan in (True, False):
        null = np.zeros(len(rows), bool) if cells.says is None else cells.says[rows] == UNKNOWN
        own = batch.times[rows[~null if is_nan else null]]
        if len(own):
            yield is_nan, own
