"""Recordings judged by a monitor: of columns the rows that matter, else each sample."""

from __future__ import annotations

from dataclasses import replace

from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, Engine
from rvmon.readers import as_blocks
from rvmon.readers.as_blocks import Columns
from rvmon.readers.batch import NotPlainError
from rvmon.readers.source import Source
from rvmon.verdict.report import Report


def columns_of(compiled: CompiledSpec, source: Source, asked: Asked) -> Columns:
    """The columns of a recording that are judged as they are.

    Raises:
        NotPlainError: there are none, or samples may be put into another order.
    """
    if compiled.checked.max_delay is not None:
        raise NotPlainError("its samples may come late (`max delay`)")
    return as_blocks.columns_of(source, lambda: fillable(compiled, asked.only))


def fillable(compiled: CompiledSpec, only: tuple[str, ...] | None) -> frozenset[str]:
    """The names of which only the present value matters, not whether there was an update."""
    from rvmon.monitor.compiled.code_plan import plan_requirements

    chosen = compiled.chosen(only)
    if not all(one.is_fed for one in chosen):
        return frozenset()
    return plan_requirements(compiled, chosen).fillable


def judge_rows(engine: Engine, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """Judge a recording by the monitor of an engine."""
    try:
        columns = columns_of(compiled, source, asked)
        return judge_columns_by_rows(engine, compiled, columns, asked, source.end)
    except NotPlainError:
        return judge_samples(engine, compiled, source, asked)


def judge_columns_by_rows(
    engine: Engine, compiled: CompiledSpec, columns: Columns, asked: Asked, end: int | None
) -> Report:
    """The same of columns.

    Raises:
        NotPlainError: they turn out to be none.
    """
    from rvmon.monitor.engines.row_judge import RowJudge

    judge = RowJudge(compiled, engine, columns.names, asked)
    for block in columns.read():
        judge.take(block.times, block.columns)
    return judge.report(end)


def judge_samples(engine: Engine, compiled: CompiledSpec, source: Source, asked: Asked) -> Report:
    """The same of samples, one by one."""
    spec = compiled.checked
    names = source.names
    if names is not None:
        names = names & {*spec.signals, *spec.events}
    monitor = engine.online(compiled, replace(asked, sources=names))
    for sample in source.samples(ordered=spec.max_delay is None):
        asked.decided(monitor.step_ns(sample.t, sample.values))
    return monitor.finish_ns(source.end)
