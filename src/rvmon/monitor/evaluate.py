"""Judges finished traces: columns in blocks of rows, all other traces sample by sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.errors import TimeOrderError, TraceError
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.health import Findings, Losses
from rvmon.monitor.intake import Turn, Validator
from rvmon.monitor.missing_names import expect_names
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import give_plan, report_of_run
from rvmon.recordings.batch import NO_UPDATE, YES
from rvmon.recordings.joined import Joined
from rvmon.recordings.recording import FileRecording
from rvmon.recordings.rows import Rows
from rvmon.recordings.source import Reading, Source, recording_of
from rvmon.recordings.table_recording import TableRecording
from rvmon.texts import shown_path
from rvmon.trace.sample import Recording, Sample
from rvmon.trace.schema import Kind
from rvmon.trace.time import TIME_LIMIT, format_ticks, whole_ticks
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.language.checked.specification import CheckedSpec
    from rvmon.recordings.batch import Batch, Cells, Occurrences

_LAYOUTS: Mapping[Kind, int] = {Kind.REAL: 0, Kind.INT: 1, Kind.BOOL: 2, Kind.LABEL: 1}
"""The layout of the values of a column, as numbered in `core.h`."""


Decided = Callable[[Sequence[Attempt]], object]


def judge_source(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, decided: Decided = len
) -> Report:
    """Judge a recording: rows of columns in blocks, samples one by one.

    If the recording has an error, `decided` is called with the attempts decided before it.

    Raises:
        RvmonError: a requirement exceeds the limits of the core.
        TimeOrderError: an instant is before its predecessor.
        TraceError: the recording cannot be read, a name or value is unknown to the specification,
            or an instant has two payloads of an event of which only one can be judged.
    """
    planned = planned_core(compiled, only)
    judge = RecordingRun(compiled.checked, planned, source, finds=True)
    try:
        for piece in source.pieces():
            judge.take(piece)
            if source.taken is not None:
                source.taken(piece, judge.core)
    except TraceError:
        decided(judge.core.flush())
        raise
    return judge.report()


class RecordingRun:
    """A run of the core over the pieces of a recording; `finds`: whether to collect health."""

    def __init__(
        self, checked: CheckedSpec, planned: PlannedCore, source: Source, *, finds: bool
    ) -> None:
        declared = frozenset((*checked.signals, *checked.events))
        names = source.names
        absent = frozenset() if names is None else declared - names
        self._checked = checked
        self._planned = planned
        self._rows = getattr(source.recording, "rows", None)
        self._expected = declared - absent
        self._findings = Findings(planned, absent) if finds else None
        self.core = planned.monitor(absent & planned.numbers.keys())
        self._row = 0
        self._end = source.end
        self._cut = source.until if source.is_cut else None
        self._outages = source.outages
        self._turns = self._turns_of_outages() if self._outages else []

    @cached_property
    def _validator(self) -> Validator:
        """Checks samples that the core does not take as they are; most recordings have none."""
        return Validator(self._checked, self._expected, self._planned.single_payloads)

    @cached_property
    def _losses(self) -> Losses:
        """Tracks outages, of which most recordings have none."""
        return Losses(self._checked, self._planned, self.core, None)

    def _turns_of_outages(self) -> list[Turn]:
        stretches = [
            self._losses.lose(outage.names, outage.since, outage.until, outage.why)
            for outage in self._outages
        ]
        turns = [(_turns_at(turn, stretch[0].t), turn) for stretch in stretches for turn in stretch]
        return [turn for _, turn in sorted(turns, key=lambda pair: pair[0])]

    def take(self, piece: Batch | Sample) -> None:
        """Judge the next piece of the recording."""
        if isinstance(piece, Sample):
            self._take_sample(piece)
        else:
            self._take_batch(piece)

    def _take_sample(self, sample: Sample, batch: Batch | None = None) -> None:
        """Judge a sample that the recording holds, or that was made from rows of `batch`."""
        t = whole_ticks(sample.t)
        values = sample.values
        if self._turns:
            self._lose_until(t)
        if not self.core.judge(t, values, False):
            try:
                values = self._validator.check(t, values)
            except TraceError as error:
                raise TraceError(f"{self._place(t, batch)}{error}") from None
            if not self.core.judge(t, self._planned.plain(t, values), True):
                raise TimeOrderError(
                    f"row {self._row} at {format_ticks(t)} is not after the one before: sort the "
                    "recording by time"
                )
        if self._findings is not None:
            self._findings.note_sample(t, values)
        self._row += 1

    def _place(self, t: int, batch: Batch | None) -> str:
        """Where the sample at `t` is in the recording, if the recording counts its rows."""
        if self._rows is None:
            return ""
        if batch is None:
            return f"{self._rows.place}: "
        first = int(batch.times.searchsorted(t))
        last = int(batch.times.searchsorted(t, "right")) - 1
        return f"{self._rows.place_of(batch.number_of(first), batch.number_of(last))}: "

    def _lose_until(self, t: int) -> None:
        """Apply the turns of outages up to `t`, before the sample at `t`."""
        while self._turns and self._turns[0].t <= t:
            self._losses.turn(self._turns.pop(0))

    def _take_batch(self, batch: Batch) -> None:
        """Judge rows, applying the turns of outages between them."""
        while self._turns and len(batch.times) and self._turns[0].t <= batch.times[-1]:
            turn = self._turns[0].t
            before = int(batch.times.searchsorted(turn))
            self._judge_batch(batch.cut(0, before))
            self._lose_until(turn)
            batch = batch.cut(before, len(batch.times))
        self._judge_batch(batch)

    def _judge_batch(self, batch: Batch) -> None:
        """Judge rows in bulk; a row that the core cannot take goes through the validator."""
        count = len(batch.times)
        done = 0
        while done < count:
            rest = batch.cut(done, count) if done else batch
            columns = self._laid(rest)
            taken = 0 if columns is None else self.core.rows(rest.times, columns)
            if taken and self._findings is not None:
                self._findings.note_batch(rest.cut(0, taken) if taken < len(rest.times) else rest)
            if taken:
                self._row += taken
                done += taken
            if done < count:
                # Only the instant at which the core stopped goes the slow way; all, if there are no
                # columns.
                last = batch.times[done if columns is not None else -1]
                end = int(batch.times.searchsorted(last, "right"))
                for sample in batch.samples(done, end):
                    self._take_sample(sample, batch)
                done = end

    def _laid(self, batch: Batch) -> tuple[Any, ...] | None:
        """Rows as `native.Monitor.rows` takes them; `None` if they must be judged as samples."""
        if not self._expected >= {*batch.signals, *batch.events}:
            return None
        planned = self._planned
        columns: list[tuple[Any, ...]] = []
        try:
            for name, cells in batch.signals.items():
                number = planned.numbers[name]
                kind = planned.packed.signals[name]
                columns.append((number, _cells(cells, kind, planned.words[number])))
            for name, event in batch.events.items():
                states = np.ascontiguousarray(event.states)
                columns.append((planned.numbers[name], states, self._fields(name, event)))
        except KeyError:
            return None
        return tuple(columns)

    def _fields(self, event: str, occurrences: Occurrences) -> tuple[Any, ...] | None:
        """The fields of an event as columns; `None` if it has no column."""
        if not occurrences.fields:
            return None
        columns: list[tuple[Any, ...]] = []
        for place, ((of, field), kind) in enumerate(self._planned.packed.fields.items()):
            if of == event:
                cells = occurrences.fields.get(field)
                words = self._planned.words[len(self._planned.numbers) + place]
                if cells is None:
                    nothing = np.full(len(occurrences.states), NO_UPDATE, np.uint8)
                    columns.append((_LAYOUTS[kind], None, nothing))
                else:
                    columns.append(_cells(cells, kind, words))
        return tuple(columns)

    def finish(self) -> int | None:
        """End the run where the recording ends; returns the last instant of the trace, ticks."""
        # An outage extends the trace to its last instant (SEMANTICS 1, Outage).
        if self._turns:
            self._lose_until(TIME_LIMIT if self._cut is None else self._cut)
        return self.core.finish(self._end)

    def report(self) -> Report:
        """End the run; returns its report."""
        origin, _, _ = self.core.times()
        end = self.finish()
        findings = () if self._findings is None else self._findings.entries(self.core)
        health = (*findings, *(self._losses.health() if self._outages else ()))
        return report_of_run(self._planned, self.core, origin or 0, end, health)


def _turns_at(turn: Turn, since: int) -> tuple[int, int]:
    """Sort key of a turn of an outage that began at `since`.

    At one instant the ends of earlier outages come first, then the starts of outages, then the end
    of an outage of this single instant.
    """
    return turn.t, 1 if turn.lost else 0 if since < turn.t else 2


def _cells(
    cells: Cells, kind: Kind, words: Mapping[str, int] | None
) -> tuple[int, NDArray[Any], NDArray[np.uint8] | None]:
    """Cells as `native.Monitor.rows` takes them.

    Raises:
        KeyError: a cell has a label that is not declared.
    """
    values = cells.values
    if cells.labels is not None and words is not None:
        numbers = np.array([words.get(label, -1) for label in cells.labels], np.int64)
        values = numbers[values]
        if (numbers < 0).any():
            wrong = values < 0 if cells.states is None else (values < 0) & (cells.states == YES)
            if wrong.any():
                raise KeyError
    states = None if cells.states is None else np.ascontiguousarray(cells.states)
    return _LAYOUTS[kind], np.ascontiguousarray(values), states


def open_trace(
    checked: CheckedSpec, trace: Any, reading: Reading, *, only: Sequence[str] | None
) -> Recording:
    """Open a trace as a recording and check that it has the names that requirements read.

    Raises:
        MissingNameError: the recording lacks a name that a requirement reads.
        TraceError: the recording cannot be read.
        UnknownNameError: a name that the recording is allowed to lack is not declared.
    """
    ordered = checked.max_delay is None
    recording = recording_of(trace, reading.schema, ordered=ordered, sources=reading.sources)
    if reading.sources is None and isinstance(recording, FileRecording | TableRecording | Joined):
        mapped = reading.schema.named
        expect_names(checked, recording, mapped, only=only, allowed=reading.allowed)
    return recording


def evaluate_trace(
    compiled: CompiledSpec,
    trace: Any,
    reading: Reading,
    *,
    only: Sequence[str] | None,
    until: int | None = None,
) -> Report:
    """Judge a trace.

    `trace` and the errors are those of `Spec.evaluate`. `until` is the end of the trace in ticks,
    if it is later than the last sample.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    source = Source(recording, until)
    report = judge_source(compiled, source, only)
    rows = getattr(recording, "rows", None)
    health = rows.with_findings(report.health) if isinstance(rows, Rows) else report.health
    if isinstance(recording, FileRecording | TableRecording | Joined):
        health = (*health, *recording.stamp_doubts())
    name = shown_path(trace) if isinstance(trace, str | PathLike) else ""
    return replace(report, health=tuple(health), trace=name)


def evaluate_apart(compiled: CompiledSpec, trace: Any, **options: Any) -> Report:
    """Judge a trace for another process, which sets the plan; see `give_plan`."""
    return give_plan(evaluate_trace(compiled, trace, **options), None)
