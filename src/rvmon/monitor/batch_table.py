"""Tables in memory judged as they are: arrays, Arrow tables, data frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from rvmon.monitor.compiled import CompiledSpec
from rvmon.readers.gaps import Gaps
from rvmon.trace.schema import Schema
from rvmon.verdict.report import Report


def evaluate_table(
    compiled: CompiledSpec,
    schema: Schema,
    columns: Mapping[str, Any],
    time: str,
    gaps: Gaps,
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report | None:
    """Judge a table by its columns.

    Args:
        compiled: the specification.
        schema: its names.
        columns: see `rvmon.readers.tables.columns_by_name`.
        time: the column of seconds; if its name ends in `_ns`, of integer ticks.
        gaps: values that stand for no update.
        only: ids of the requirements; default all.
        engine: `auto`, `c` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.

    Returns:
        `None` if its rows have to be looked at one by one.

    Raises:
        TraceError: there is no time column, or an instant is not finite or out of range.
    """
    from rvmon.monitor.batch import FEW_ROWS, evaluate_plain, in_order
    from rvmon.monitor.batch_file import fillable
    from rvmon.readers.arrays import block_of_table
    from rvmon.readers.blocks import NotPlainError
    from rvmon.readers.columns import time_column

    try:
        block = block_of_table(
            columns, schema, time_column(columns, time), gaps, partial(fillable, compiled, only)
        )
    except NotPlainError:
        return None
    if not in_order(block.times):
        return None
    times, found = block.times, block.columns
    if engine == "c":
        from rvmon.monitor.batch_c import evaluate_c_blocks

        return evaluate_c_blocks(compiled, list(found), [(times, found)], only=only, until=until)
    return evaluate_plain(
        compiled,
        list(found),
        lambda: [(times, found)],
        only=only,
        engine=engine,
        until=until,
        short=len(times) < FEW_ROWS,
    )
