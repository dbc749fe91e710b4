"""Batches: rows stored as columns of values, with an entry per row that says how to read them.

An entry of a signal or payload field is `UNKNOWN`, `YES` (the value counts) or `NO_UPDATE`.
"""

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
    """The recording does not fit into columns and must be read row by row; the message says why."""


class Cells(Struct, frozen=True, dict=True):
    """The cells of a signal or payload field in some rows."""

    # float64[n], int64[n] or bool[n]; for labels int32[n], indices into `labels`. NaN is unknown
    values: NDArray[Any]
    # uint8[n], `UNKNOWN`, `YES` or `NO_UPDATE`; `None`: each row has a value
    states: NDArray[np.uint8] | None = None
    labels: Sequence[str] | None = None  # `None`: the values are no labels

    @property
    def first_given(self) -> int | None:
        """The first row with an update; `None`: there is none. There must be at least one row."""
        if self.states is None:
            return 0
        given = self.states != NO_UPDATE
        return int(given.argmax()) if given.any() else None

    @property
    def last_given(self) -> int | None:
        """The last row with an update; `None`: there is none."""
        count = len(self.values)
        if not count or self.states is None or self.states[-1] != NO_UPDATE:
            return count - 1 if count else None
        given = (self.states != NO_UPDATE).nonzero()[0]
        return int(given[-1]) if len(given) else None

    @property
    def holds_value(self) -> bool:
        """Whether some row has a known value."""
        unknown = self.unknown
        if self.states is None:
            return len(self.values) > 0 if unknown is None else not unknown.all()
        given = self.states != NO_UPDATE
        return bool((given if unknown is None else given & ~unknown).any())

    @cached_property
    def unknown(self) -> NDArray[np.bool_] | None:
        """A mask of the rows with an unknown value, NaN or `UNKNOWN`, bool[n]; `None`: no row."""
        found = None if self.states is None else self.states == UNKNOWN
        if holds_nan(self.values):
            nan = np.isnan(self.values)
            if self.states is not None:
                nan &= self.states == YES
            found = nan if found is None else found | nan
        return found if found is not None and found.any() else None

    def cut(self, start: int, stop: int) -> Cells:
        """The cells of rows `start` to `stop`, without `stop`."""
        states = None if self.states is None else self.states[start:stop]
        return Cells(self.values[start:stop], states, self.labels)

    def spread(self, rows: NDArray[np.intp], count: int) -> Cells:
        """Put the cells at `rows` of `count` rows; the other rows get no update."""
        values = np.zeros(count, self.values.dtype)
        values[rows] = self.values
        return Cells(values, _spread(self.states, rows, count), self.labels)

    def of_rows(self, start: int, stop: int) -> Iterator[Any]:
        """Yield the values of rows as they are in samples; `_NOTHING` where there is no update."""
        values = self.values[start:stop].tolist()
        states = repeat(YES) if self.states is None else self.states[start:stop].tolist()
        for value, state in zip(values, states, strict=False):
            if state == NO_UPDATE:
                yield _NOTHING
            elif state == UNKNOWN:
                yield None
            else:
                yield value if self.labels is None else self.labels[value]


class Occurrences(Struct, frozen=True):
    """The occurrences of an event in some rows."""

    states: NDArray[np.uint8]  # uint8[n], `NO`, `UNKNOWN`, `YES` or `NO_UPDATE`
    # cells of payload fields by name; an occurrence with an update of a field has a payload
    fields: Mapping[str, Cells] = field(default_factory=dict)

    @property
    def with_payload(self) -> NDArray[np.bool_]:
        """A mask of the rows in which the event occurs with a payload, bool[n]."""
        found = np.zeros(len(self.states), np.bool_)
        for cells in self.fields.values():
            found |= np.True_ if cells.states is None else cells.states != NO_UPDATE
        found &= self.states == YES
        return found

    def cut(self, start: int, stop: int) -> Occurrences:
        """The occurrences in rows `start` to `stop`, without `stop`."""
        fields = {name: cells.cut(start, stop) for name, cells in self.fields.items()}
        return Occurrences(self.states[start:stop], fields)

    def spread(self, rows: NDArray[np.intp], count: int) -> Occurrences:
        """Put the occurrences at `rows` of `count` rows; see `Cells.spread`."""
        fields = {name: cells.spread(rows, count) for name, cells in self.fields.items()}
        return Occurrences(_spread(self.states, rows, count), fields)

    @property
    def unknown(self) -> NDArray[np.bool_] | None:
        """A mask of the rows in which the event may have occurred, bool[n]; `None`: no row."""
        return self.states == UNKNOWN if UNKNOWN in self.states.tobytes() else None

    def of_rows(self, start: int, stop: int) -> Iterator[Any]:
        """Yield the values of rows as they are in samples; see `Cells.of_rows`."""
        payloads: list[dict[str, Any]] = [{} for _ in range(start, stop)]
        for name, cells in self.fields.items():
            for payload, value in zip(payloads, cells.of_rows(start, stop), strict=True):
                if value is not _NOTHING:
                    payload[name] = value
        for state, payload in zip(self.states[start:stop].tolist(), payloads, strict=True):
            yield (payload or True) if state == YES else _OF_STATE[state]


