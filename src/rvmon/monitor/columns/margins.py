"""By how much attempts hold or fail along a whole trace in columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rvmon.dataflow.margin_arrays import Steps, Whole, steps_of
from rvmon.dataflow.margin_end import End, Rest
from rvmon.dataflow.margins import INFINITE, base_factor, signed
from rvmon.dataflow.nodes import Sweep
from rvmon.formula.core import Constant, Literal, Sense
from rvmon.monitor.columns.leaves import NotByColumnsError, distance
from rvmon.monitor.columns.reading import Flat
from rvmon.monitor.columns.timeline import Timeline
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.graph import graph_of
from rvmon.plan.planning import plan_of_evaluator
from rvmon.readers.as_blocks import Columns
from rvmon.spec.checked.formula import Compare
from rvmon.spec.checked.specification import CheckedSpec

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]
    Floats = NDArray[np.float64]


class WholeColumns:
    """The columns of a recording, together.

    Args:
        spec: the specification.
        columns: of the recording.
        end: of the trace in ticks; `None`: its last row.

    Attributes:
        times: int64[n] ticks, of the rows.
        columns: by name, of the same length.
        sparse: whether only rows are positions; else all instants are.
        first: the first position.
        last: the last one.
        end: of the trace in ticks.

    Raises:
        NotByColumnsError: there is no row.
    """

    def __init__(self, spec: CheckedSpec, columns: Columns, end: int | None) -> None:
        self.spec = spec
        self.names = frozenset(columns.names)
        blocks = list(columns.read())
        self.times = np.concatenate([block.times for block in blocks])
        if not len(self.times):
            raise NotByColumnsError
        self.columns = {
            name: np.concatenate([block.columns[name] for block in blocks])
            for name in columns.names
        }
        self.sparse = self.spec.gap is None
        last = int(self.times[-1])
        self.end = last if end is None else max(last, end)
        self.first, self.last = int(self.times[0]), last if self.sparse else self.end


class ColumnMargins:
    """The robustness of what a requirement owes along a trace; see `rvmon.dataflow.margin_arrays`.

    Raises:
        NotByColumnsError: something in it is not known, or has to be read sample by sample.
    """

    def __init__(self, trace: WholeColumns, one: CompiledRequirement) -> None:
        if one.requirement.captures or one.requirement.for_each or one.gap not in (None, 1):
            raise NotByColumnsError
        self._trace = trace
        self._plan = one.measured_plan
        leaves = self._leaves()
        low, high = (self._steps(leaves, rest) for rest in (Rest.LEAST, Rest.GREATEST))
        swept = any(isinstance(node, Sweep) and node.future for node in self._plan.nodes)
        self._bounds = low, high, self._steps(leaves, Rest.END) if swept else low

    def _steps(self, leaves: Mapping[int, Steps], rest: Rest) -> Steps:
        trace = self._trace
        end = End(trace.end, trace.last, rest)
        return steps_of(
            self._plan, leaves, Whole(trace.sparse, trace.first, trace.last, trace.end, end)
        )

    def at(self, instants: Numbers) -> Sequence[Floats]:
        """The figures at instants: the least, the greatest, and what is kept up to the end.

        Args:
            instants: int64[n] ticks, none of them before the first row.
        """
        return [steps.at(instants) for steps in self._bounds]

    def _leaves(self) -> Mapping[int, Steps]:
        """What is read of the rows, by place."""
        trace, spec = self._trace, self._trace.spec
        literals = {place: core for place, core in self._plan.leaves if isinstance(core, Literal)}
        graph = graph_of(core.proposition for core in literals.values())
        if any(spec.signals[name].stale_after for name in graph.by_name if name in spec.signals):
            raise NotByColumnsError
        plan = plan_of_evaluator(spec, graph, (*spec.signals, *spec.events), {})
        timeline = Timeline(plan, trace.names, frozenset())
        flats = timeline.take(trace.times, trace.columns).flats
        made = {
            place: self._constant(core)
            for place, core in self._plan.leaves
            if isinstance(core, Constant)
        }
        for place, core in literals.items():
            flat = flats.get(graph.index[core.proposition])
            if flat is None or not (flat.at.known and flat.between.known):
                raise NotByColumnsError
            made[place] = self._read(core, flat)
        return made

    def _constant(self, core: Constant) -> Steps:
        trace = self._trace
        starts = trace.times if trace.sparse else np.array([trace.first])
        return Steps(starts, np.full(len(starts), INFINITE if core.value else -INFINITE))

    def _read(self, core: Literal, flat: Flat) -> Steps:
        """The steps of a leaf whose truth is known at each row, and between rows."""
        trace, leaf = self._trace, core.proposition.leaf
        at, between = (np.where(one.must, INFINITE, -INFINITE) for one in (flat.at, flat.between))
        if isinstance(leaf, Compare) and core.sense is not Sense.KNOWN_FALSE:
            distances = distance(leaf, trace.columns, len(trace.times))
            at = between = signed(leaf.op, distances * base_factor(leaf, trace.spec))
            if np.isnan(at).any():
                raise NotByColumnsError
        if core.sense is not Sense.TRUE:
            at, between = -at, -between
        if trace.sparse or flat.between is flat.at:
            return Steps(trace.times, at)
        behind = np.append(np.diff(trace.times) > 1, trace.times[-1] < trace.end)
        starts = np.concatenate((trace.times, trace.times[behind] + 1))
        order = np.argsort(starts, kind="stable")
        return Steps(starts[order], np.concatenate((at, between[behind]))[order])
