"""The engines that look up tables, note what becomes known, or work out what is owed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rvmon.monitor.compiled.refusal import Refusal, of_automaton, of_network, of_progression, refuse
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked
from rvmon.monitor.engines.rows import judge_rows
from rvmon.monitor.online.monitor import Monitor
from rvmon.readers.source import Source
from rvmon.verdict.report import Report


@dataclass(frozen=True, slots=True)
class Tables:
    """Judges all requirements in one way, step by step.

    Attributes:
        name: of the engine.
        refuses: what it cannot judge.
    """

    name: str
    refuses: Callable[[CompiledRequirement], Refusal | None]

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        chosen = compiled.chosen(asked.only)
        refuse(chosen, self.refuses, f"the engine `{self.name}`")
        monitor = Monitor(compiled, chosen, self.name, asked.settle, asked.sources, asked.keep)
        monitor.judged_by = self.name
        return monitor

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """Of columns the rows that matter, else each sample."""
        return judge_rows(self, compiled, source, asked)


ENGINES = {
    "automaton": Tables("automaton", of_automaton),
    "progression": Tables("progression", of_progression),
    "network": Tables("network", of_network),
}
