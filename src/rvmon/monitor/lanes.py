"""The lanes of one run: made, fed, and added to as instances and captures need them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.graph import Graph, graph_of
from rvmon.dataflow.inputs import Inputs, payloads_of
from rvmon.dataflow.numbers import reader
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.instances import seen_by, values_in
from rvmon.monitor.judge import Judge
from rvmon.monitor.lane import Lane, Starter
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.trigger import Trigger
from rvmon.spec.checked import CheckedSpec, FieldValue, Mode, Numeric, TimeModel
from rvmon.trace.sample import Payload, Scalar, Value

Captured = Mapping[str, Scalar]


class Lanes:
    """All lanes of one run.

    Args:
        spec: gives the names and the time model.
        requirements: to be judged.
        engine: judges them.
        sources: the names that can arrive; `None`: all.
        ledger: takes the records.
    """

    def __init__(
        self,
        spec: CheckedSpec,
        requirements: Sequence[CompiledRequirement],
        engine: str,
        sources: frozenset[str] | None,
        ledger: Ledger,
    ) -> None:
        self.spec = spec
        self.engine = engine
        self.sources = sources
        self.ledger = ledger
        self.gap = {TimeModel.HELD: 1, TimeModel.SAMPLED: None}.get(spec.time, spec.period)
        self._each = [r for r in requirements if r.requirement.for_each is not None]
        self._instances: dict[tuple[str, Scalar], int] = {}
        self._history: list[tuple[int, Mapping[str, Value]]] | None = None
        if any(_needs_history(r) for r in requirements):
            self._history = []
        shared = [r for r in requirements if r.requirement.for_each is None]
        roots = [node for r in shared for node in r.shared_graph.nodes]
        self.main = Lane(self._flow(graph_of(roots), {}))
        self._lanes: list[tuple[Lane, FieldValue | None, Scalar]] = [(self.main, None, None)]
        for compiled in shared:
            self._seat(self.main, compiled, {}, 0, None)

    @property
    def all(self) -> Sequence[Lane]:
        """The lanes there are now."""
        return [lane for lane, _, _ in self._lanes]

    def _flow(self, graph: Graph, captured: Captured) -> Flow:
        return Flow(graph, Inputs(self.spec, self.sources), self.gap, captured)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit` in all lanes, also those that are made on the way."""
        index = 0
        while index < len(self._lanes):
            self._lanes[index][0].through(limit)
            index += 1

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, in all lanes."""
        for lane in self.all:
            lane.reach(t)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Give a sample to all lanes; time has come to `t − 1` before."""
        for compiled in self._each:
            self._make_instances(compiled, t, values)
        if self._history is not None:
            self._history.append((t, values))
        for lane, source, own in tuple(self._lanes):
            lane.sample(t, values if source is None else seen_by(source, own, values))

    @property
    def judges(self) -> Sequence[Judge]:
        """The judges of all lanes."""
        return [judge for lane in self.all for judge in lane.judges]

    def finish(self, end: int, reached: int) -> None:
        """Settle what is undecided; time has come to `end` before.

        Args:
            end: the last instant of the trace.
            reached: the instant that time is known to have come to.
        """
        for judge in self.judges:
            judge.pass_to(end)
        for lane in self.all:
            for starter in lane.starters:
                if starter.trigger is None and lane.flow.origin is not None:
                    starter.start(lane.last_position(end), end)
        for judge in self.judges:
            judge.reach(reached)
            for attempt in judge.attempts:
                self.ledger.ended(judge, attempt, end, reached)

    # Making lanes.

    def _seat(
        self,
        lane: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: int,
        source: FieldValue | None,
    ) -> Starter:
        """Give a requirement its trigger in a lane, and its judge unless attempts bring their own."""
        requirement = compiled.requirement
        start: Callable[[int, int], None]
        if requirement.captures:

            def start(t: int, triggered: int) -> None:
                self._start_captured(lane, compiled, captured, instance, source, t, triggered)
        else:
            judge = self._judge(compiled, lane, captured)

            def start(t: int, triggered: int) -> None:
                self.ledger.started(instance, judge, judge.begin(t, triggered))

        formula = compiled.obligation.trigger
        if formula is None:
            starter = Starter(None, -1, start)
        else:
            trigger = Trigger(requirement.pulse, requirement.mode is Mode.WHENEVER)
            starter = Starter(trigger, lane.flow.graph.index[formula], start)
        lane.add_starter(starter)
        return starter

    def _judge(self, compiled: CompiledRequirement, lane: Lane, captured: Captured) -> Judge:
        machine = compiled.machine(self.engine)
        judge = Judge(compiled, machine, lane.flow, self.ledger, captured)
        lane.add_judge(judge)
        return judge

    def _start_captured(
        self,
        parent: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: int,
        source: FieldValue | None,
        t: int,
        triggered: int,
    ) -> None:
        """Give an attempt a lane of its own, in which its captured values are constants."""
        own = dict(captured)
        for capture in compiled.requirement.captures:
            own[capture.name] = _capture(capture.value, parent.flow, own)
        graph = compiled.consequent_graph
        instance_value = None if source is None else captured[_each_name(compiled)]
        if graph.stateful:
            lane = Lane(self._flow(graph, own))
            self._replay(lane, source, instance_value)
            lane.through(t)
        else:
            lane = Lane(parent.flow.fork(graph, own, occurring=True))
        judge = self._judge(compiled, lane, own)
        self.ledger.started(instance, judge, judge.begin(t, triggered))
        self._lanes.append((lane, source, instance_value))

    def _replay(self, lane: Lane, source: FieldValue | None, own: Scalar) -> None:
        """Let a new lane see the samples so far."""
        for t, values in self._history or ():
            lane.through(t - 1)
            lane.sample(t, values if source is None else seen_by(source, own, values))

    def _make_instances(
        self, compiled: CompiledRequirement, t: int, values: Mapping[str, Value]
    ) -> None:
        each = compiled.requirement.for_each
        assert each is not None
        for own in values_in(each.value, values):
            key = (compiled.requirement.id, own)
            if key in self._instances:
                continue
            rank = self._instances[key] = len(self._instances) + 1
            captured = {each.name: own}
            if _needs_history(compiled):
                lane = Lane(self._flow(compiled.shared_graph, captured))
                starter = self._seat(lane, compiled, captured, rank, each.value)
                start, starter.start = starter.start, _never
                self._replay(lane, each.value, own)
                lane.through(t - 1)
                starter.start = start
            else:
                flow = self.main.flow.fork(compiled.shared_graph, captured, occurring=False)
                lane = Lane(flow)
                for taken, waiting in self.main.waiting:
                    lane.sample(taken, seen_by(each.value, own, waiting))
                self._seat(lane, compiled, captured, rank, each.value)
            self._lanes.append((lane, each.value, own))


def _capture(value: Numeric, flow: Flow, captured: Captured) -> Scalar:
    """The value of an expression at the position of a flow; of several payloads, of the last."""
    payloads: dict[str, Payload] = {}
    for event, reports in flow.inputs.occurrences.items():
        found = [payload for report in reports for payload in payloads_of(report)]
        payloads[event] = (found[-1] if found else None) or {}
    return reader(value, flow.inputs, captured)(defaultdict(dict, payloads))


def _needs_history(compiled: CompiledRequirement) -> bool:
    """Whether an instance or a captured attempt has to look at what was before it."""
    requirement = compiled.requirement
    if requirement.captures and compiled.consequent_graph.stateful:
        return True
    remembers = bool(compiled.shared_graph.stateful) or not requirement.pulse
    return requirement.for_each is not None and remembers


def _each_name(compiled: CompiledRequirement) -> str:
    each = compiled.requirement.for_each
    assert each is not None
    return each.name


def _never(t: int, triggered: int) -> None:
    """Start nothing."""
