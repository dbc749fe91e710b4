"""The truth of state formulas over a whole recording, in spans of ticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.explain.spans import FOREVER, Spans, union
from rvmon.formula.state import FALSE, TRUE, State
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.evaluator_classes import generated
from rvmon.monitor.attempts.instance import Instance, seen_by
from rvmon.plan.graph import graph_of
from rvmon.plan.outages import Outages
from rvmon.plan.planning import uses_of
from rvmon.readers.coalesce import updates_in
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample, Scalar


@dataclass(frozen=True, slots=True)
class Truth:
    """Where a formula is surely true, and where it may be (unknown or true), on all ticks."""

    sure: Spans
    may: Spans


class _Log(Evaluator):
    """An evaluator that remembers when its values changed.

    Attributes:
        history: per node, the instants from which on it had a value, and that value.
    """

    history: Sequence[list[tuple[int, int]]]

    def visit(self, t: int) -> None:
        """See `Evaluator`."""
        first = self.origin is None
        before = list(self.v)
        super().visit(t)
        for place, value in enumerate(self.v):
            if first or value != before[place]:
                self.history[place].append((t, value))


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
    graph = graph_of(roots)
    uses = uses_of([graph], ())
    evaluator = generated(spec, graph, uses, uses, _Log)(Outages(spec, names), captured)
    evaluator.history = [[] for _ in graph.nodes]
    ignoring, read = spec.ignoring, graph.by_name.keys()
    for sample in samples:
        values = {name: sample.values[name] for name in read & sample.values.keys()}
        evaluator.through(sample.t - 1)
        evaluator.sample(sample.t, seen_by(instance, updates_in(values, ignoring)))
    evaluator.through(end)
    found = {}
    for root in roots:
        entries = evaluator.history[graph.index[root]]
        stops = [*(t - 1 for t, _ in entries[1:]), end][: len(entries)]
        spans = [(t, stop, value) for (t, value), stop in zip(entries, stops, strict=True)]
        sure = union((t, stop) for t, stop, value in spans if value == TRUE)
        may = union([*((t, stop) for t, stop, v in spans if v != FALSE), (end + 1, FOREVER)])
        found[root] = Truth(sure, may)
    return found
