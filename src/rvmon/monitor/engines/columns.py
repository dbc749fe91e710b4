"""The engine `columns`: recordings judged by arrays, without a monitor."""

from __future__ import annotations

from dataclasses import replace

from rvmon.monitor.columns.evaluate import ColumnJudge
from rvmon.monitor.columns.leaves import NotByColumnsError
from rvmon.monitor.compiled.refusal import Refusal, no_columns, no_stream, of_columns, refuse
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, Engine
from rvmon.monitor.engines.rows import columns_of
from rvmon.monitor.online.monitor import Monitor
from rvmon.readers.as_blocks import Columns
from rvmon.readers.batch import NotPlainError
from rvmon.readers.source import Source
from rvmon.verdict.report import Report


class ByColumns:
    """Judges whole columns at once."""

    name = "columns"

    def refuses(self, requirement: CompiledRequirement) -> Refusal | None:
        """What is judged row by row."""
        return of_columns(requirement)

    def online(self, compiled: CompiledSpec, asked: Asked) -> Monitor:  # noqa: ARG002
        """Refused: a stream has no columns.

        Raises:
            RvmonError: always.
        """
        raise no_stream(self.name)

    def judge(self, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
        """See `rvmon.monitor.engines.registry.Engine`."""
        refuse(compiled.chosen(asked.only), self.refuses, "the engine `columns`")
        try:
            columns = columns_of(compiled, source, asked)
            return judge_columns(compiled, columns, asked, source.end)
        except (NotPlainError, NotByColumnsError) as error:
            raise no_columns(error) from None


def judge_columns(
    compiled: CompiledSpec,
    columns: Columns,
    asked: Asked,
    end: int | None,
    beside: Engine | None = None,
) -> Report:
    """Judge columns by arrays.

    Args:
        compiled: the specification.
        columns: of a recording.
        asked: what is wanted.
        end: of the trace in ticks; `None`: its last row.
        beside: judges the rows of what arrays do not judge.

    Raises:
        NotByColumnsError: nothing of it can be judged so, or something of it turns out not to be.
        NotPlainError: the columns turn out to be none.
    """
    chosen = compiled.chosen(asked.only)
    ids = [one.requirement.id for one in chosen]
    own = frozenset(one.requirement.id for one in chosen if of_columns(one) is None)
    if not own:
        raise NotByColumnsError("no requirement is judged by arrays")
    arrays = ColumnJudge(compiled, ids, own, frozenset(columns.names))
    rest = tuple(name for name in ids if name not in own)
    rows = None
    if rest and beside is not None:
        from rvmon.monitor.engines.row_judge import RowJudge

        rows = RowJudge(compiled, beside, columns.names, replace(asked, only=rest))
    for block in columns.read():
        arrays.take(block.times, block.columns)
        if rows is not None:
            rows.take(block.times, block.columns)
    if not arrays.began:
        raise NotByColumnsError("there is no row")
    others = None if rows is None else rows.report(end)
    engine = "columns" if others is None else f"columns, {others.engine}"
    return replace(arrays.report(end, others), engine=engine)


ENGINES = {"columns": ByColumns()}
