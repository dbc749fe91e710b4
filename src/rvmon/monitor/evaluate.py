"""A finished trace judged, whatever holds it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from rvmon.diagnostics.shown import shown_path
from rvmon.monitor.inputs.missing import expect_names
from rvmon.monitor.judge import Asked, judge_source
from rvmon.readers.any_trace import recording_of
from rvmon.readers.columns import TableRecording
from rvmon.readers.reading import Reading
from rvmon.readers.recording import FileRecording
from rvmon.readers.rows import Rows
from rvmon.readers.source import Source
from rvmon.trace.sample import Recording
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.spec.checked.specification import CheckedSpec


def open_trace(
    checked: CheckedSpec, trace: Any, reading: Reading, *, only: Sequence[str] | None
) -> Recording:
    """A trace as a recording that has what is read; it need not be read yet.

    Raises:
        MissingNameError: it is in columns, and lacks a name that a requirement reads.
        TraceError: it cannot be read.
        UnknownNameError: a name that it may lack is not declared.
    """
    ordered = checked.max_delay is None
    recording = recording_of(trace, reading.schema, ordered=ordered, sources=reading.sources)
    if reading.sources is None and isinstance(recording, FileRecording | TableRecording):
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
        reading: how it is read.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    source = Source(recording, until)
    report = judge_source(compiled, source, Asked(None if only is None else tuple(only)))
    rows = getattr(recording, "rows", None)
    health = rows.with_findings(report.health) if isinstance(rows, Rows) else report.health
    if isinstance(recording, FileRecording | TableRecording):
        health = (*health, *recording.stamp_doubts())
    name = shown_path(trace) if isinstance(trace, str | PathLike) else ""
    return replace(report, health=tuple(health), trace=name)
