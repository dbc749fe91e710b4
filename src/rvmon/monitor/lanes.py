"""The lanes of one run: made, fed, and added to as instances and captures need them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from rvmon.dataflow.flow import Flow
from rvmon.dataflow.graph import Graph, graph_of
from rvmon.dataflow.inputs import Inputs
from rvmon.monitor.attempt_judge import AttemptJudge, Holder, Open, held_by
from rvmon.monitor.captive import CapturedAttempt, captured_value
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.episode import Episode
from rvmon.monitor.instances import Instance, seen_by, values_in
from rvmon.monitor.judge import Judge
from rvmon.monitor.keyed import Keyed
from rvmon.monitor.lane import Lane, Starter
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.network_judge import NetworkJudge
from rvmon.monitor.roster import Roster
from rvmon.monitor.trigger import Trigger
from rvmon.spec.checked import CheckedSpec, Mode, TimeModel
from rvmon.trace.sample import Scalar, Value

Captured = Mapping[str, Scalar]

Start = Callable[[int, int], None]
"""Starts an attempt; see `rvmon.monitor.lane.Starter`."""

Shape = tuple[
    list[tuple[str, list[tuple[int, Scalar, int]]]],
    list[tuple[str, str, dict[str, Scalar], Scalar, bool]],
    list[str],
    list[int],
]
"""Per requirement its instances: rank, value, first instant; per lane its requirement,
which of its judges it has, captured values, the value of its instance, and whether attempts start
in it; the requirements of which all values were known so far; the rules of generated code that had
a judge of their own."""


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
        roster: the lanes of those with it, an instance each.
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
        self.roster = Roster(forgets=self.forgets, is_held=self._has_captured)
        self._history: list[tuple[int, Mapping[str, Value]]] | None = None
        shared = [one for one in requirements if one.requirement.for_each is None]
        roots = [node for compiled in shared for node in compiled.shared_graph.nodes]
        self.main = Lane(self._flow(graph_of(roots), {}))
        for compiled in shared:
            self._seat(self.main, compiled, {}, None)
        self._unopened: dict[str, tuple[Lane, list[Starter], list[Start]]] = {}
        self._captured: list[tuple[Lane, Instance | None]] = []
        for compiled in requirements:
            if compiled.requirement.for_each is not None:
                self.roster.keyed[compiled.requirement.id] = self._make_keyed(compiled)
        if any(self._needs_history(compiled) for compiled in requirements):
            self._history = []

    def _has_captured(self, instance: Instance) -> bool:
        return any(one is instance for _, one in self._captured)

    @property
    def _entries(self) -> Iterator[tuple[Lane, Instance | None]]:
        """The lanes there are now, with their instances; those of captured attempts last."""
        yield self.main, None
        yield from self.roster.entries()
        yield from self._captured

    @property
    def all(self) -> Sequence[Lane]:
        """The lanes there are now."""
        return [lane for lane, _ in self._entries]

    @property
    def judges(self) -> Sequence[AttemptJudge]:
        """The judges of all lanes."""
        return [judge for lane in self.all for judge in lane.judges]

    def holders(self) -> Sequence[tuple[str, Holder, Open | None]]:
        """What has open attempts: of which requirement, and the attempt of an episode that runs."""
        return [held_by(judge) for lane in self.all for judge in lane.judges]

    def through(self, limit: int) -> None:
        """Let time pass up to `limit` in all lanes, also those that are made on the way."""
        self.main.through(limit)
        self.roster.through(limit)
        index = 0
        while index < len(self._captured):
            self._captured[index][0].through(limit)
            index += 1

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, in all lanes."""
        self.main.reach(t)
        self.roster.reach(t)
        for lane, _ in self._captured:
            lane.reach(t)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Give a sample to the lanes that it concerns; time has come to `t − 1` before."""
        for keyed in self.roster.keyed.values():
            self._open_instances(keyed, t, values)
        if self._history is not None:
            self._history.append((t, values))
        captured = tuple(self._captured)
        self.main.sample(t, values)
        self.roster.sample(t, values)
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
            for starter in lane.starters:
                if starter.trigger is None and lane.flow.origin is not None:
                    position = lane.stand_at_last(end)
                    # A value that came after the last tick of a clock has not occurred at any.
                    if instance is None or instance.first <= position:
                        starter.start(position, end)
        for lane in self.all:
            for episode in lane.episodes:
                episode.close()
        for judge in self.judges:
            judge.reach(reached)
            for attempt in judge.attempts:
                self.ledger.ended(judge, attempt, end, reached)

    # Snapshots.

    def shape(self) -> Shape:
        """What instances and captured attempts there are: what `rebuild` makes lanes for."""
        instances = [
            (name, [(one.rank, one.value, one.first) for one in keyed.instances()])
            for name, keyed in self.roster.keyed.items()
        ]
        templates = {keyed.template for keyed in self.roster.keyed.values()}
        lanes = [
            (*self._kind(lane.made_for[0]), dict(lane.made_for[1]), _value(instance), starts)
            for lane, instance in self._entries
            for starts in (bool(lane.starters),)
            if lane.made_for is not None and lane not in templates
        ]
        return instances, lanes, list(self._unopened), []

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
        instances, lanes, unopened, _ = shape
        for name, found in instances:
            keyed = self.roster.keyed[name]
            source = keyed.each.value
            keyed.take(Instance(rank, source, value, first) for rank, value, first in found)
        for name in [name for name in self._unopened if name not in unopened]:
            _open(*self._unopened.pop(name), 0)
        for name, kind, captured, value, starts in lanes:
            compiled = self._by_id[name].judges[kind]
            own = self.roster.keyed.get(name)
            instance = None if own is None else own.doubted if value is None else own.known[value]
            graph = compiled.shared_graph if starts else compiled.consequent_graph
            lane = Lane(self._flow(graph, captured), (compiled, captured))
            if starts and own is not None:
                self._seat(lane, compiled, captured, instance)
                self.roster.opened(own, value, lane)
            else:
                self._judge(compiled, lane, captured, instance)
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
    ) -> AttemptJudge:
        judge = self._new_judge(compiled, lane.flow, captured)
        lane.add_judge(judge)
        episodic = compiled.requirement.mode is Mode.WHENEVER
        if episodic and compiled.obligation.trigger is not None:
            self._follow_episodes(lane, judge, instance)
        return judge

    def _new_judge(
        self, compiled: CompiledRequirement, flow: Flow, captured: Captured
    ) -> AttemptJudge:
        if compiled.is_beside or compiled.engine(self.engine) == "network":
            return NetworkJudge(compiled, compiled.network_plan, flow, self.ledger, captured)
        return Judge(compiled, compiled.machine(self.engine), flow, self.ledger, captured)

    def _seat(
        self,
        lane: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> list[Starter]:
        """Give a requirement triggers in a lane, and judges, unless attempts bring theirs."""
        doubted = instance is not None and instance.value is None
        lane.expect(compiled)
        if compiled.obligation.trigger is None:
            return [self._starter(lane, compiled, captured, instance, hidden=doubted)]
        if compiled.requirement.mode is Mode.UPON and doubted:
            kinds = [compiled.doubted]
        else:
            kinds = [compiled, compiled.hidden]
        return [
            self._starter(lane, kind, captured, instance, hidden=kind is not compiled)
            for kind in kinds
            if kind is not None
        ]

    def _starter(
        self,
        lane: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
        *,
        hidden: bool,
    ) -> Starter:
        requirement, formula = compiled.requirement, compiled.obligation.trigger
        start: Start
        if requirement.captures:

            def start(t: int, triggered: int) -> None:
                new, own, compared = self._captured_lane(lane, compiled, captured, instance, t)
                self._begin(new, own, instance, t, triggered, hidden=hidden)
                self._captured.append((new, instance))
                if compared is not None:
                    compared.keeps(t)
        else:
            judge = self._judge(compiled, lane, captured, instance)

            def start(t: int, triggered: int) -> None:
                self._begin(lane, judge, instance, t, triggered, hidden=hidden)

        if formula is None:
            starter = Starter(None, -1, start)
        else:
            episodic = hidden or requirement.mode is Mode.WHENEVER
            trigger = Trigger(requirement.pulse, episodic, hidden)
            starter = Starter(trigger, lane.flow.graph.index[formula], start)
        lane.add_starter(starter)
        return starter

    def _compared(
        self,
        parent: Lane,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> CapturedAttempt | None:
        """What sees whether the values of an attempt stay known, where that can end."""
        doubted = instance is not None and instance.value is None
        obligation = compiled.obligation
        doubt = obligation.doubt or obligation.trigger
        main = self._by_id[compiled.requirement.id].obligation
        if main.trigger is None or doubt is None or doubt is main.trigger:
            return None  # what it owes, it owes at one position
        index = parent.flow.graph.index
        # Of what has a key that is not known, another may have begun wherever the episode runs.
        place = None if doubted and obligation.doubt is not None else index[doubt]
        return CapturedAttempt(parent, compiled, captured, index[main.trigger], place)

    def _begin(
        self,
        lane: Lane,
        judge: AttemptJudge,
        instance: Instance | None,
        t: int,
        triggered: int,
        *,
        hidden: bool,
    ) -> None:
        """Start an attempt at the position `t` of a lane."""
        rank = 0 if instance is None else instance.rank
        for episode in lane.episodes:
            if episode.judge is judge:
                lane.begin_episode(episode, t)
                return
        attempt = judge.new_attempt(t, triggered)
        attempt.void = lane.flow.is_cut
        if hidden:
            self.ledger.doubtful(rank, judge, attempt)
        else:
            attempt.sure = True
            self.ledger.sure(rank, judge, attempt, triggered)
        lane.begin(judge, attempt, t)

    def _follow_episodes(self, lane: Lane, judge: AttemptJudge, instance: Instance | None) -> None:
        rank = 0 if instance is None else instance.rank
        ledger = self.ledger

        def start(attempt: Open) -> None:
            ledger.doubtful(rank, judge, attempt)

        def sure(attempt: Open, t: int) -> None:
            ledger.sure(rank, judge, attempt, t)

        doubted = instance is not None and instance.value is None
        lane.add_episode(Episode(judge, lane.flow, doubted=doubted, start=start, sure=sure))

    def untold(self) -> list[str]:
        """The requirements whose trigger was never true or false."""
        told: set[str] = set()
        for lane in self.all:
            told.update(lane.told)
        return [name for name in self._by_id if name not in told]

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
        if _looks_back(compiled, parent.flow.graph):
            lane = Lane(self._flow(graph, own), (compiled, own))
            if lapses:
                lane.flow.cut_at(t)
            judge = self._judge(compiled, lane, own, instance)
            self._replay(lane, instance)
            lane.through(t)
        else:
            lane = Lane(parent.flow.fork(graph, own), (compiled, own))
            if lapses:
                lane.flow.cut_at(t)
            judge = self._judge(compiled, lane, own, instance)
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
            self.roster.opened(keyed, value, self._instance_lane(keyed, instance, t))
        name = keyed.compiled.requirement.id
        if name in self._unopened and None in values_in(keyed.each.value, values):
            _open(*self._unopened.pop(name), t)

    def _make_keyed(self, compiled: CompiledRequirement) -> Keyed:
        """A lane for the occurrences whose value is not known; nothing starts in it before one."""
        each = compiled.requirement.for_each
        if each is None:
            raise AssertionError("it has no instances")
        captured = {each.name: None}
        instance = Instance(0, each.value, None, 0)
        lane = Lane(self._flow(compiled.shared_graph, captured), (compiled, captured))
        starters = self._seat(lane, compiled, captured, instance)
        if self.sources is None or each.value.event in self.sources:
            starts = [starter.start for starter in starters]
            for starter in starters:
                starter.start = _never
            self._unopened[compiled.requirement.id] = (lane, starters, starts)
        # Else whatever occurs is unknown, from the first position on.
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
        starters = self._seat(lane, compiled, captured, instance)
        # No attempt starts before the value has occurred.
        starts = [starter.start for starter in starters]
        for starter in starters:
            starter.start = _never
        if not reach.is_fresh:
            self._replay(lane, instance)
            lane.through(t - 1)
        _open(lane, starters, starts, t)
        return lane

    def _needs_history(self, compiled: CompiledRequirement) -> bool:
        """Whether an instance or a captured attempt has to look at what was before it."""
        keyed = self.roster.keyed.get(compiled.requirement.id)
        kinds = [one for one in (compiled, compiled.hidden, compiled.doubted) if one is not None]
        return (keyed is not None and not keyed.reach.is_fresh) or (
            bool(compiled.requirement.captures)
            and any(_looks_back(one, compiled.shared_graph) for one in kinds)
        )


def _value(instance: Instance | None) -> Scalar:
    return None if instance is None else instance.value


def _looks_back(compiled: CompiledRequirement, parent: Graph) -> bool:
    """Whether what is owed depends on what was before the trigger, and a lane does not know."""
    graph = compiled.consequent_graph
    if compiled.network_plan.looks_back or graph.remembers_captured:
        return True
    return any(graph.nodes[place] not in parent.index for place in graph.stateful)


def _open(lane: Lane, starters: Sequence[Starter], starts: Sequence[Start], t: int) -> None:
    """Let attempts start in a lane, from `t` on."""
    for starter, start in zip(starters, starts, strict=True):
        starter.start = start
        lane.drop_episode(starter, t)


def _never(t: int, triggered: int) -> None:
    """Start nothing."""
