"""Judges finished traces from any source."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.missing_names import expect_names
from rvmon.monitor.packed_plan import planned_core
from rvmon.monitor.recording_run import judge_recording
from rvmon.monitor.records import with_plan
from rvmon.recordings.joined import Joined
from rvmon.recordings.recording import FileRecording
from rvmon.recordings.rows import Rows
from rvmon.recordings.source import Reading, Source, recording_of
from rvmon.recordings.table_recording import TableRecording
from rvmon.texts import shown_path
from rvmon.trace.sample import Recording
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

if TYPE_CHECKING:
    from rvmon.language.checked.specification import CheckedSpec

Decided = Callable[[Sequence[Attempt]], object]


def judge_source(
    compiled: CompiledSpec, source: Source, only: Sequence[str] | None, decided: Decided = len
) -> Report:
    """Judge a recording: rows of columns together, samples one by one.

    Args:
        compiled: the specification.
        source: the recording.
        only: ids of the requirements; `None`: all.
        decided: called with the attempts decided before an error in the recording.

    Raises:
        RvmonError: a requirement exceeds the limits of the core.
        TraceError: the recording cannot be read.
    """
    planned = planned_core(compiled, only)
    return judge_recording(compiled.checked, planned, source, decided)


def open_trace(
    checked: CheckedSpec, trace: Any, reading: Reading, *, only: Sequence[str] | None
) -> Recording:
    """Open a trace as a recording, and check that it has the names that requirements read.

    Raises:
        MissingNameError: the recording lacks a name that a requirement reads.
        TraceError: the recording cannot be read.
        UnknownNameError: a name that it may lack is not declared.
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

    Args:
        compiled: the specification.
        trace: as `Spec.evaluate` takes it; so are the errors.
        reading: the options for reading it.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.
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
    """Judge a trace for another process; see `evaluate_trace` and `with_plan`."""
    return with_plan(evaluate_trace(compiled, trace, **options), None)
