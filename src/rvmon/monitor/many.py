"""Many finished traces judged, in this process or in several."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

from rvmon.execute.parallel import execute
from rvmon.monitor.compiled import CompiledSpec
from rvmon.monitor.finished import evaluate_trace
from rvmon.readers.reading import Reading
from rvmon.verdict.report import Report


def evaluate_traces(
    compiled: CompiledSpec,
    traces: Iterable[Any],
    reading: Reading,
    *,
    only: Sequence[str] | None,
    engine: str,
    jobs: int,
) -> Iterator[Report]:
    """Judge traces; the reports come in their order.

    Args:
        compiled: the specification.
        traces: for several processes what can be pickled.
        reading: how they are read.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one.
        jobs: processes; 1 judges in this one.
    """
    begin = partial(_judge, compiled, reading, only, engine)
    return execute(traces, begin, jobs=jobs, what="trace")


def _judge(
    compiled: CompiledSpec, reading: Reading, only: Sequence[str] | None, engine: str
) -> Callable[[Any], Report]:
    return lambda trace: evaluate_trace(compiled, trace, reading, only=only, engine=engine)
