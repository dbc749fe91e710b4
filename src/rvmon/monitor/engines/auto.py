"""The engine `auto`: for each requirement the fastest that does not refuse it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked
from rvmon.monitor.engines.rows import columns_of, judge_columns_by_rows, judge_samples
from rvmon.readers.batch import NotPlainError
from rvmon.readers.source import Source
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.monitor.compiled.requirement import CompiledRequirement
    from rvmon.monitor.online.monitor import Monitor

FEW_ROWS = 1000
"""So many rows are judged sooner one by one than by arrays."""


class Auto:
    """Judges everything that any engine judges with reasons."""

    name = "auto"

    def refuses(self, requirement: CompiledRequirement) -> None:
        """Nothing."""

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:
        """See `rvmon.monitor.engines.registry.Engine`; so for `judge`."""
        from rvmon.monitor.engines.python import generated_or_tables  # recordings seldom ask

        return generated_or_tables(compiled, compiled.chosen(asked.only), self.name, asked)

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """By arrays, else of columns the rows that matter, else each sample."""
        if source.is_short:  # its samples are judged before NumPy is imported
            return judge_samples(self, compiled, source, asked)
        from rvmon.monitor.columns.leaves import NotByColumnsError
        from rvmon.monitor.engines.columns import judge_columns

        try:
            columns = columns_of(compiled, source, asked)
            try:
                if columns.rows is not None and columns.rows < FEW_ROWS:
                    raise NotByColumnsError("the rows are few")
                return judge_columns(compiled, columns, asked, source.end, beside=self)
            except NotByColumnsError:
                return judge_columns_by_rows(self, compiled, columns, asked, source.end)
        except NotPlainError:
            return judge_samples(self, compiled, source, asked)


ENGINES = {"auto": Auto()}
