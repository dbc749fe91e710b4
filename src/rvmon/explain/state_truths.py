"""The truth of state formulas over a whole recording, in spans of ticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.graph import Graph, graph_of
from rvmon.dataflow.inputs import Inputs
from rvmon.explain.spans import FOREVER, Spans, union
from rvmon.formula.state import FALSE, TRUE, State
from rvmon.monitor.attempts.instance import Instance, seen_by
from rvmon.monitor.attempts.lane import Lane
from rvmon.readers.coalesce import updates_in
from rvmon.spec.checked.specification import CheckedSpec, TimeModel
from rvmon.trace.sample import Sample, Scalar


@dataclass(frozen=True, slots=True)
class Truth:
    """Where a formula is surely true, and where it may be (unknown or true), on all ticks."""

    sure: Spans
    may: Spans


class _Log(Flow):
    """A flow that remembers when its values changed.

    Attributes:
        history: per node, the instants from which on it had a value, and that value.
    """

    def __init__(
        self, graph: Graph, inputs: Inputs, gap: int | None, captured: Mapping[str, Scalar]
    ) -> None:
        super().__init__(graph, inputs, gap, captured)
        self.history: list[list[tuple[int, int]]] = [[] for _ in self.values]

    def evaluate(self, t: int) -> list[int]:
        """See `Flow`."""
        changed = super().evaluate(t)
        begun = any(self.history)
        for place in changed if begun else range(len(self.values)):
            self.history[place].append((t, self.values[place]))
        return changed


def state_truths(
    spec: CheckedSpec,
    roots: Sequence[State],
    samples: Sequence[Sample],
    end: int,
    instance: Instance | None,
    captured: Mapping[str, Scalar],
    names: frozenset[str] | None,
) -> dict[State, Truth]:
    """The truth of state formulas over a recording; behind its end they may be anything.

    Args:
        spec: the specification.
        roots: the formulas.
        samples: the recording, in order.
        end: its last instant, ticks.
        instance: of a `for each`, if the formulas belong to one.
        captured: the values of `let` and `for each`.
        names: the signals and events that have a source; `None`: all.
    """
    gap = {TimeModel.HELD: 1, TimeModel.SAMPLED: None}.get(spec.time, spec.period)
    graph = graph_of(roots)
    flow = _Log(graph, Inputs(_read_by(graph, spec), names), gap, captured)
    lane, ignoring = Lane(flow), spec.ignoring
    read = graph.by_name.keys()
    for sample in samples:
        values = {name: sample.values[name] for name in read & sample.values.keys()}
        lane.through(sample.t - 1)
        lane.sample(sample.t, seen_by(instance, updates_in(values, ignoring)))
    lane.through(end)
    found = {}
    for root in roots:
        entries = flow.history[flow.graph.index[root]]
        stops = [*(t - 1 for t, _ in entries[1:]), end][: len(entries)]
        spans = [(t, stop, value) for (t, value), stop in zip(entries, stops, strict=True)]
        sure = union((t, stop) for t, stop, value in spans if value == TRUE)
        may = union([*((t, stop) for t, stop, v in spans if v != FALSE), (end + 1, FOREVER)])
        found[root] = Truth(sure, may)
    return found


def _read_by(graph: Graph, spec: CheckedSpec) -> CheckedSpec:
    """The specification with no other signals and events than formulas read: there may be many."""
    return replace(
        spec,
        signals={name: spec.signals[name] for name in graph.by_name if name in spec.signals},
        events={name: spec.events[name] for name in graph.by_name if name in spec.events},
    )
