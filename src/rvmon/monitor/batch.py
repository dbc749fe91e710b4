"""Whole recordings in columns: judged by arrays, or only the rows that can change something."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.evaluate import ColumnJudge, columns_judge
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError
from rvmon.monitor.compiled import CompiledSpec
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.columns.rows import RowJudge

    Block = tuple[NDArray[np.int64], Columns]

FEW_ROWS = 1000
"""So many rows are judged sooner one by one than by arrays."""

_BY_COLUMNS = ("auto", "python")
"""Engines that leave it open how generated tables are looked up."""

_PIECE = 1 << 17
"""Instants that are compared together."""


def in_order(times: NDArray[np.int64]) -> bool:
    """Whether instants increase strictly; looked at in pieces that stay near the processor."""
    pieces = (times[start : start + _PIECE + 1] for start in range(0, len(times), _PIECE))
    return all(bool((piece[1:] > piece[:-1]).all()) for piece in pieces)


def evaluate_plain(
    compiled: CompiledSpec,
    names: Sequence[str],
    blocks: Callable[[], Iterable[Block]],
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
    short: bool = False,
) -> Report | None:
    """Judge columns by arrays or, where these do not do, the rows that matter as samples.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: gives the blocks as `evaluate_blocks` takes them, from the first on, at each call.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.
        short: whether rows are so few that making arrays of them costs more than it saves.

    Returns:
        `None` if samples may be put in another order.
    """
    if compiled.checked.max_delay is not None:
        return None
    chosen = [name for name in compiled.requirements if only is None or name in only]
    by_arrays = None
    if engine in _BY_COLUMNS and not short:
        by_arrays = columns_judge(compiled, frozenset(chosen), frozenset(names))
    if by_arrays is not None:
        rest = [name for name in chosen if name not in by_arrays.ids]
        by_rows = _row_judge(compiled, names, rest, engine) if rest else None
        try:
            return _judged_by_both(by_arrays, by_rows, blocks(), until)
        except NotByColumnsError:
            pass
    return evaluate_blocks(compiled, names, blocks(), only=chosen, engine=engine, until=until)


def _judged_by_both(
    by_arrays: ColumnJudge, by_rows: RowJudge | None, blocks: Iterable[Block], until: int | None
) -> Report | None:
    """Judge blocks by what judges some requirements and what judges the others."""
    for times, columns in blocks:
        by_arrays.take(times, columns)
        if by_rows is not None:
            by_rows.take(times, columns)
    if not by_arrays.began:
        return None
    return by_arrays.report(until, None if by_rows is None else by_rows.report(until))


def evaluate_blocks(
    compiled: CompiledSpec,
    names: Sequence[str],
    blocks: Iterable[Block],
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report:
    """Judge the rows of columns that matter, as samples.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: instants (int64[n] ticks, strictly increasing throughout) and the columns by name,
            of equal length: every signal is updated in each row.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.
    """
    judge = _row_judge(compiled, names, only, engine)
    for times, columns in blocks:
        judge.take(times, columns)
    return judge.report(until)


def _row_judge(
    compiled: CompiledSpec, names: Sequence[str], only: Sequence[str] | None, engine: str
) -> RowJudge:
    """What judges rows as samples; a monitor is imported for it."""
    from rvmon.monitor.columns.rows import RowJudge

    return RowJudge(compiled, names, only=only, engine=engine)
