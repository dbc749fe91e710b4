"""Recordings judged by the core."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

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
