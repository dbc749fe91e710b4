"""The lanes of one run: made, fed, and added to as instances and captures need them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.graph import Graph, graph_of
from rvmon.dataflow.inputs import Inputs
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.captured import CapturedAttempt, captured_value
from rvmon.monitor.attempts.instance import Instance, Shape, seen_by, values_in
from rvmon.monitor.attempts.instances import Instances
from rvmon.monitor.attempts.judges import CapturingRule, judge_of
from rvmon.monitor.attempts.keyed import Keyed
from rvmon.monitor.attempts.lane import Lane
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.records.ledger import Ledger
from rvmon.runtime.rule import Rule
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.specification import CheckedSpec, Mode, TimeModel
from rvmon.trace.sample import Scalar, Value

Captured = Mapping[str, Scalar]


class Lanes:
    """All lanes of one run.

    Args:
        spec: gives the names and the time model.
        requirements: to be judged.
        engine: judges them.
        sources: the names that can arrive; `None`: all.
        ledger: takes the records.

    Attributes:
        main: the lane of all requirements without `for each`; its inputs are those of the run.
        instances: the lanes of those with it, an instance each.
        forgets: whether instances are let go of that are over.
    """

    STATE: tuple[str, ...] = ("_history", "all")

    forgets = True

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
        self._by_id = {compiled.requirement.id: compiled for compiled in requirements}
        self.instances = Instances(forgets=self.forgets, is_held=self._has_captured)
        self._history: list[tuple[int, Mapping[str, Value]]] | None = None
        shared = [one for one in requirements if one.requirement.for_each is None]
        roots = [node for compiled in shared for node in compiled.shared_graph.nodes]
        self.main = Lane(self._flow(graph_of(roots), {}))
        for compiled in shared:
            self._seat(self.main, compiled, {}, None)
        self._captured: list[tuple[Lane, Instance | None]] = []
        for compiled in requirements:
            if compiled.requirement.for_each is not None:
                self.instances.keyed[compiled.requirement.id] = self._make_keyed(compiled)
        if any(self._needs_history(compiled) for compiled in requirements):
            self._history = []

    def _has_captured(self, instance: Instance) -> bool:
        return any(one is instance for _, one in self._captured)

    @property
    def _entries(self) -> Iterator[tuple[Lane, Instance | None]]:
        """The lanes there are now, with their instances; those of captured attempts last."""
        yield self.main, None
        yield from self.instances.entries()
        yield from self._captured

    @property
    def all(self) -> Sequence[Lane]:
        """The lanes there are now."""
        return [lane for lane, _ in self._entries]

    @property
    def judges(self) -> Sequence[AttemptJudge]:
        """The judges of all lanes."""
        return [judge for lane in self.all for judge in lane.judges]

    def holders(self) -> Sequence[tuple[str, Rule, Open | None]]:
        """What has open attempts: of which requirement, and the attempt of an episode that runs."""
        return [
            (judge.compiled.requirement.id, judge, judge.running_attempt)
            for lane in self.all
            for judge in lane.judges
        ]

    def take_along(self, t: int) -> None:
        """Take clocks along to `t` that move while attempts loop, as when somebody looks."""
        for judge in [judge for lane in self.all for judge in lane.judges]:
            if judge.slides:
                judge.pass_to(t)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit` in all lanes, also those that are made on the way."""
        self.main.through(limit)
        self.instances.through(limit)
        index = 0
        while index < len(self._captured):
            self._captured[index][0].through(limit)
            index += 1

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, in all lanes."""
        self.main.reach(t)
        self.instances.reach(t)
        for lane, _ in self._captured:
            lane.reach(t)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Give a sample to the lanes that it concerns; time has come to `t − 1` before."""
        for keyed in self.instances.keyed.values():
            self._open_instances(keyed, t, values)
        if self._history is not None:
            self._history.append((t, values))
        captured = tuple(self._captured)
        self.main.sample(t, values)
        self.instances.sample(t, values)
        for lane, instance in captured:
            lane.sample(t, seen_by(instance, values))
        if self._captured:
            self._captured = [entry for entry in self._captured if not entry[0].is_idle]

    def finish(self, end: int, reached: int) -> None:
        """Settle what is undecided; time has come to `end` before.

        Args:
            end: the last instant of the trace.
            reached: the instant that time is known to have come to.
        """
        for judge in self.judges:
            judge.pass_to(end)
        for lane, instance in tuple(self._entries):
            for rule in lane.starters if lane.since < NEVER else ():
                if rule.trigger < 0 and lane.flow.origin is not None:
                    position = lane.stand_at_last(end)
                    # A value that came after the last tick of a clock has not occurred at any.
                    if instance is None or instance.first <= position:
                        rule.begin(position, end)
        for lane in self.all:
            for judge in lane.judges:
                judge.settle_flags()
        for judge in self.judges:
            judge.reach(reached)
            for attempt in judge.attempts:
                self.ledger.ended(judge, attempt, end, reached)

    # Snapshots.

    def shape(self) -> Shape:
        """What instances and captured attempts there are: what `rebuild` makes lanes for."""
        instances = [
            (name, [(one.rank, one.value, one.first) for one in keyed.instances()])
            for name, keyed in self.instances.keyed.items()
        ]
        templates = {keyed.template for keyed in self.instances.keyed.values()}
        lanes = [
            (*self._kind(lane.made_for[0]), dict(lane.made_for[1]), _value(instance), starts)
            for lane, instance in self._entries
            for starts in (bool(lane.starters),)
            if lane.made_for is not None and lane not in templates
        ]
        return instances, lanes

    def _kind(self, compiled: CompiledRequirement) -> tuple[str, str]:
        """The requirement, and which of its judges it is."""
        name = compiled.requirement.id
        found = self._by_id[name].judges
        return name, next(kind for kind, one in found.items() if one is compiled)

    def rebuild(self, shape: Shape) -> None:
        """Make the lanes that another run had; what they hold is to be set afterwards.

        Args:
            shape: of the other run.
        """
        instances, lanes = shape
        for name, found in instances:
            keyed = self.instances.keyed[name]
            source = keyed.each.value
            keyed.take(Instance(rank, source, value, first) for rank, value, first in found)
        for name, kind, captured, value, starts in lanes:
            compiled = self._by_id[name].judges[kind]
            own = self.instances.keyed.get(name)
            instance = None if own is None else own.doubted if value is None else own.known[value]
            graph = compiled.shared_graph if starts else compiled.consequent_graph
            lane = Lane(self._flow(graph, captured), (compiled, captured))
            if starts and own is not None:
                self._seat(lane, compiled, captured, instance)
                self.instances.opened(own, value, lane)
            else:
                self._judge(compiled, lane, captured, instance, started_elsewhere=True)
                parents = (one for one, its in self._entries if one.starters and its is instance)
                parent = next(parents, self.main)
                if compared := self._compared(parent, compiled, captured, instance):
                    compared.follow(lane)
                self._captured.append((lane, instance))

    # Making lanes.

    def _flow(self, graph: Graph, captured: Captured) -> Flow:
        return Flow(graph, Inputs(self.spec, self.sources), self.gap, captured)

    def _judge(
        self,
        compiled: CompiledRequirement,
        lane: Lane,
        captured: Captured,
        instance: Instance | None,
        *,
        started_elsewhere: bool = False,
    ) -> AttemptJudge:
        judge = judge_of(
            compiled,
            self.engine,
            lane.flow,
            self.ledger,
            captured,
            rank=0 if instance is None else instance.rank,
            hidden=compiled is not self._by_id[compiled.requirement.id],
            doubted=_is_doubted(instance),
            started_elsewhere=started_elsewhere,
        )
        lane.add_judge(judge)
        return judge

    def _seat(
        self,
        lane: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> None:
        """Give a requirement triggers in a lane, and judges, unless attempts bring theirs."""
        lane.expect(compiled)
        kinds = [compiled, compiled.hidden]
        if compiled.obligation.trigger is None:
            kinds = [compiled]
        elif compiled.requirement.mode is Mode.UPON and _is_doubted(instance):
            kinds = [compiled.doubted]
        for kind in kinds:
            if kind is not None:
                lane.add_starter(self._starter(lane, kind, captured, instance))

    def _starter(
        self,
        lane: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> Rule:
        if not compiled.requirement.captures:
            return self._judge(compiled, lane, captured, instance)

        def start(t: int, triggered: int) -> None:
            new, own, compared = self._captured_lane(lane, compiled, captured, instance, t)
            new.begin(own, t, triggered)
            self._captured.append((new, instance))
            if compared is not None:
                compared.keeps(t)

        hidden = compiled is not self._by_id[compiled.requirement.id]
        return CapturingRule(compiled, lane.flow, start, hidden=hidden)

    def _compared(
        self,
        parent: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> CapturedAttempt | None:
        """What sees whether the values of an attempt stay known, where that can end."""
        obligation = compiled.obligation
        doubt = obligation.doubt or obligation.trigger
        main = self._by_id[compiled.requirement.id].obligation
        if main.trigger is None or doubt is None or doubt is main.trigger:
            return None  # what it owes, it owes at one position
        index = parent.flow.graph.index
        # Of what has a key that is not known, another may have begun wherever the episode runs.
        place = None if _is_doubted(instance) and obligation.doubt is not None else index[doubt]
        return CapturedAttempt(parent, compiled, captured, index[main.trigger], place)

    def undetermined(self) -> list[str]:
        """The requirements whose trigger was never true or false."""
        determined: set[str] = set()
        for lane in self.all:
            determined.update(lane.determined)
        return [name for name in self._by_id if name not in determined]

    def _captured_lane(
        self,
        parent: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
        t: int,
    ) -> tuple[Lane, AttemptJudge, CapturedAttempt | None]:
        """A lane for one attempt, triggered at `t`, in which its captured values are constants."""
        own = dict(captured)
        for capture in compiled.requirement.captures:
            own[capture.name] = captured_value(capture.value, parent.flow, own)
        compared = self._compared(parent, compiled, own, instance)
        lapses = compared is not None and compared.may_begin_otherwise
        graph = compiled.consequent_graph
        if compiled.looks_back_beyond(parent.flow.graph):
            lane = Lane(self._flow(graph, own), (compiled, own))
            if lapses:
                lane.flow.cut_at(t)
            judge = self._judge(compiled, lane, own, instance, started_elsewhere=True)
            self._replay(lane, instance)
            lane.through(t)
        else:
            lane = Lane(parent.flow.fork(graph, own), (compiled, own))
            if lapses:
                lane.flow.cut_at(t)
            judge = self._judge(compiled, lane, own, instance, started_elsewhere=True)
        if compared is not None:
            compared.follow(lane)
        return lane, judge, compared

    def _replay(self, lane: Lane, instance: Instance | None) -> None:
        """Let a new lane see the samples so far."""
        for t, values in self._history or ():
            lane.through(t - 1)
            lane.sample(t, seen_by(instance, values))

    def _open_instances(self, keyed: Keyed, t: int, values: Mapping[str, Value]) -> None:
        """Make the lanes that a sample asks for."""
        for value in keyed.values_to_open(values):
            instance = keyed.instance(value, t)
            self.instances.opened(keyed, value, self._instance_lane(keyed, instance, t))
        if keyed.template.since == NEVER and None in values_in(keyed.each.value, values):
            keyed.template.open(t)

    def _make_keyed(self, compiled: CompiledRequirement) -> Keyed:
        """A lane for the occurrences whose value is not known; nothing starts in it before one."""
        each = compiled.requirement.for_each
        if each is None:
            raise AssertionError("it has no instances")
        captured = {each.name: None}
        instance = Instance(0, each.value, None, 0)
        lane = Lane(self._flow(compiled.shared_graph, captured), (compiled, captured))
        self._seat(lane, compiled, captured, instance)
        # Without a source, whatever occurs is unknown, from the first position on.
        if self.sources is None or each.value.event in self.sources:
            lane.since = NEVER
        return Keyed(compiled, each, lane, instance, is_timed=self.gap is not None)

    def _instance_lane(self, keyed: Keyed, instance: Instance, t: int) -> Lane:
        """A lane for an instance, as of just before the sample at `t`."""
        compiled, reach = keyed.compiled, keyed.reach
        captured = {keyed.each.name: instance.value}
        if reach.is_fresh:
            flow = keyed.template.flow.twin(captured, reach.varying, reach.own)
            lane = keyed.template.twin(flow, captured)
        else:
            lane = Lane(self._flow(compiled.shared_graph, captured), (compiled, captured))
        self._seat(lane, compiled, captured, instance)
        # No attempt starts before the value has occurred.
        lane.since = NEVER
        if not reach.is_fresh:
            self._replay(lane, instance)
            lane.through(t - 1)
        lane.open(t)
        return lane

    def _needs_history(self, compiled: CompiledRequirement) -> bool:
        """Whether an instance or a captured attempt has to look at what was before it."""
        keyed = self.instances.keyed.get(compiled.requirement.id)
        return (keyed is not None and not keyed.reach.is_fresh) or (
            bool(compiled.requirement.captures)
            and any(
                one.looks_back_beyond(compiled.shared_graph) for one in compiled.judges.values()
            )
        )


def _value(instance: Instance | None) -> Scalar:
    return None if instance is None else instance.value


def _is_doubted(instance: Instance | None) -> bool:
    """Whether it is not known that there is such an instance."""
    return instance is not None and instance.value is None
