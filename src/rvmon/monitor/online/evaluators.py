"""The evaluators of one run: made, fed, and added to as instances and captures need them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.captured import captured_value
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.evaluator_classes import class_of_all
from rvmon.monitor.attempts.instance import Instance, Shape, seen_by, values_in
from rvmon.monitor.attempts.instances import Instances
from rvmon.monitor.attempts.keyed import Keyed
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.inputs.health import Arrivals
from rvmon.monitor.online.arrivals import arrivals_of
from rvmon.monitor.online.evaluator_maker import Captured, EvaluatorMaker
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outages
from rvmon.runtime.rule import Rule
from rvmon.runtime.values import NEVER
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Scalar, Value


class Evaluators(EvaluatorMaker):
    """All evaluators of one run.

    Attributes:
        main: the evaluator of all requirements without `for each`; its inputs are those of the run.
        instances: the evaluators of those with it, an instance each.
        forgets: whether instances are let go of that are over.
        alone: whether they judge all requirements of a run.
    """

    STATE: tuple[str, ...] = ("_history", "all")

    forgets = True
    alone = True

    def __init__(
        self,
        spec: CheckedSpec,
        requirements: Sequence[CompiledRequirement],
        engine: str,
        sources: frozenset[str] | None,
        ledger: Ledger,
    ) -> None:
        super().__init__(spec, requirements, engine, sources, ledger)
        self.gap = spec.gap
        self.instances = Instances(forgets=self.forgets, is_held=self._has_captured)
        self._history: list[tuple[int, Mapping[str, Value]]] | None = None
        self._shared = [one for one in requirements if one.requirement.for_each is None]
        self.main = class_of_all(spec, requirements, alone=self.alone)(Outages(spec, sources), {})
        self._drive(self.main, self._shared, {}, None)
        self._captured: list[tuple[Evaluator, Instance | None]] = []
        for compiled in requirements:
            if compiled.requirement.for_each is not None:
                self.instances.keyed[compiled.requirement.id] = self._make_keyed(compiled)
        if any(self._needs_history(compiled) for compiled in requirements):
            self._history = []

    def _has_captured(self, instance: Instance) -> bool:
        return any(one is instance for _, one in self._captured)

    @property
    def _entries(self) -> Iterator[tuple[Evaluator, Instance | None]]:
        """The evaluators there are now, with their instances; those of captured attempts last."""
        yield self.main, None
        yield from self.instances.entries()
        yield from self._captured

    @property
    def all(self) -> Sequence[Evaluator]:
        """The evaluators there are now."""
        return [evaluator for evaluator, _ in self._entries]

    @property
    def arrivals(self) -> Arrivals:
        """What was seen of signals and events."""
        return arrivals_of(self.main)

    @property
    def judges(self) -> Sequence[AttemptJudge]:
        """The judges of all evaluators."""
        return [judge for evaluator in self.all for judge in evaluator.judges]

    def holders(self) -> Sequence[tuple[str, Rule, Open | None]]:
        """What has open attempts: of which requirement, and the attempt of an episode that runs."""
        return [
            (judge.compiled.requirement.id, judge, judge.running_attempt)
            for evaluator in self.all
            for judge in evaluator.judges
        ]

    def take_along(self, t: int) -> None:
        """Take clocks along to `t` that move while attempts loop, as when somebody looks."""
        for judge in [judge for evaluator in self.all for judge in evaluator.judges]:
            if judge.slides:
                judge.pass_to(t)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit` in all evaluators, also those that are made on the way."""
        self.main.through(limit)
        self.instances.through(limit)
        index = 0
        while index < len(self._captured):
            self._captured[index][0].through(limit)
            index += 1

    def reach(self, t: int) -> None:
        """Let time come to `t`, of which no position is known, in all evaluators."""
        self.main.reach(t)
        self.instances.reach(t)
        for evaluator, _ in self._captured:
            evaluator.reach(t)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Give a sample to the evaluators that it concerns; time has come to `t − 1` before."""
        for keyed in self.instances.keyed.values():
            self._open_instances(keyed, t, values)
        if self._history is not None:
            self._history.append((t, values))
        captured = tuple(self._captured)
        self.main.sample(t, values)
        self.instances.sample(t, values)
        for evaluator, instance in captured:
            evaluator.sample(t, seen_by(instance, values))
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
        for evaluator, instance in tuple(self._entries):
            for rule in evaluator.starters if evaluator.opens_at < NEVER else ():
                if rule.trigger < 0 and evaluator.origin is not None:
                    position = evaluator.stand_at_last(end)
                    # A value that came after the last tick of a clock has not occurred at any.
                    if instance is None or instance.first <= position:
                        rule.begin(position, end)
        for evaluator in self.all:
            for judge in evaluator.judges:
                judge.settle_flags()
        for judge in self.judges:
            judge.reach(reached)
            for attempt in judge.attempts:
                self.ledger.ended(judge, attempt, end, reached)

    # Snapshots.

    def shape(self) -> Shape:
        """What instances and captured attempts there are: what `rebuild` makes evaluators for."""
        instances = [
            (name, [(one.rank, one.value, one.first) for one in keyed.instances()])
            for name, keyed in self.instances.keyed.items()
        ]
        templates = {keyed.template for keyed in self.instances.keyed.values()}
        watched = {one.evaluator for evaluator in self.all for one in evaluator.watched}
        evaluators = [
            (
                *self._kind(evaluator.made_for),
                dict(evaluator.captured),
                _value(instance),
                bool(evaluator.starters),
                evaluator in watched,
            )
            for evaluator, instance in self._entries
            if evaluator.made_for is not None and evaluator not in templates
        ]
        return instances, evaluators

    def _kind(self, compiled: CompiledRequirement) -> tuple[str, str]:
        """The requirement, and which of its judges it is."""
        name = compiled.requirement.id
        found = self._by_id[name].judges
        return name, next(kind for kind, one in found.items() if one is compiled)

    def rebuild(self, shape: Shape) -> None:
        """Make the evaluators that another run had; what they hold is to be set afterwards."""
        instances, evaluators = shape
        for name, found in instances:
            keyed = self.instances.keyed[name]
            source = keyed.each.value
            keyed.take(Instance(rank, source, value, first) for rank, value, first in found)
        for name, kind, captured, value, starts, watched in evaluators:
            compiled = self._by_id[name].judges[kind]
            own = self.instances.keyed.get(name)
            instance = None if own is None else own.doubted if value is None else own.known[value]
            evaluator = self._evaluator(compiled, captured, starts=starts)
            if starts and own is not None:
                self._drive(evaluator, [compiled], captured, instance)
                self.instances.opened(own, value, evaluator)
            else:
                self._drive_attempt(evaluator, compiled, captured, instance)
                parents = (one for one, its in self._entries if one.starters and its is instance)
                parent = next(parents, self.main)
                compared = self._compared(parent, compiled, captured, instance)
                if compared is not None and watched:
                    compared.follow(evaluator)
                self._captured.append((evaluator, instance))

    # Making evaluators.

    def undetermined(self) -> list[str]:
        """The requirements whose trigger was never true or false."""
        asked = [(self.main, one) for one in self._shared]
        # What comes after the last tick of a clock has occurred at no position.
        asked += [
            (evaluator, evaluator.made_for)
            for evaluator, instance in self.instances.entries()
            if evaluator.made_for
            and (instance.value is None or instance.first <= evaluator.position)
        ]
        determined = {
            one.requirement.id for evaluator, one in asked if evaluator.is_determined(one)
        }
        return [name for name in self._by_id if name not in determined]

    def _start_captured(
        self,
        parent: Evaluator,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
        t: int,
        triggered: int,
    ) -> None:
        """See `EvaluatorMaker`; its captured values are constants in it."""
        own = dict(captured)
        for capture in compiled.requirement.captures:
            own[capture.name] = captured_value(capture.value, parent, own)
        compared = self._compared(parent, compiled, own, instance)
        evaluator = self._evaluator(compiled, own, starts=False)
        self._drive_attempt(evaluator, compiled, own, instance)
        replays = self._replays(compiled)
        if not replays:
            evaluator.clerk = parent.clerk.copy()
            parent.fork(evaluator, self._by_id[compiled.requirement.id].shared_graph)
        if compared is not None and compared.may_begin_otherwise:
            evaluator.cut_at(t)
        if replays:
            self._replay(evaluator, instance)
            evaluator.through(t)
        if compared is not None:
            compared.follow(evaluator)
        evaluator.begin(evaluator.judges[0], t, triggered)
        self._captured.append((evaluator, instance))
        if compared is not None:
            compared.keeps(t)

    def _replays(self, compiled: CompiledRequirement) -> bool:
        """Whether a captured attempt has to see what its requirement does not remember.

        Others that share its evaluator may remember it: what is said does not depend on them.
        """
        return compiled.looks_back_beyond(self._by_id[compiled.requirement.id].shared_graph)

    def _replay(self, evaluator: Evaluator, instance: Instance | None) -> None:
        """Let a new evaluator see the samples so far."""
        for t, values in self._history or ():
            evaluator.through(t - 1)
            evaluator.sample(t, seen_by(instance, values))

    def _open_instances(self, keyed: Keyed, t: int, values: Mapping[str, Value]) -> None:
        """Make the evaluators that a sample asks for."""
        for value in keyed.values_to_open(values):
            instance = keyed.instance(value, t)
            self.instances.opened(keyed, value, self._instance_evaluator(keyed, instance, t))
        if keyed.template.opens_at == NEVER and None in values_in(keyed.each.value, values):
            keyed.template.open(t)

    def _make_keyed(self, compiled: CompiledRequirement) -> Keyed:
        """An evaluator of occurrences whose value is not known; nothing starts in it before one."""
        each = compiled.requirement.for_each
        if each is None:
            raise AssertionError("it has no instances")
        captured = {each.name: None}
        instance = Instance(0, each.value, None, 0)
        evaluator = self._evaluator(compiled, captured, starts=True)
        self._drive(evaluator, [compiled], captured, instance)
        # Without a source, whatever occurs is unknown, from the first position on.
        if each.value.event not in evaluator.absent:
            evaluator.opens_at = NEVER
        return Keyed(compiled, each, evaluator, instance, is_timed=self.gap is not None)

    def _instance_evaluator(self, keyed: Keyed, instance: Instance, t: int) -> Evaluator:
        """An evaluator for an instance, as of just before the sample at `t`."""
        compiled, reach = keyed.compiled, keyed.reach
        captured = {keyed.each.name: instance.value}
        evaluator = self._evaluator(compiled, captured, starts=True)
        self._drive(evaluator, [compiled], captured, instance)
        if reach.is_fresh:
            evaluator.clerk = keyed.template.clerk.copy()
            keyed.template.twin(evaluator, reach.varying, reach.own)
        # No attempt starts before the value has occurred.
        evaluator.opens_at = NEVER
        if not reach.is_fresh:
            self._replay(evaluator, instance)
            evaluator.through(t - 1)
        evaluator.open(t)
        return evaluator

    def _needs_history(self, compiled: CompiledRequirement) -> bool:
        """Whether an instance or a captured attempt has to look at what was before it."""
        keyed = self.instances.keyed.get(compiled.requirement.id)
        return (keyed is not None and not keyed.reach.is_fresh) or (
            bool(compiled.requirement.captures)
            and any(self._replays(one) for one in compiled.judges.values())
        )


def _value(instance: Instance | None) -> Scalar:
    return None if instance is None else instance.value
