"""The engine `c`: recordings judged by compiled C. Records have no reasons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.c_batch import YES, BatchLibrary, Column
from rvmon.codegen.c_columns import columns_of_samples
from rvmon.errors import TimeOrderError
from rvmon.monitor.compiled import CompiledSpec
from rvmon.monitor.generated import plan_alone
from rvmon.trace.sample import Recording
from rvmon.trace.time import format_ticks
from rvmon.verdict.assemble import report_of
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray


def library_of(compiled: CompiledSpec, only: Sequence[str] | None) -> BatchLibrary:
    """The compiled monitor of some requirements; compiled once.

    Raises:
        RvmonError: there is no compiler, or a requirement is beyond generated code.
    """
    key = ("c", None if only is None else tuple(only))
    found = compiled.forms.get(key)
    if not isinstance(found, BatchLibrary):
        found = compiled.forms[key] = BatchLibrary(plan_alone(compiled, only))
    return found


def evaluate_arrays(
    compiled: CompiledSpec,
    columns: Mapping[str, NDArray[Any]],
    times: NDArray[np.int64],
    *,
    only: Sequence[str] | None,
    until: int | None,
) -> Report:
    """Judge columns of truth values and numbers.

    Args:
        compiled: the specification.
        columns: declared names only, of equal length: every signal is updated in each row, an
            event occurs where its column is true; NaN is unknown.
        times: int64[n] ticks.
        only: ids of the requirements; default all.
        until: the end of the trace in ticks, if after its last row.

    Raises:
        TimeOrderError: an instant is not after the one before.
    """
    library = library_of(compiled, only)
    signals = compiled.checked.signals
    made = {}
    for name, column in columns.items():
        if name in signals:
            states = np.full(len(times), YES, np.uint8)
            made[name] = Column(states, np.ascontiguousarray(column, np.float64))
        else:
            made[name] = Column(column.astype(np.uint8) * np.uint8(YES))
    return _judged(library, times, made, frozenset(columns), compiled, only, until)


def evaluate_recording(
    compiled: CompiledSpec, recording: Recording, *, only: Sequence[str] | None, until: int | None
) -> Report:
    """Judge a recording; all of it is in memory at once.

    Raises:
        TimeOrderError: an instant is not after the one before.
        TraceError: an instant has two payloads of one event.
    """
    library = library_of(compiled, only)
    samples = tuple(recording)
    times = np.array([sample.t for sample in samples], np.int64)
    columns = columns_of_samples(samples, library.names)
    end = recording.end if until is None else until
    return _judged(library, times, columns, recording.names, compiled, only, end)


def _judged(
    library: BatchLibrary,
    times: NDArray[np.int64],
    columns: Mapping[str, Column],
    names: frozenset[str] | None,
    compiled: CompiledSpec,
    only: Sequence[str] | None,
    until: int | None,
) -> Report:
    declared = {*compiled.checked.signals, *compiled.checked.events}
    absent = frozenset() if names is None else frozenset(declared - names)
    judged = library.judge(np.ascontiguousarray(times), columns, absent=absent, until=until)
    if judged.rows < len(times):
        raise TimeOrderError(
            f"row {judged.rows} at {format_ticks(int(times[judged.rows]))} is not after the one "
            "before: sort the recording by time"
        )
    ids = [name for name in compiled.requirements if only is None or name in only]
    origin = int(times[0]) if len(times) else 0
    return report_of(ids, judged.attempts, origin=origin, end=judged.end)
