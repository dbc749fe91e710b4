"""Recordings on disk judged by their columns, a block at a time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rvmon.monitor.batch import evaluate_plain
from rvmon.monitor.codegen_support import can_feed, plan_requirements
from rvmon.monitor.compiled import ALL_ENGINES, CompiledSpec, expect_engine
from rvmon.readers.block_readers import reader_of
from rvmon.readers.blocks import NotPlainError
from rvmon.trace.schema import Schema
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    _Block = tuple[NDArray[np.int64], Mapping[str, NDArray[Any]]]


def fillable(compiled: CompiledSpec, only: Sequence[str] | None) -> frozenset[str]:
    """The names of which only the present value matters, not whether there was an update."""
    spec = compiled.checked
    chosen = [one for name, one in compiled.requirements.items() if only is None or name in only]
    if not all(map(can_feed, chosen)):
        return frozenset()
    uses = plan_requirements(compiled, chosen).uses
    counted = {name for name, use in uses.items() if use.marked or use.history}
    stale = {name for name, signal in spec.signals.items() if signal.stale_after is not None}
    return frozenset({*spec.signals, *spec.events} - counted - stale)


def evaluate_file(
    compiled: CompiledSpec,
    schema: Schema,
    path: str | Path,
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None = None,
    cut: bool = False,
    ignored: Counter[str],
) -> Report | None:
    """Judge a recording by its columns; memory does not grow with its length.

    Args:
        compiled: the specification.
        schema: its names.
        path: of the recording.
        only: ids of the requirements; default all.
        engine: `auto`, `c` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.
        cut: whether rows behind that end are left out.
        ignored: names that are not declared are counted here, where each line has its own.

    Returns:
        `None` where rows have to be read and judged one by one: the file is not plain, or each row
        may matter.

    Raises:
        UnknownNameError: there is no such engine.
    """
    expect_engine(engine, ALL_ENGINES)
    seen = Counter[str]()
    reader = reader_of(path, schema, seen)
    if reader is None:
        return None
    holding = fillable(compiled, only)

    def read() -> Iterator[_Block]:
        found = ((block.times, block.columns) for block in reader(path, schema, holding))
        return found if until is None or not cut else _up_to(until, found)

    try:
        begun = read()
        first = next(begun)
        names = list(first[1])
        ready = [chain([first], begun)]

        def blocks() -> Iterator[_Block]:
            return ready.pop() if ready else read()

        if engine == "c":
            from rvmon.monitor.batch_c import evaluate_c_blocks

            report = evaluate_c_blocks(compiled, names, blocks(), only=only, until=until)
        else:
            found = evaluate_plain(compiled, names, blocks, only=only, engine=engine, until=until)
            if found is None:
                return None
            report = found
    except (NotPlainError, StopIteration):
        return None
    if seen and cut and until is not None:  # those behind the end were counted, too
        return None
    ignored.update(seen)
    return report


def _up_to(end: int, blocks: Iterator[_Block]) -> Iterator[_Block]:
    """The rows up to an instant."""
    for times, columns in blocks:
        rows = int(times.searchsorted(end, "right"))
        yield times[:rows], {name: column[:rows] for name, column in columns.items()}
        if rows < len(times):
            return
