"""Columns in memory judged as they are: NumPy arrays and Arrow tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rvmon.monitor.compiled import CompiledSpec
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.readers.tables import Table


def evaluate_table(
    compiled: CompiledSpec,
    table: Table,
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report | None:
    """Judge a table by its columns.

    Args:
        compiled: the specification.
        table: by declared names.
        only: ids of the requirements; default all.
        engine: `auto`, `c` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.

    Returns:
        `None` if its rows have to be looked at one by one.

    Raises:
        TraceError: an instant is not finite or out of range.
    """
    from rvmon.monitor.batch import FEW_ROWS, arrays_of, evaluate_plain, in_order

    arrays = arrays_of(table.columns, compiled.checked, table.time)
    if arrays is None:
        return None
    times, columns = arrays
    if engine == "c":
        from rvmon.monitor.batch_c import evaluate_c_blocks

        return evaluate_c_blocks(
            compiled, list(columns), [(times, columns)], only=only, until=until
        )
    if not in_order(times):
        return None
    return evaluate_plain(
        compiled,
        list(columns),
        lambda: [(times, columns)],
        only=only,
        engine=engine,
        until=until,
        short=len(times) < FEW_ROWS,
    )
