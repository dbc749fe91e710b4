"""Conversion of rows of any source to samples: in order, with equal stamps merged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from heapq import heappop, heappush
from itertools import pairwise
from typing import TYPE_CHECKING

from rvmon.errors import TimeOrderError, TraceError
from rvmon.recordings.coalesce import Alternations, Conflicts, merged, updates_in
from rvmon.recordings.csv_text import native_csv
from rvmon.trace.sample import Health, HealthKind, Sample, Value
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.time import TICKS_PER_SECOND, TIME_LIMIT, format_ticks

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch

LOOKED_AT = 1_000  # only this many stamps at the start are examined
FEWEST = 10  # with fewer stamps nothing is reported
LONG_STEP = 5  # from this median step on (seconds), stamps may be milliseconds


def median_step(times: Sequence[float]) -> float:
    """The median of the increasing steps between neighbours; 0 if there are none.

    >>> median_step([0, 1, 1, 3, 6])
    2
    """
    steps = sorted(then - now for now, then in pairwise(times) if then > now)
    return steps[len(steps) // 2] if steps else 0


_LONG = 10_000 * TICKS_PER_SECOND


def doubt_unit(times: Sequence[int], stamps: Stamps) -> list[Health]:
    """Report stamps that are read as seconds but look like milliseconds.

    They look so if their median step is 5 s or more and either all of them are whole seconds or
    the first thousand span 10,000 s or more. A unit that the user has named is not doubted.

    >>> doubt_unit([20 * TICKS_PER_SECOND * k for k in range(10)], Stamps("t", "s"))[0].remark
    'stamps are 20 s apart: are these milliseconds? `--time t:ms` (if not: `--time t:s`)'
    """
    if stamps.is_stated or stamps.unit != "s" or len(times) < FEWEST:
        return []
    step = median_step(times)
    whole = all(t % TICKS_PER_SECOND == 0 for t in times)
    long = len(times) >= LOOKED_AT and times[-1] - times[0] >= _LONG
    if step < LONG_STEP * TICKS_PER_SECOND or not (whole or long):
        return []
    column = stamps.column
    remark = (
        f"stamps are {format_ticks(int(step))} apart: are these milliseconds? "
        f"`--time {column}:ms` (if not: `--time {column}:s`)"
    )
    return [Health(HealthKind.UNIT, column, 1, times[0], remark=remark)]


ROOM = 65_536  # the most rows that are held back to sort in late ones

LEAP = 365 * 86_400 * TICKS_PER_SECOND
"""A year, in ticks. No recording pauses that long, so one of the stamps is from another clock."""

Row = tuple[int, int, Mapping[str, Value]]  # number, ticks, values by name


class Rows:
    """Converts rows to samples and records findings about them.

    Args:
        schema: the declared names.
        unit: the word for a row in errors.
        ordered: whether a stamp before that of the previous row is an error. Under `max delay` rows
            are sorted instead.
    """

    def __init__(self, schema: Schema, unit: str, *, ordered: bool) -> None:
        self._schema = schema
        self._unit = unit
        self.ordered = ordered
        self.until = TIME_LIMIT  # ticks; the findings leave later samples out
        self._reset()

    def samples(self, rows: Iterable[Row]) -> Iterator[Sample]:
        """Yield the samples of a source that is read from its start.

        Raises:
            TimeOrderError: a stamp is before that of the previous row, or a row is late by more
                than `ROOM` rows.
        """
        return self.pieces([rows])  # type: ignore[return-value]  # rows become no batches

    def pieces(self, pieces: Iterable[Batch | Iterable[Row]]) -> Iterator[Batch | Sample]:
        """Yield batches and samples of a source whose rows come partly as batches.

        The rows at the last instant of a batch come out as a sample, because the next piece may
        start with the same instant; only a batch that is known to be the last stays whole.

        Raises:
            TimeOrderError: a stamp is before that of the previous row (rows of a batch are never
                sorted), or a row is late by more than `ROOM` rows.
        """
        from rvmon.recordings.batch import Batch, note_batch, without_ignored

        self._reset()
        # The merged rows of the latest instant; held back, as the next row may have that instant.
        held: Sample | None = None
        first = last = 0  # the numbers of the first and last row in `held`
        for piece in pieces:
            rows: Iterable[Sample]
            if isinstance(piece, Batch):
                whole = without_ignored(piece, self._schema.ignoring)
                batch, rise = self._note_times(whole)
                times, count = batch.times, len(batch.times)
                start = 0 if held is None else int(times.searchsorted(held.t, "right"))
                stop = count
                # Hold back the rows at the last instant: the next piece may start with the same
                # instant.
                if count and not batch.is_last:
                    stop = max(start, int(times.searchsorted(times[-1])))
                for sample in batch.rows(0, start):
                    held = self._merged(held or sample, sample)
                if start:
                    last = batch.number_of(start - 1)
                if start < stop:
                    if held is not None:
                        yield self._take_note(held, first, last)
                        held = None
                    middle = batch.cut(start, stop) if stop - start < count else batch
                    judged = middle.up_to(self.until)
                    note_batch(judged, rise, self.alternations, self._conflicts)
                    yield middle
                rows = self._then_backwards(whole, stop, count)
            else:
                rows = self._in_order(piece)
            for sample in rows:
                if held is None:
                    held, first = sample, self._number
                elif sample.t == held.t:
                    held = self._merged(held, sample)
                else:
                    yield self._take_note(held, first, last)
                    held, first = sample, self._number
                last = self._number
        if held is not None:
            yield self._take_note(held, first, last)

    def _reset(self) -> None:
        self._conflicts, self.alternations = Conflicts(), Alternations()
        # the number of rows read; the most by which one was late, ticks (0 if rows are not sorted)
        self.count = self.lateness = 0
        self.first: list[int] = []  # the instants of the first rows, ticks
        self._last: int | None = None
        self._number = 0
        self._latest_rows = 0, 0
        self._leaps: list[tuple[int, int]] = []

    def _take_note(self, sample: Sample, first: int, last: int) -> Sample:
        if sample.t <= self.until:
            self.alternations.note(sample.values)
        self._latest_rows = first, last
        return sample

    @property
    def place(self) -> str:
        """The rows that made up the latest sample, for a message."""
        return self.place_of(*self._latest_rows)

    def place_of(self, first: int, last: int) -> str:
        """The rows with these numbers, for a message.

        >>> Rows(Schema({}, {}), "line", ordered=True).place_of(3, 3)
        'line 3'
        """
        return f"{self._unit} {first}" if first == last else f"{self._unit}s {first} to {last}"

    def _merged(self, held: Sample, sample: Sample) -> Sample:
        conflicts = self._conflicts if held.t <= self.until else Conflicts()
        return Sample(held.t, merged(held, sample.values, self._schema.events, conflicts))

    def _note_times(self, batch: Batch) -> tuple[Batch, bool]:
        """Take note of instants; give the rows before time goes back, and whether they all differ.

        Raises:
            TimeOrderError: the first row is before the last one of the previous piece.
        """
        times = batch.times
        if not len(times):
            return batch, True
        if self._last is not None and times[0] < self._last:
            raise self._backwards(batch.number_of(0), self._last, int(times[0]))
        rise = native_csv.rise(times)
        if not rise and (back := times[1:] < times[:-1]).any():
            batch = batch.cut(0, int(back.argmax()) + 1)
            times = batch.times
        ends = self._last if self._last is not None else int(times[0]), int(times[-1])
        if ends[1] - ends[0] > LEAP:
            every = [ends[0], *times.tolist()]
            self._leaps += [one for one in pairwise(every) if one[1] - one[0] > LEAP]
        self._last = ends[1]
        self.count += len(times)
        if len(self.first) < LOOKED_AT:
            self.first += times[: LOOKED_AT - len(self.first)].tolist()
        return batch, rise

    def _then_backwards(self, batch: Batch, start: int, stop: int) -> Iterator[Sample]:
        """Yield rows `start` to `stop` of a batch; a row after them is out of order, an error."""
        for row, sample in enumerate(batch.rows(start, stop), start):
            self._number = batch.number_of(row)
            yield sample
        if stop < len(batch.times):
            times = batch.times
            raise self._backwards(batch.number_of(stop), int(times[stop - 1]), int(times[stop]))

    def _backwards(self, number: int, last: int, t: int) -> TimeOrderError:
        return TimeOrderError(
            f"{self._unit} {number}: time goes backwards, from {format_ticks(last)} to "
            f"{format_ticks(t)}: sort the recording by time, or allow for late samples "
            "with `max delay` in the spec"
        )

    def _in_order(self, rows: Iterable[Row]) -> Iterator[Sample]:
        for number, t, values in rows if self.ordered else self._sorted(rows):
            if self._last is not None and not 0 <= t - self._last <= LEAP:
                if t < self._last:
                    raise self._backwards(number, self._last, t)
                self._leaps.append((self._last, t))
            self._last = t
            self._number = number
            self.count += 1
            if len(self.first) < LOOKED_AT:
                self.first.append(t)
            # Before equal stamps are merged, as a value that is no update cannot conflict.
            yield Sample(t, updates_in(values, self._schema.ignoring))

    def _sorted(self, rows: Iterable[Row]) -> Iterator[Row]:
        """Yield rows sorted by time; rows of one instant keep their order."""
        latest = None
        waiting: list[tuple[int, int, Row]] = []
        fault = None
        try:
            for place, row in enumerate(rows):
                number, t, _ = row
                latest = t if latest is None else max(latest, t)
                self.lateness = max(self.lateness, latest - t)
                if self._last is not None and t < self._last:
                    raise TimeOrderError(
                        f"{self._unit} {number}: {format_ticks(t)} comes more than {ROOM:,} "
                        f"{self._unit}s late: sort the recording by time"
                    )
                heappush(waiting, (t, place, row))
                if len(waiting) > ROOM:
                    yield heappop(waiting)[2]
        except TraceError as error:
            fault = error  # raised after the rows that came before it
        while waiting:
            yield heappop(waiting)[2]
        if fault is not None:
            try:
                raise fault
            finally:
                del fault  # its traceback holds this frame, and with it an open file

    def doubts(self) -> list[Health]:
        """The doubts about rows: signals with two values at one stamp, stamps of another clock."""
        found = self._conflicts.health()
        leaps = [(last, t) for last, t in self._leaps if t <= self.until]
        if leaps:
            last, t = leaps[0]
            remark = (
                f"from {format_ticks(last)} to {format_ticks(t)} there are "
                f"{(t - last) / LEAP:.1f} years: is one of them from another clock?"
            )
            found.append(Health(HealthKind.CLOCK, "stamps", len(leaps), t, remark=remark))
        return found

    def with_findings(self, health: Sequence[Health]) -> tuple[Health, ...]:
        """The findings of a monitor about these samples, together with the doubts about rows."""
        return (*self.alternations.remarked(health), *self.doubts())
