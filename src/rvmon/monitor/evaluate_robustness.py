"""Measures the robustness of finished traces from any source."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import structs

from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.evaluate import Decided, RecordingRun, judge_source, open_trace
from rvmon.monitor.packed_plan import planned_core
from rvmon.monitor.robustness import FIGURES, Key, Margins, Robustness, Stream
from rvmon.recordings.source import Reading, Source
from rvmon.trace.sample import Sample
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.recordings.batch import Batch

_ROWS = 2048
"""Rows measured before their figures are collected, so that these fit the processor's cache."""


def margins_of(
    compiled: CompiledSpec,
    trace: Any,
    reading: Reading,
    *,
    only: Sequence[str] | None = None,
    until: int | None = None,
    streams: bool = True,
) -> Margins:
    """The robustness of all attempts on a trace.

    `trace` and the errors are those of `Spec.evaluate`. `until` is the end of the trace in ticks,
    if it is later than the last sample. `streams`: measure every position, not only attempts.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    source = Source(recording, until)
    run = _Run(compiled, source, only, streams=streams)
    for piece in source.pieces():
        run.take(piece)
    return run.margins()


def judge_and_measure(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, decided: Decided = len
) -> Report:
    """Judge a recording, with the robustness of each attempt; otherwise like `judge_source`.

    The recording is read once: each piece is measured, then judged.
    """
    run = _Run(compiled, source, only, streams=False)

    def shown(pieces: Iterator[Any]) -> Iterator[Any]:
        for piece in source.shown(pieces):
            # Before the yield: after the last piece nobody may resume this generator.
            _take_to_end(run, source, piece)
            yield piece

    report = judge_source(compiled, structs.replace(source, shown=shown), only, decided)
    margins = run.margins()
    return replace(report, attempts=tuple(map(margins.of, report.attempts)))


def _take_to_end(run: _Run, source: Source, piece: Batch | Sample) -> None:
    """Measure a piece up to the end of the trace."""
    until = source.until if source.is_cut else None
    if isinstance(piece, Sample):
        if until is None or piece.t <= until:
            run.take(piece)
    else:
        run.take(piece if until is None else piece.up_to(until))


class _Run:
    """A run that measures a recording."""

    def __init__(
        self, compiled: CompiledSpec, source: Source, only: Sequence[str] | None, *, streams: bool
    ) -> None:
        planned = planned_core(compiled, only, measured=True)
        self._run = RecordingRun(compiled.checked, planned, source, finds=False)
        self._run.core.measure(FIGURES, streams)
        self._recorded = RecordedMargins(planned.packed.ids)

    def take(self, piece: Batch | Sample) -> None:
        if isinstance(piece, Sample):
            self._run.take(piece)
        else:
            for first in range(0, len(piece.times), _ROWS):
                self._run.take(piece.cut(first, min(first + _ROWS, len(piece.times))))
                self._recorded.add(self._run.core.margins())

    def margins(self) -> Margins:
        self._run.finish()
        self._recorded.add(self._run.core.margins())
        return self._recorded.margins()


_COLUMNS = ("t", "low", "high", "kept")

MARGIN = np.dtype(
    [
        ("t", np.int64),
        *((name, np.float64) for name in _COLUMNS[1:]),
        *(("requirement", np.int32), ("number", np.uint32)),
        *((name, np.uint8) for name in ("in_doubt", "of_position")),
    ],
    align=True,
)
"""`rv_margin` of `core.h`."""


class _Positions:
    """The figures of the positions of a requirement, in pieces with one memory for equal columns.

    Bounds differ only where input is unknown, or the end of the trace is near. Memory that is
    written for the first time is a good part of the cost.
    """

    def __init__(self) -> None:
        self._pieces: list[list[bytearray]] = []

    def add(self, margins: NDArray[Any]) -> None:
        low = margins["low"]
        known = np.array_equal(low, margins["high"]) and np.array_equal(low, margins["kept"])
        names = _COLUMNS[:2] if known else _COLUMNS
        if not self._pieces or len(self._pieces[-1]) != len(names):
            self._pieces.append([bytearray() for _ in names])
        for column, name in zip(self._pieces[-1], names, strict=True):
            column += margins[name].tobytes()

    def stream(self) -> Stream:
        """The figures added so far."""
        pieces = []
        for times, *bounds in self._pieces:
            columns = [np.frombuffer(one, np.float64) for one in bounds]
            pieces.append((np.frombuffer(times, np.int64), *(columns * 3)[:3]))
        return Stream(pieces)


class RecordedMargins:
    """Collects the robustness figures of a run; `ids` are the requirements by number."""

    def __init__(self, ids: Sequence[str]) -> None:
        self._ids = ids
        self._attempts: dict[Key, Robustness] = {}
        self._doubtful: dict[Key, Robustness] = {}
        self._positions: dict[int, _Positions] = {}

    def add(self, figures: bytes) -> None:
        """Add figures, given as the bytes of an array of dtype `MARGIN`."""
        margins = np.frombuffer(figures, MARGIN)
        of_position = margins["of_position"] == 1
        if not of_position.all():
            self._add_attempts(margins[~of_position])
            margins = margins[of_position]
        several = len(self._ids) > 1
        numbers = np.unique(margins["requirement"]).tolist() if several else [0]
        for number in numbers if len(margins) else ():
            of_requirement = margins[margins["requirement"] == number] if several else margins
            self._positions.setdefault(number, _Positions()).add(of_requirement)

    def _add_attempts(self, margins: NDArray[Any]) -> None:
        for _, low, high, kept, requirement, number, in_doubt, _ in margins.tolist():
            figures = self._doubtful if in_doubt else self._attempts
            figures[self._ids[requirement], number] = Robustness(low, high, kept)

    def margins(self) -> Margins:
        """All figures collected."""
        streams = {
            self._ids[number]: position.stream() for number, position in self._positions.items()
        }
        return Margins(self._attempts, self._doubtful, streams)
