"""Whole recordings in columns: only the rows that can change something are judged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np

from rvmon.codegen.plan import Plan
from rvmon.dataflow.leaves import reads
from rvmon.formula.state import Leaf
from rvmon.monitor.build import build_monitor
from rvmon.monitor.compiled import CompiledSpec
from rvmon.monitor.generated import can_generate, plan_requirements
from rvmon.readers.ticks import ticks_of_column
from rvmon.spec.checked import (
    Arithmetic,
    Captured,
    CheckedSpec,
    Compare,
    CompareOp,
    FieldValue,
    Literal,
    Numeric,
    NumericOp,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    TimeModel,
    UpdateValue,
)
from rvmon.trace.health import Health, HealthKind
from rvmon.trace.schema import Kind
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 17
"""Rows that are looked at together: temporary arrays do not grow with the recording."""

Columns = Mapping[str, "NDArray[Any]"]

_COMPARE = {
    CompareOp.LT: np.less,
    CompareOp.LE: np.less_equal,
    CompareOp.EQ: np.equal,
    CompareOp.NE: np.not_equal,
    CompareOp.GE: np.greater_equal,
    CompareOp.GT: np.greater,
}

_ARITHMETIC = {
    NumericOp.ADD: np.add,
    NumericOp.SUB: np.subtract,
    NumericOp.MUL: np.multiply,
    NumericOp.DIV: np.divide,
    NumericOp.NEG: np.negative,
    NumericOp.ABS: np.abs,
    NumericOp.MIN: np.minimum,
    NumericOp.MAX: np.maximum,
    NumericOp.SQRT: np.sqrt,
    NumericOp.HYPOT: np.hypot,
}


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
    return all(can_generate(one) for one in chosen)


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
    unknown: Counter[str] = Counter()
    last = None
    for times, columns in blocks:
        for start in range(0, len(times), CHUNK):
            stop = min(start + CHUNK, len(times))
            rows = _rows_that_matter(plan, columns, times, start, stop)
            lists = [columns[name][rows].tolist() for name in names]
            for t, *values in zip(times[rows].tolist(), *lists, strict=True):
                step(t, dict(zip(names, values, strict=True)))
            for name, column in columns.items():
                if column.dtype.kind == "f":
                    unknown[name] += int(np.isnan(column[start:stop]).sum())
        last = int(times[-1]) if len(times) else last
    if last is not None and until is not None:
        last = max(last, until)
    return _with_counts(monitor.finish_ns(last), unknown)


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
            known: NDArray[np.int8] = _known(columns[name]).astype(np.int8)
            return known
        case Compare(op=op, left=left, right=right):
            with np.errstate(all="ignore"):
                first, second = _number(left, columns), _number(right, columns)
                if first is None or second is None:
                    return None
                truth: NDArray[np.int8] = np.where(
                    _COMPARE[op](first, second), np.int8(2), np.int8(0)
                )
                truth[~(_known(first) & _known(second))] = 1
                return truth
        case _:
            return None


def _as_python_compares(values: NDArray[Any] | None) -> NDArray[Any] | None:
    """The values in a type in which they compare as Python's own do; `None` if there is none."""
    if values is None or values.dtype == np.float64:
        return values
    if values.dtype.kind == "f":
        return values.astype(np.float64)
    exact = values.dtype.kind == "i" and bool((np.abs(values.astype(np.float64)) < 2**53).all())
    return values.astype(np.int64) if exact else None


def _known(values: Any) -> Any:
    return values == values


def _number(expression: Numeric, columns: Columns) -> Any:
    """The values per row; `None` if they cannot be had from the row alone, exactly."""
    match expression:
        case Literal(value=value):
            return value if not isinstance(value, str) else None
        case SignalValue(name=name):
            return _as_python_compares(columns.get(name))
        case Arithmetic(op=op, args=args):
            values = [_number(arg, columns) for arg in args]
            if any(value is None for value in values):
                return None
            if any(getattr(value, "dtype", np.dtype(float)).kind != "f" for value in values):
                return None  # integers of Python do not overflow
            made = (
                reduce(_ARITHMETIC[op], values) if len(values) > 1 else _ARITHMETIC[op](values[0])
            )
            return np.where(np.isfinite(made), made, np.nan)
        case FieldValue() | Captured() | UpdateValue():
            return None
        case _:
            assert_never(expression)


def _with_counts(report: Report, unknown: Mapping[str, int]) -> Report:
    """The report with all rows counted at which a signal was not known, not only those judged."""

    def counted() -> Iterator[Health]:
        for entry in report.health:
            if entry.kind is HealthKind.NAN and entry.name in unknown:
                yield replace(entry, count=unknown[entry.name])
            else:
                yield entry

    return replace(report, health=tuple(counted()))
