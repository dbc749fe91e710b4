"""The engine `python`: generated code, and beside it tables for what it refuses."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.monitor.compiled.refusal import MOST_GENERATED, Refusal, of_generated, too_many
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.choice import judged_by
from rvmon.monitor.engines.registry import Asked
from rvmon.monitor.engines.rows import judge_rows
from rvmon.monitor.online.forms import Forms, forms_of
from rvmon.monitor.online.generated import GeneratedMonitor
from rvmon.monitor.online.monitor import Monitor
from rvmon.readers.source import Source
from rvmon.verdict.report import Report


class Python:
    """Generated code judges what it can, and reads samples for the network where it can."""

    name = "python"

    def refuses(self, requirement: CompiledRequirement) -> Refusal | None:
        """What is judged beside it."""
        return of_generated(requirement)

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        chosen = compiled.chosen(asked.only)
        if len(chosen) > MOST_GENERATED:
            refusal = too_many(len(chosen))
            raise refusal.error(chosen[0].requirement.id, "the engine `python`")
        return generated_or_tables(compiled, chosen, self.name, asked)

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """Of columns the rows that matter, else each sample."""
        return judge_rows(self, compiled, source, asked)


def generated_or_tables(
    compiled: CompiledSpec, chosen: Sequence[CompiledRequirement], engine: str, asked: Asked
) -> Monitor:
    """A monitor of generated code where that helps any requirement, else of tables alone."""
    how = (asked.settle, asked.sources, asked.keep)
    if len(chosen) > MOST_GENERATED or not any(one.is_fed for one in chosen):
        monitor = Monitor(compiled, chosen, engine, *how)
    else:
        forms = _forms(compiled, chosen, asked.sources)
        monitor = GeneratedMonitor(forms, compiled, chosen, engine, *how)
    monitor.judged_by = judged_by(chosen)
    return monitor


def _forms(
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
) -> Forms:
    """What is generated for some requirements, made once."""
    key = (tuple(one.requirement.id for one in chosen), sources)
    found = compiled.forms.get(key)
    if not isinstance(found, Forms):
        found = compiled.forms[key] = forms_of(compiled, chosen, sources)
    return found


ENGINES = {"python": Python()}
