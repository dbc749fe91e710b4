"""Many finished traces judged, in this process or in several."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache, partial
from typing import Any

from rvmon.children import workers
from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
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
        compiled: the specification; another process compiles it for its first trace.
        traces: for several processes what can be pickled.
        reading: how they are read.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one.
        jobs: processes; 1 judges in this one.
    """
    if jobs < 2:
        for trace in traces:
            yield evaluate_trace(compiled, trace, reading, only=only, engine=engine)
        return
    sent = pickle.dumps((compiled.checked, reading))
    with workers(jobs) as pool:
        yield from pool.map(partial(_evaluate_here, sent, only, engine), traces)


def _evaluate_here(sent: bytes, only: Sequence[str] | None, engine: str, trace: Any) -> Report:
    compiled, reading = _received(sent)
    return evaluate_trace(compiled, trace, reading, only=only, engine=engine)


@lru_cache(maxsize=1)
def _received(sent: bytes) -> tuple[CompiledSpec, Reading]:
    """The specification that another process sent, compiled, and how traces are read."""
    checked, reading = pickle.loads(sent)  # noqa: S301 - from the process that began this one
    return compile_spec(checked), reading
