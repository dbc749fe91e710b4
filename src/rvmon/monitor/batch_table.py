"""Tables in memory judged as they are: arrays, Arrow tables, data frames."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rvmon.monitor.compiled import CompiledSpec
from rvmon.readers.columns import TableRecording
from rvmon.trace.schema import Schema
from rvmon.verdict.report import Report


def evaluate_table(
    compiled: CompiledSpec,
    schema: Schema,
    table: TableRecording,
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report | None:
    """Judge a table by its columns.

    Args:
        compiled: the specification.
        schema: its names.
        table: of which the columns are looked at.
        only: ids of the requirements; default all.
        engine: `auto`, `c` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.

    Returns:
        `None` if its rows have to be looked at one by one.

    Raises:
        TraceError: an instant is not finite or out of range.
    """
    from rvmon.monitor.batch import FEW_ROWS, evaluate_plain, in_order
    from rvmon.monitor.batch_file import fillable
    from rvmon.readers.arrays import block_of_table
    from rvmon.readers.blocks import NotPlainError

    try:
        block = block_of_table(table, schema, partial(fillable, compiled, only))
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
