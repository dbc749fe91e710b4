"""Evaluators with the rules that requirements have in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rvmon.monitor.attempts.attempt_judge import AttemptJudge
from rvmon.monitor.attempts.captured import CapturedAttempt
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.evaluator_classes import class_of
from rvmon.monitor.attempts.instance import Instance
from rvmon.monitor.attempts.judges import CapturingRule, judge_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outages
from rvmon.runtime.rule import Rule
from rvmon.spec.checked.specification import CheckedSpec, Mode
from rvmon.trace.sample import Scalar

Captured = Mapping[str, Scalar]


class EvaluatorMaker:
    """Makes evaluators, and gives them rules."""

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
        self._by_id = {compiled.requirement.id: compiled for compiled in requirements}

    def _evaluator(
        self, compiled: CompiledRequirement, captured: Captured, *, starts: bool
    ) -> Evaluator:
        made = class_of(compiled, starts=starts)
        return made(Outages(self.spec, self.sources), captured, compiled)

    def _judges(
        self,
        compiled: CompiledRequirement,
        evaluator: Evaluator,
        captured: Captured,
        instance: Instance | None,
        *,
        started_elsewhere: bool = False,
    ) -> Sequence[AttemptJudge]:
        """What judges the attempts of a requirement, and what judges beside it."""
        judge = judge_of(
            compiled,
            self.engine,
            evaluator,
            self.ledger,
            captured,
            rank=0 if instance is None else instance.rank,
            hidden=compiled is not self._by_id[compiled.requirement.id],
            doubted=_is_doubted(instance),
            started_elsewhere=started_elsewhere,
        )
        return [judge]

    def _drive(
        self,
        evaluator: Evaluator,
        requirements: Sequence[CompiledRequirement],
        captured: Captured,
        instance: Instance | None,
    ) -> None:
        """Give requirements triggers in an evaluator, and judges, unless attempts bring theirs."""
        groups = [
            self._rules(evaluator, kind, captured, instance)
            for compiled in requirements
            for kind in self._kinds(compiled, instance)
        ]
        evaluator.drive(
            [rule for group in groups for rule in group], [group[0] for group in groups]
        )

    def _kinds(
        self, compiled: CompiledRequirement, instance: Instance | None
    ) -> Sequence[CompiledRequirement]:
        """What starts attempts of a requirement: those that are triggered, and those in doubt."""
        kinds = [compiled, compiled.hidden]
        if compiled.obligation.trigger is None:
            kinds = [compiled]
        elif compiled.requirement.mode is Mode.UPON and _is_doubted(instance):
            kinds = [compiled.doubted]
        return [kind for kind in kinds if kind is not None]

    def _drive_attempt(
        self,
        evaluator: Evaluator,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> None:
        """Give a captured attempt its judge; it was triggered in another evaluator."""
        evaluator.drive(
            self._judges(compiled, evaluator, captured, instance, started_elsewhere=True), ()
        )

    def _rules(
        self,
        evaluator: Evaluator,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
    ) -> Sequence[Rule]:
        """What starts attempts, first, and what judges."""
        if not compiled.requirement.captures:
            return self._judges(compiled, evaluator, captured, instance)

        def start(t: int, triggered: int) -> None:
            self._start_captured(evaluator, compiled, captured, instance, t, triggered)

        hidden = compiled is not self._by_id[compiled.requirement.id]
        return [CapturingRule(compiled, evaluator, start, hidden=hidden)]

    def _start_captured(
        self,
        parent: Evaluator,
        compiled: CompiledRequirement,
        captured: Captured,
        instance: Instance | None,
        t: int,
        triggered: int,
    ) -> None:
        """Start an attempt in an evaluator of its own, at the position `t` of its parent."""
        raise NotImplementedError

    def _compared(
        self,
        parent: Evaluator,
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
        index = parent.graph.index
        # Of what has a key that is not known, another may have begun wherever the episode runs.
        place = None if _is_doubted(instance) and obligation.doubt is not None else index[doubt]
        return CapturedAttempt(parent, compiled, captured, index[main.trigger], place)


def _is_doubted(instance: Instance | None) -> bool:
    """Whether it is not known that there is such an instance."""
    return instance is not None and instance.value is None
