"""The engine `c`: compiled C, whose records have no reasons."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.monitor.engines.rows import columns_of
from rvmon.readers.blocks import NotPlainError

if TYPE_CHECKING:
    from rvmon.monitor.compiled.refusal import Refusal
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.compiled.specification import CompiledSpec
    from rvmon.monitor.online.monitor import Monitor
    from rvmon.readers.source import Source
    from rvmon.verdict.report import Report


class C:
    """Judges by what a C compiler makes of the requirements; what that needs is imported late."""

    name = "c"

    def refuses(self, requirement: CompiledRequirement) -> Refusal | None:
        """What needs Python beside it."""
        from rvmon.monitor.compiled.refusal import of_c

        return of_c(requirement)

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        chosen = compiled.chosen(asked.only)
        if not chosen:  # nothing to compile
            return engine_named("auto").online(compiled, asked)
        from rvmon.monitor.c.monitor import compiled_monitor
        from rvmon.monitor.compiled.refusal import no_dropping

        if asked.keep is not None:
            raise no_dropping(self.name)
        monitor = compiled_monitor(compiled, chosen, asked.settle, asked.sources)
        monitor.judged_by = self.name
        return monitor

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """By columns, else by samples laid as such."""
        if asked.only == ():
            return engine_named("auto").judge(compiled, source, asked)
        from rvmon.monitor.c.batch import evaluate_columns, evaluate_samples, library_of

        checked, library = compiled.checked, library_of(compiled, asked.only)
        try:
            columns = columns_of(compiled, source, asked)
            report = evaluate_columns(checked, library, columns, source.end)
        except NotPlainError:
            chosen = compiled.chosen(asked.only)
            single = frozenset().union(*(one.single_payloads for one in chosen))
            report = evaluate_samples(checked, library, source, single)
        return replace(report, engine=self.name)


ENGINES = {"c": C()}
