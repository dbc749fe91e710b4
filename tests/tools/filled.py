"""Random cases as columns: every sample updates every signal, as rows of arrays do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.monitor import CompiledSpec
from rvmon.monitor.engines.registry import Asked, engine_named
from rvmon.readers.batch import NO, YES, Batch, Cells, Occurrences
from rvmon.readers.blocks import Block
from rvmon.readers.source import Source
from rvmon.testing.case import Case
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

_BEFORE: dict[Kind, Scalar] = {Kind.BOOL: False, Kind.INT: 0, Kind.REAL: float("nan")}
"""What a signal is until it is known."""


def filled(case: Case) -> Case:
    """The case with whole samples; labels and payloads, which arrays do not hold, never come."""
    spec = case.spec
    arriving = [n for n in (*spec.signals, *spec.events) if case.names is None or n in case.names]
    kinds = {name: spec.signals[name].type.kind for name in arriving if name in spec.signals}
    signals = [name for name, kind in kinds.items() if kind is not Kind.LABEL]
    events = [n for n in arriving if n in spec.events and not spec.events[n].fields]
    now: dict[str, Value] = {name: _BEFORE[kinds[name]] for name in signals}
    samples = []
    for sample in case.samples:
        for name in signals:
            if name in sample.values:
                value = sample.values[name]
                known = value is not None and value == value
                now[name] = value if known else _BEFORE[kinds[name]]
        occurring = {name: sample.values.get(name) is True for name in events}
        samples.append(Sample(sample.t, {**now, **occurring}))
    return replace(case, actions=tuple(samples), names=frozenset((*signals, *events)))


def judge_columns(
    compiled: CompiledSpec, case: Case, engine: str, cuts: Sequence[int] = ()
) -> Report | None:
    """Judge a filled case as `Spec.evaluate` judges arrays.

    Args:
        compiled: the case's specification.
        case: from `filled`.
        engine: the name of one.
        cuts: rows at which a new block of columns begins, in order.

    Returns:
        `None` if the specification, or a trace without samples, is not evaluated by columns.
    """
    names = sorted(case.names or ())
    if not case.samples or compiled.checked.max_delay is not None:
        return None
    types = {Kind.BOOL: np.bool_, Kind.INT: np.int64, Kind.REAL: np.float64}

    def column(name: str) -> NDArray[Any]:
        signal = compiled.checked.signals.get(name)
        kind = Kind.BOOL if signal is None else signal.type.kind
        return np.array([sample.values[name] for sample in case.samples], types[kind])

    times = np.array([sample.t for sample in case.samples], np.int64)
    columns = {name: column(name) for name in names}
    blocks = [
        Block(times[start:stop], {name: column[start:stop] for name, column in columns.items()})
        for start, stop in pairwise((0, *cuts, len(times)))
    ]
    source = Source(BlockRecording(blocks, events=frozenset(compiled.checked.events)), case.end)
    return engine_named(engine).judge(compiled, source, Asked())


@dataclass(frozen=True, slots=True)
class BlockRecording:
    """Blocks in memory as a recording."""

    held_blocks: Sequence[Block]
    end: int | None = None
    events: frozenset[str] = frozenset()

    @property
    def names(self) -> frozenset[str]:
        """The columns."""
        return frozenset(self.held_blocks[0].columns)

    def pieces(self) -> Iterator[Batch | Sample]:
        """See `rvmon.readers.recording.FileRecording.pieces`."""
        for block in self.held_blocks:
            events = {name: block.columns[name] for name in block.columns if name in self.events}
            yield Batch(
                block.times,
                {name: Cells(one) for name, one in block.columns.items() if name not in events},
                {
                    name: Occurrences(np.where(one, np.uint8(YES), np.uint8(NO)))
                    for name, one in events.items()
                },
            )

    def __iter__(self) -> Iterator[Sample]:
        """The rows."""
        for block in self.held_blocks:
            lists = {name: column.tolist() for name, column in block.columns.items()}
            for place, t in enumerate(block.times.tolist()):
                yield Sample(t, {name: cells[place] for name, cells in lists.items()})
