"""What a monitor was asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec


@dataclass(frozen=True, slots=True)
class Options:
    """What a monitor was asked for; see `rvmon.monitor.build.build_monitor`."""

    compiled: CompiledSpec
    requirements: Sequence[CompiledRequirement]
    engine: str
    settle: str
    sources: frozenset[str] | None
    keep: int | None
