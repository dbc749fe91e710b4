"""The engine `python`: generated code, and beside it tables for what it refuses."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.monitor.c.notes import BESIDE, noted
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
        prepared = None
        if (
            engine == "auto"
            and asked.settle == "now"
            and compiled.checked.max_delay is None
            and noted(BESIDE, compiled, chosen)
        ):
            from rvmon.monitor.c.prepared import prepared_beside

            prepared = prepared_beside(compiled, chosen, asked.sources)
        left = asked.left
        if left is None:
            left = frozenset() if prepared is None else prepared.left
        forms = _forms(compiled, chosen, asked.sources, left)
        if prepared is not None and prepared.left == left:
            from rvmon.monitor.c.prepared import lending_monitor

            monitor = lending_monitor(prepared, forms, compiled, chosen, asked.sources, asked.keep)
            apart = () if forms.left is None else forms.left.requirements
            others = judged_by([*apart, *forms.others])
            monitor.judged_by = f"c, {others}" if others else "c"
            return monitor
        monitor = GeneratedMonitor(forms, compiled, chosen, engine, *how)
    monitor.judged_by = judged_by(chosen)
    return monitor


def _forms(
    compiled: CompiledSpec,
    chosen: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
    left: frozenset[str],
) -> Forms:
    """What is generated for some requirements, made once."""
    key = (tuple(one.requirement.id for one in chosen), sources, left)
    found = compiled.forms.get(key)
    if not isinstance(found, Forms):
        found = compiled.forms[key] = forms_of(compiled, chosen, sources, left=left)
    return found


ENGINES = {"python": Python()}