_NOTHING = object()

_OF_STATE = {NO: False, UNKNOWN: None, NO_UPDATE: _NOTHING}


class Batch(Struct, frozen=True):
    """Consecutive rows of a recording, stored as columns."""

    times: NDArray[np.int64]  # int64[n] ticks; several rows may have the same instant
    signals: Mapping[str, Cells]  # by name
    events: Mapping[str, Occurrences]  # by name
    first: int = 0  # number of the first row, or of its line
    # int64[n], number of the line of each row; `None`: numbers are consecutive from `first`
    lines: NDArray[np.int64] | None = None
    is_last: bool = False  # whether it is known that no row follows

    def number_of(self, row: int) -> int:
        """The number of a row, or of its line, for a message."""
        return self.first + row if self.lines is None else int(self.lines[row])

    def cut(self, start: int, stop: int) -> Batch:
        """The batch of rows `start` to `stop`, without `stop`."""
        return Batch(
            self.times[start:stop],
            {name: signal.cut(start, stop) for name, signal in self.signals.items()},
            {name: event.cut(start, stop) for name, event in self.events.items()},
            self.first + start,
            None if self.lines is None else self.lines[start:stop],
        )

    def rows(self, start: int, stop: int) -> Iterator[Sample]:
        """Yield rows `start` to `stop`, each as a sample of its own."""
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
        """Yield rows as samples, those of one instant merged; see `coalesce`."""
        rows = self.rows(start, len(self.times) if stop is None else stop)
        return coalesce(rows, self.events, Conflicts())

    def numbered(self) -> Iterator[tuple[int, int, Mapping[str, Value]]]:
        """Yield the number, ticks and values of each row."""
        for row, sample in enumerate(self.rows(0, len(self.times))):
            yield self.number_of(row), sample.t, sample.values

    def without(self, names: Set[str]) -> Batch:
        """The batch without the columns of some names."""
        signals = {name: signal for name, signal in self.signals.items() if name not in names}
        events = {name: event for name, event in self.events.items() if name not in names}
        return replace(self, signals=signals, events=events)

    def up_to(self, until: int | None) -> Batch:
        """The batch of the rows up to an instant (ticks), inclusive; `None`: all rows."""
        if until is None or not len(self.times) or self.times[-1] <= until:
            return self
        return self.cut(0, int(self.times.searchsorted(until, "right")))


