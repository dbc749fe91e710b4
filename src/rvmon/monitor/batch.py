"""Whole recordings in columns: only the rows that can change something are judged."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.codegen.plan import Plan
from rvmon.dataflow.leaves import reads
from rvmon.formula.state import Leaf
from rvmon.monitor.build import build_monitor
from rvmon.monitor.columns.evaluate import evaluate_columns
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError, compared
from rvmon.monitor.compiled import CompiledSpec
from rvmon.monitor.generated import can_feed, plan_requirements
from rvmon.monitor.health import HealthLog, by_name
from rvmon.readers.ticks import ticks_of_column
from rvmon.spec.checked import CheckedSpec, Compare, Probe, ProbeAtom, SignalAtom, TimeModel
from rvmon.trace.health import HealthKind
from rvmon.trace.schema import Kind
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 17
"""Rows that are looked at together: temporary arrays do not grow with the recording."""

_BY_COLUMNS = ("auto", "python")
"""Engines that leave it open how generated tables are looked up."""


def _numeric_columns(table: Any, names: Sequence[str]) -> dict[str, NDArray[Any]] | None:
    """The named columns of a mapping of arrays or of an Arrow table, without copies if possible.

    Args:
        table: columns by name.
        names: those that are wanted; what the table has not is left out.

    Returns:
        Arrays of truth values, integers or floats; `None` if a column is something else.
    """
    found = {}
    for name in names:
        if hasattr(table, "column_names"):
            if name not in table.column_names:
                continue
            column = table.column(name)
            if column.null_count:
                return None
            column = column.to_numpy()
        elif name in table:
            column = table[name]
        else:
            continue
        array = column if isinstance(column, np.ndarray) else None
        if array is None or array.ndim != 1 or array.dtype.kind not in "bif":
            return None
        found[name] = array
    return found


def arrays_of(
    table: Any, spec: CheckedSpec, time: str
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]] | None:
    """Ticks and the declared columns, if all are arrays that fit their declarations.

    Args:
        table: a mapping of arrays, or an Arrow table.
        spec: gives the names and types.
        time: the column of seconds; if its name ends in `_ns`, of integer ticks.

    Returns:
        `None` if something is not so. Whether the instants increase is not looked at.
    """
    columns = _numeric_columns(table, [time, *spec.signals, *spec.events])
    if columns is None or time not in columns:
        return None
    stamps = columns.pop(time)
    if any(len(column) != len(stamps) for column in columns.values()):
        return None
    fits = {Kind.BOOL: "b", Kind.INT: "i", Kind.REAL: "fi"}
    for name, column in columns.items():
        kind = spec.signals[name].type.kind if name in spec.signals else Kind.BOOL
        if column.dtype.kind not in fits.get(kind, ""):
            return None
    if time.endswith("_ns"):
        if stamps.dtype.kind != "i":
            return None
        times = stamps.astype(np.int64, copy=False)
    else:
        times = ticks_of_column(stamps)
    return times, columns


def in_order(times: NDArray[np.int64]) -> bool:
    """Whether instants increase strictly; looked at in pieces that stay near the processor."""
    pieces = (times[start : start + CHUNK + 1] for start in range(0, len(times), CHUNK))
    return all(bool((piece[1:] > piece[:-1]).all()) for piece in pieces)


def can_batch(compiled: CompiledSpec, only: Sequence[str] | None) -> bool:
    """Whether rows that change nothing may be passed over for these requirements."""
    spec = compiled.checked
    chosen = [one for name, one in compiled.requirements.items() if only is None or name in only]
    if spec.time is TimeModel.SAMPLED or spec.max_delay is not None:
        return False
    return all(can_feed(one) for one in chosen)


def evaluate_plain(
    compiled: CompiledSpec,
    names: Sequence[str],
    blocks: Callable[[], Iterable[tuple[NDArray[np.int64], Columns]]],
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report | None:
    """Judge columns by arrays or, where these do not do, the rows of them that matter.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: gives the blocks as `evaluate_blocks` takes them, from the first on, at each call.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.

    Returns:
        `None` if each row has to be judged as a sample.
    """
    if engine in _BY_COLUMNS:
        own = frozenset(names)
        report = evaluate_columns(compiled, own, blocks(), only=only, until=until)
        if report is not None:
            return report
    if not can_batch(compiled, only):
        return None
    return evaluate_blocks(compiled, names, blocks(), only=only, engine=engine, until=until)


def evaluate_blocks(
    compiled: CompiledSpec,
    names: Sequence[str],
    blocks: Iterable[tuple[NDArray[np.int64], Columns]],
    *,
    only: Sequence[str] | None,
    engine: str,
    until: int | None,
) -> Report:
    """Judge columns for which `can_batch` holds.

    Args:
        compiled: the specification.
        names: of the columns; declared ones.
        blocks: instants (int64[n] ticks, strictly increasing throughout) and the columns by name,
            of equal length: every signal is updated in each row.
        only: ids of the requirements; default all.
        engine: `auto` or the name of one that judges samples.
        until: the end of the trace in ticks, if after its last row.
    """
    chosen = [one for name, one in compiled.requirements.items() if only is None or name in only]
    monitor = build_monitor(compiled, only=only, engine=engine, sources=frozenset(names))
    plan = plan_requirements(compiled, chosen)
    step = monitor.step_ns
    unknown = HealthLog()
    last = None
    for times, columns in blocks:
        for start in range(0, len(times), CHUNK):
            stop = min(start + CHUNK, len(times))
            rows = _rows_that_matter(plan, columns, times, start, stop)
            lists = [columns[name][rows].tolist() for name in names]
            for t, *values in zip(times[rows].tolist(), *lists, strict=True):
                step(t, dict(zip(names, values, strict=True)))
            own = {name: column[start:stop] for name, column in columns.items()}
            unknown.count_columns(times[start:stop], own)
        last = int(times[-1]) if len(times) else last
    if last is not None and until is not None:
        last = max(last, until)
    report = monitor.finish_ns(last)
    # Of the samples at which a signal was not known, only those that matter were judged.
    kept = [entry for entry in report.health if entry.kind is not HealthKind.NAN]
    health = sorted([*kept, *unknown.seen(chosen)], key=by_name)
    return replace(report, health=tuple(health))


def _rows_that_matter(
    plan: Plan, columns: Columns, times: NDArray[np.int64], start: int, stop: int
) -> NDArray[np.intp]:
    """The rows of a chunk at which some state formula may change; the row before is looked at."""
    before = max(start - 1, 0)
    matters = np.zeros(stop - before, bool)
    own = {name: column[before:stop] for name, column in columns.items()}
    matters[0] |= start == 0
    for place, own_reads in plan.graph.reads.items():
        leaf = plan.graph.nodes[place].leaf
        if leaf is None or not own_reads.names & own.keys():
            continue
        if own_reads.momentary:
            matters |= _may_occur(leaf, own, plan)
            continue
        truth = _truth(leaf, own)
        if truth is None:
            matters[:] = True
            break
        matters[1:] |= truth[1:] != truth[:-1]
    bounds = [plan.spec.signals[name].stale_after for name in own if name in plan.signals]
    shortest = min((bound for bound in bounds if bound is not None), default=None)
    if shortest is not None:
        matters |= _refreshing(times[before:stop], shortest)
    if before < start:
        matters[0] = False
    return np.flatnonzero(matters) + before


def _refreshing(times: NDArray[np.int64], bound: int) -> NDArray[np.bool_]:
    """Rows without which a signal would seem stale that is not, or fresh that is not.

    The first and the last row of each half of the bound: two of them that follow each other are
    further apart than the bound only if the recording has no row between.
    """
    if bound < 2:
        return np.ones(len(times), bool)
    turns = np.diff(times // (bound // 2)) != 0
    # The last row of a piece is taken, as its first one is: there is no other to compare with.
    return np.concatenate(([True], turns)) | np.concatenate((turns, [True]))


def _may_occur(leaf: Leaf, columns: Columns, plan: Plan) -> NDArray[np.bool_]:
    """The rows at which a leaf that speaks of one position may be true."""
    length = len(next(iter(columns.values())))
    if isinstance(leaf, ProbeAtom) and leaf.probe is not Probe.KNOWN:
        return np.ones(length, bool)
    events = [columns[name] for name in columns if name in plan.events and name in _names(leaf)]
    return reduce(np.logical_or, events, np.zeros(length, bool))


def _names(leaf: Leaf) -> frozenset[str]:
    return reads(leaf).names


def _truth(leaf: Leaf, columns: Columns) -> NDArray[np.int8] | None:
    """0, 1 (unknown) or 2 per row; `None` if the leaf looks at more than the row."""
    match leaf:
        case SignalAtom(name=name):
            return columns[name].astype(np.int8)
        case ProbeAtom(probe=Probe.KNOWN, name=name):
            values = columns[name]
            known: NDArray[np.int8] = (values == values).astype(np.int8)
            return known
        case Compare():
            try:
                truth = compared(leaf, columns, len(next(iter(columns.values()))))
            except NotByColumnsError:
                return None
            made: NDArray[np.int8] = truth.must.astype(np.int8) + truth.may
            return made
        case _:
            return None
