"""Recordings judged by the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rvmon.monitor.build import build_monitor
from rvmon.monitor.core.planned import planned_core

if TYPE_CHECKING:
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.readers.source import Source
    from rvmon.verdict.attempt import Attempt
    from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Asked:
    """What is wanted of a recording.

    Attributes:
        only: ids of the requirements; `None`: all.
        decided: called with all attempts that were decided before a fault of the recording; in
            parts as they are decided, where samples are put in order first.
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
    if compiled.checked.max_delay is not None:  # its samples are put in order first
        return _judge_samples(compiled, source, asked)
    from rvmon.monitor.core.recording import judge_recording

    planned = planned_core(compiled, asked.only)
    return judge_recording(compiled.checked, planned, source, asked.decided)


def _judge_samples(compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    spec, names = compiled.checked, source.names
    if names is not None:
        names = names & {*spec.signals, *spec.events}
    monitor = build_monitor(compiled, only=asked.only, sources=names)
    for sample in source.samples(ordered=False):
        asked.decided(monitor.step_ns(sample.t, sample.values))
    return monitor.finish_ns(source.end)
