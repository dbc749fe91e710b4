"""The engine `c`: the core."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rvmon.monitor.engines import rows
from rvmon.monitor.engines.registry import Asked, engine_named

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.monitor.online.monitor import Monitor
    from rvmon.readers.source import Source
    from rvmon.verdict.report import Report


class C:
    """Judges by the core; what that needs is imported late."""

    name = "c"

    def refuses(self, requirement: CompiledRequirement) -> None:
        """Nothing."""

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        if _is_nothing(compiled, asked):
            return engine_named("auto").online(compiled, asked)
        from rvmon.monitor.core.monitor import CoreMonitor
        from rvmon.monitor.core.planned import planned_core

        planned = planned_core(compiled, asked.only)
        monitor = CoreMonitor(planned, compiled, asked.settle, asked.sources, asked.keep)
        monitor.judged_by = self.name
        return monitor

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """All rows of a batch at once, samples one by one."""
        if _is_nothing(compiled, asked):
            return engine_named("auto").judge(compiled, source, asked)
        if compiled.checked.max_delay is not None:  # its samples are put in order first
            return rows.judge_samples(self, compiled, source, asked)
        from rvmon.monitor.core.planned import planned_core
        from rvmon.monitor.core.recording import judge_recording

        planned = planned_core(compiled, asked.only)
        report = judge_recording(compiled.checked, planned, source)
        return replace(report, engine=self.name)


def _is_nothing(compiled: CompiledSpec, asked: Asked) -> bool:
    """Whether there is nothing to judge."""
    return not (compiled.checked.requirements if asked.only is None else asked.only)


ENGINES = {"c": C()}