def outer_join(batches: Sequence[Batch], first: int) -> Batch | None:
    """Join batches of several sources by time; a source has no update where it has no row.

    `first` is the number of the first joined row.

    Returns:
        The batch; `None` if a name is in two batches or an instant is in one batch twice, as such
        rows must be merged as samples.
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
    states: NDArray[np.uint8] | None, rows: NDArray[np.intp], count: int
) -> NDArray[np.uint8]:
    """Put entries at `rows` of `count` rows, and `NO_UPDATE` in the others."""
    made = np.full(count, NO_UPDATE, np.uint8)
    made[rows] = YES if states is None else states
    return made


def without_ignored(batch: Batch, ignoring: frozenset[str]) -> Batch:
    """Turn NaN and null into "no update" for the signals in `ignoring`."""
    own = {name: batch.signals[name] for name in ignoring & batch.signals.keys()}
    changed = {}
    for name, cells in own.items():
        unknown = cells.unknown
        if unknown is not None:
            states = (
                np.full(len(batch.times), YES, np.uint8) if cells.states is None else cells.states
            )
            changed[name] = replace(cells, states=np.where(unknown, np.uint8(NO_UPDATE), states))
    return replace(batch, signals={**batch.signals, **changed}) if changed else batch


def holds_nan(values: NDArray[Any]) -> bool:
    """Whether some value is NaN."""
    if values.dtype.kind != "f" or not len(values):
        return False
    return isnan(values[values.argmax()])  # `argmax` ranks NaN above all numbers


def note_batch(batch: Batch, rise: bool, alternations: Alternations, conflicts: Conflicts) -> None:
    """Note how unknown values alternate with known ones, and where one instant has two values.

    `rise`: whether it is known that no two rows have the same instant.
    """
    for name, cells in batch.signals.items():
        if not rise:
            _note_conflicts(batch, name, cells, conflicts)
        given = _given(cells) if rise else last_given(batch, cells)
        _note(alternations, name, cells.unknown, given, len(batch.times))
    for name, event in batch.events.items():
        bare = event.states != NO_UPDATE
        for path, cells in event.fields.items():
            given = _given(cells)
            bare &= cells.states == NO_UPDATE if cells.states is not None else np.False_
            _note(alternations, f"{name}.{path}", cells.unknown, given, len(batch.times))
        _note(alternations, name, event.unknown, bare, len(batch.times))


def _note(
    alternations: Alternations,
    name: str,
    unknown: NDArray[np.bool_] | None,
    given: NDArray[Any] | None,
    count: int,
) -> None:
    """Note the known and unknown updates in the rows `given` (a mask, or indices; `None`: all)."""
    if unknown is not None:
        looked_at = unknown if given is None else unknown[given]
        if looked_at.any():
            alternations.by_name[name].add_all(looked_at)
            return
        count = len(looked_at)
    elif given is not None:
        count = int(np.count_nonzero(given)) if given.dtype.kind == "b" else len(given)
    if count:
        alternations.by_name[name].add_known(count)


def _given(cells: Cells) -> NDArray[Any] | None:
    """A mask of the rows with an update, bool[n]; `None`: all."""
    return None if cells.states is None else cells.states != NO_UPDATE


def last_given(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    """The last row with an update at each instant."""
    rows = _rows_given(batch, cells)
    times = batch.times[rows]
    return rows[np.append(times[1:] != times[:-1], True)] if len(rows) else rows


def _note_conflicts(batch: Batch, name: str, cells: Cells, conflicts: Conflicts) -> None:
    """Count neighbouring updates of a signal that differ at the same instant."""
    rows = _rows_given(batch, cells)
    times, values = batch.times[rows], cells.values[rows]
    differs = values[1:] != values[:-1]
    if cells.states is not None:
        # Two unknown values agree, whatever stands in `values`; an unknown and a known one do not.
        none = cells.states[rows] == UNKNOWN
        differs = (differs & ~(none[1:] & none[:-1])) | (none[1:] != none[:-1])
    found = np.flatnonzero((times[1:] == times[:-1]) & differs)
    if len(found):
        conflicts.add(name, int(times[found[0]]), len(found))


def _rows_given(batch: Batch, cells: Cells) -> NDArray[np.intp]:
    if cells.states is None:
        return np.arange(len(batch.times))
    return np.flatnonzero(cells.states != NO_UPDATE)


def unknown_rows(
    batch: Batch, cells: Cells, *, is_signal: bool
) -> Iterator[tuple[bool, NDArray[np.int64]]]:
    """Yield whether values are NaN (else null), and the instants (ticks) of these values.

    Of a signal only the last update at each instant counts, of a payload field every one.
    """
    unknown = cells.unknown
    if unknown is None:
        return
    rows = last_given(batch, cells) if is_signal else _rows_given(batch, cells)
    rows = rows[unknown[rows]]
    for is_nan in (True, False):
        null = np.zeros(len(rows), bool) if cells.states is None else cells.states[rows] == UNKNOWN
        own = batch.times[rows[~null if is_nan else null]]
        if len(own):
            yield is_nan, own
