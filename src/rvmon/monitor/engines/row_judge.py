"""Columns of which only the rows that can change something are judged, as samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.leaves import Columns
from rvmon.monitor.columns.row_changes import rows_that_matter
from rvmon.monitor.compiled.code_plan import plan_requirements
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.engines.registry import Asked, Engine
from rvmon.monitor.inputs.health import HealthLog, by_name
from rvmon.plan.graph import Graph
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
    """

    def __init__(
        self, compiled: CompiledSpec, engine: Engine, names: Sequence[str], asked: Asked
    ) -> None:
        self._chosen = compiled.chosen(asked.only)
        self._names = names
        self._monitor = engine.online(compiled, replace(asked, sources=frozenset(names)))
        self._graph: Graph | None = None
        """Tells which rows matter; `None` if all do."""
        self._spec = compiled.checked
        if compiled.checked.time is not TimeModel.SAMPLED and all(
            one.is_fed for one in self._chosen
        ):
            self._graph = plan_requirements(compiled, self._chosen).graph
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
            if self._graph is not None:
                rows = rows_that_matter(self._graph, self._spec, columns, times, start, stop)
            lists = [columns[name][rows].tolist() for name in names]
            for t, *values in zip(times[rows].tolist(), *lists, strict=True):
                step(t, dict(zip(names, values, strict=True)))
            own = {n: columns[n][start:stop] for n in names if n not in self._spec.ignoring}
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
