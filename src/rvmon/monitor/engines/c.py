"""The engine `c`: compiled C, whose records have no reasons."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.readers.blocks import NotPlainError

if TYPE_CHECKING:
    from rvmon.monitor.compiled import CompiledRequirement
    from rvmon.monitor.compiled_spec import CompiledSpec
    from rvmon.monitor.engines.refusal import Refusal
    from rvmon.monitor.monitor import Monitor
    from rvmon.readers.source import Source
    from rvmon.verdict.report import Report


class C:
    """Judges by what a C compiler makes of the requirements; what that needs is imported late."""

    name = "c"

    def refuses(self, requirement: CompiledRequirement) -> Refusal | None:
        """What has no automaton, or needs Python beside it."""
        from rvmon.monitor.engines.refusal import of_c

        return of_c(requirement)

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        chosen = compiled.chosen(asked.only)
        if not chosen:  # nothing to compile
            return engine_named("auto").online(compiled, asked)
        from rvmon.monitor.engines.refusal import no_dropping
        from rvmon.monitor.online_c import compiled_monitor

        if asked.keep is not None:
            raise no_dropping(self.name)
        monitor = compiled_monitor(compiled, chosen, asked.settle, asked.sources)
        monitor.judged_by = self.name
        return monitor

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """By a program for one recording alone, else by columns, else by samples laid as such."""
        if asked.only == ():
            return engine_named("auto").judge(compiled, source, asked)
        if source.is_alone:
            from rvmon.monitor.engines.c_alone import judged_by_program

            try:
                return replace(judged_by_program(compiled, source, asked.only), engine=self.name)
            except NotPlainError:
                pass
        from rvmon.monitor.batch_c import evaluate_columns, evaluate_samples

        try:
            report = evaluate_columns(compiled, source, asked)
        except NotPlainError:
            report = evaluate_samples(compiled, source, asked)
        return replace(report, engine=self.name)


ENGINES = {"c": C()}
