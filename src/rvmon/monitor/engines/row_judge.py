"""Columns of which only the rows that can change something are judged, as samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from rvmon.codegen.unit_plan import Plan
from rvmon.dataflow.leaves import reads
from rvmon.formula.state import Leaf, Unborn
from rvmon.monitor.columns.leaves import Columns, NotByColumnsError, compared
from rvmon.monitor.columns.reading import first_known
from rvmon.monitor.compiled.code_plan import plan_requirements
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, Engine
from rvmon.monitor.inputs.health import HealthLog, by_name, holds_nan
from rvmon.spec.checked.formula import Compare, Probe, ProbeAtom, SignalAtom
from rvmon.spec.checked.specification import TimeModel
from rvmon.trace.health import HealthKind
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 1 << 17
"""Rows that are looked at together: temporary arrays do not grow with the recording."""


class RowJudge:
    """Judges requirements by a monitor.

    Rows are passed over in held and clocked time, if generated code can be fed for all of them.

    Args:
        compiled: the specification.
        engine: makes the monitor.
        names: of the columns; declared ones.
        asked: what is wanted.
    """

    def __init__(
        self, compiled: CompiledSpec, engine: Engine, names: Sequence[str], asked: Asked
    ) -> None:
        self._chosen = compiled.chosen(asked.only)
        self._names = names
        self._monitor = engine.online(compiled, replace(asked, sources=frozenset(names)))
        self._plan: Plan | None = None
        """Tells which rows matter; `None` if all do."""
        if compiled.checked.time is not TimeModel.SAMPLED and all(
            one.is_fed for one in self._chosen
        ):
            self._plan = plan_requirements(compiled, self._chosen)
        self._ignoring = compiled.checked.ignoring
        self._unknown = HealthLog()
        self._last: int | None = None

    def take(self, times: NDArray[np.int64], columns: Columns) -> None:
        """Judge rows.

        Args:
            times: int64[n] ticks, later than all before, ascending.
            columns: by name, of the same length: every signal is updated in each row.
        """
        step = self._monitor.step_ns
        names = self._names
        for start in range(0, len(times), CHUNK):
            stop = min(start + CHUNK, len(times))
            rows = np.arange(start, stop)
            if self._plan is not None:
                rows = _rows_that_matter(self._plan, columns, times, start, stop)
            lists = [columns[name][rows].tolist() for name in names]
            for t, *values in zip(times[rows].tolist(), *lists, strict=True):
                step(t, dict(zip(names, values, strict=True)))
            own = {n: columns[n][start:stop] for n in names if n not in self._ignoring}
            self._unknown.count_columns(times[start:stop], own)
            self._last = int(times[stop - 1])

    def report(self, until: int | None) -> Report:
        """End the trace and judge it.

        Args:
            until: its end in ticks, if after its last row.
        """
        end = self._last
        if end is not None and until is not None:
            end = max(end, until)
        report = self._monitor.finish_ns(end)
        # Of the samples at which a signal was not known, only those that matter were judged.
        kept = [entry for entry in report.health if entry.kind is not HealthKind.NAN]
        health = sorted([*kept, *self._unknown.seen(self._chosen)], key=by_name)
        return replace(report, health=self._unknown.alternations.remarked(health))


def _rows_that_matter(
    plan: Plan, columns: Columns, times: NDArray[np.int64], start: int, stop: int
) -> NDArray[np.intp]:
    """The rows of a chunk at which some state formula may change; the row before is looked at."""
    before = max(start - 1, 0)
    matters = np.zeros(stop - before, bool)
    own = {name: column[before:stop] for name, column in columns.items()}
    matters[0] |= start == 0
    if any(holds_nan(own[name]) for name in plan.spec.ignoring & own.keys()):
        # What such a row leaves as it was, the row alone does not say.
        matters[:] = True
    for name in own.keys() & set(plan.signals):
        # A birth may change what is made of a value that stays unknown.
        birth = first_known(own[name])
        if birth < len(matters):
            matters[birth] = True
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
    for column in own.values():
        if column.dtype.kind == "f":
            # From when to when a signal was not known is told, whatever is made of it.
            lost = np.isnan(column)
            matters[1:] |= lost[1:] != lost[:-1]
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
        case Unborn(signals=signals) if not any(moved for _, moved in signals):
            return np.zeros(len(next(iter(columns.values()))), np.int8)
        case Compare():
            try:
                truth = compared(leaf, columns, len(next(iter(columns.values()))))
            except NotByColumnsError:
                return None
            made: NDArray[np.int8] = truth.must.astype(np.int8) + truth.may
            return made
        case _:
            return None
