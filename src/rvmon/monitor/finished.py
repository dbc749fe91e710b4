"""A finished trace judged, whatever holds it: by its columns if possible, else by its samples."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rvmon.monitor.compiled import ALL_ENGINES, CompiledSpec, expect_engine
from rvmon.monitor.missing import expect_names
from rvmon.readers.any_trace import recording_of
from rvmon.readers.columns import TableRecording
from rvmon.readers.reading import Reading
from rvmon.readers.recording import FileRecording
from rvmon.readers.rows import Rows
from rvmon.trace.sample import Recording
from rvmon.verdict.report import Report


def open_trace(
    compiled: CompiledSpec, trace: Any, reading: Reading, *, only: Sequence[str] | None
) -> Recording:
    """A trace as a recording that has what is read; it need not be read yet.

    Args:
        compiled: the specification.
        trace: as `Spec.evaluate` takes it.
        reading: how.
        only: ids of the requirements; default all.

    Raises:
        MissingNameError: it is in columns, and lacks a name that a requirement reads.
        TraceError: it cannot be read.
        UnknownNameError: a name that it may lack is not declared.
    """
    ordered = compiled.checked.max_delay is None
    recording = recording_of(trace, reading.schema, ordered=ordered, sources=reading.sources)
    if reading.sources is None and isinstance(recording, FileRecording | TableRecording):
        mapped = reading.schema.columns
        expect_names(compiled, recording, mapped, only=only, allowed=reading.allowed)
    return recording


def evaluate_trace(
    compiled: CompiledSpec,
    trace: Any,
    reading: Reading,
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None = None,
) -> Report:
    """Judge a trace.

    Args:
        compiled: the specification.
        trace: as `Spec.evaluate` takes it; so are the errors.
        reading: how it is read.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one.
        until: the end of the trace in ticks, if after its last sample.
    """
    expect_engine(engine, ALL_ENGINES)
    if only == () and engine == "c":
        engine = "auto"  # nothing to compile
    recording = open_trace(compiled, trace, reading, only=only)
    report = None
    if reading.sources is None:
        report = _by_columns(compiled, recording, reading, only, engine, until)
    if report is None:
        report = _by_samples(compiled, recording, only, engine, until)
    if isinstance(recording, FileRecording | TableRecording):
        doubts = recording.unit_doubts()
        report = replace(report, health=(*report.health, *doubts)) if doubts else report
    return report


def _by_columns(
    compiled: CompiledSpec,
    recording: Recording,
    reading: Reading,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report | None:
    """The report; `None` if there are no columns, or each row has to be looked at."""
    if isinstance(recording, TableRecording):
        from rvmon.monitor.batch_table import evaluate_table

        return evaluate_table(
            compiled, reading.schema, recording, only=only, engine=engine, until=until
        )
    if isinstance(recording, FileRecording):
        from rvmon.monitor.batch_file import evaluate_file

        return evaluate_file(
            compiled,
            reading.schema,
            recording.path,
            only=only,
            engine=engine,
            until=until,
            ignored=Counter(),
        )
    return None


def _by_samples(
    compiled: CompiledSpec,
    recording: Recording,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report:
    spec = compiled.checked
    names = recording.names
    if names is not None:
        names = frozenset(names) & {*spec.signals, *spec.events}
    end = recording.end if until is None else until
    if engine == "c":
        from rvmon.monitor.batch_c import evaluate_recording

        return evaluate_recording(compiled, recording, sources=names, only=only, until=end)
    from rvmon.monitor.build import build_monitor

    monitor = build_monitor(compiled, only=only, engine=engine, settle="now", sources=names)
    for sample in recording:
        monitor.step_ns(sample.t, sample.values)
    report = monitor.finish_ns(end)
    rows = getattr(recording, "rows", None)
    return replace(report, health=rows.told(report.health)) if isinstance(rows, Rows) else report
