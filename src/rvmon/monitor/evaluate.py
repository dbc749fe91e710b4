"""A finished trace judged by the core, whatever holds it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from rvmon.diagnostics.shown import shown_path
from rvmon.monitor.core.planned import planned_core
from rvmon.monitor.inputs.missing import expect_names
from rvmon.readers.columns import TableRecording
from rvmon.readers.joined import Joined
from rvmon.readers.recording import FileRecording
from rvmon.readers.rows import Rows
from rvmon.readers.source import Reading, Source, recording_of
from rvmon.trace.sample import Recording
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.readers.source import Source
    from rvmon.spec.checked.specification import CheckedSpec
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Asked:
    """What is wanted of a recording.

    Attributes:
        only: ids of the requirements; `None`: all.
        decided: called with all attempts that were decided before a fault of the recording.
    """

    only: tuple[str, ...] | None = None
    decided: Callable[[Sequence[Attempt]], object] = len


def judge_source(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """Judge a recording: rows of columns together, samples one by one.

    Args:
        compiled: the specification.
        source: the recording.
        asked: what is wanted.

    Raises:
        RvmonError: a requirement is beyond the core.
        TraceError: the recording cannot be read.
    """
    from rvmon.monitor.core.recording import judge_recording

    planned = planned_core(compiled, asked.only)
    return judge_recording(compiled.checked, planned, source, asked.decided)


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
        reading: how it is read.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last sample.
    """
    recording = open_trace(compiled.checked, trace, reading, only=only)
    source = Source(recording, until)
    report = judge_source(compiled, source, Asked(None if only is None else tuple(only)))
    rows = getattr(recording, "rows", None)
    health = rows.with_findings(report.health) if isinstance(rows, Rows) else report.health
    if isinstance(recording, FileRecording | TableRecording | Joined):
        health = (*health, *recording.stamp_doubts())
    name = shown_path(trace) if isinstance(trace, str | PathLike) else ""
    return replace(report, health=tuple(health), trace=name)
