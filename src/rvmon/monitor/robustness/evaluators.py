"""The evaluators of a run in which another judge measures, beside each of the usual ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from rvmon.automaton.location import Token
from rvmon.codegen.python_unit import margins_function
from rvmon.dataflow.nodes import NetworkPlan
from rvmon.formula.core import Literal
from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.attempts.instance import Instance
from rvmon.monitor.attempts.keyed import Keyed
from rvmon.monitor.compiled.refusal import MOST_GENERATED
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.evaluator_maker import Captured
from rvmon.monitor.online.forms import Forms, forms_of
from rvmon.monitor.online.generated import GeneratedEvaluators
from rvmon.monitor.online.unit_clerks import UnitClerk, UnitStanding
from rvmon.monitor.robustness.gauged import Gauged
from rvmon.monitor.robustness.margin_judge import MarginJudge
from rvmon.plan.leaves import reads
from rvmon.plan.plan import Plan
from rvmon.runtime.past import History
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit
from rvmon.spec.checked.formula import Compare, EventAtom, SignalAtom
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Payload, Scalar, Value


def measuring_forms(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
) -> Forms:
    """What is generated for runs that measure; it is used for all of them.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        sources: the names that can arrive; `None`: all.
    """
    key = (MarginJudge, tuple(one.requirement.id for one in requirements), sources)
    if key not in compiled.forms:
        by_unit = [one for one in requirements if _is_for_unit(one)]
        # What is owed at the end is reported whenever one of the others is asked.
        waits = any(one.obligation.trigger is None for one in requirements)
        if waits or len(requirements) > MOST_GENERATED:
            by_unit = []
        forms = forms_of(compiled, by_unit, sources, measured=True)
        others = [one.measuring for one in requirements if one not in by_unit]
        compiled.forms[key] = replace(forms, others=others, unit=_watched(forms.unit))
    found = compiled.forms[key]
    assert isinstance(found, Forms)  # noqa: S101 - it is what was put there
    return found


def _is_for_unit(compiled: CompiledRequirement) -> bool:
    """Whether all that is measured can be read when a sample was taken or a position visited."""
    return compiled.is_fed and compiled.gap in (None, 1) and not compiled.measures_payloads


def _watched(unit: type[Unit]) -> type[Unit]:
    """The same, having positions noted between samples, too, by who waits for them."""

    def visit(self: Any, t: int) -> None:
        unit.visit(self, t)
        for judge in self.watching:
            if judge.position < t:
                judge.visit(t)

    made: type[Unit] = type("Watched", (unit,), {"__slots__": ("watching",), "visit": visit})
    return made


def _is_steady(plan: NetworkPlan, spec: CheckedSpec) -> bool:
    """Whether what is measured changes with samples alone, or is over at the next position."""
    states = [core.proposition for _, core in plan.leaves if isinstance(core, Literal)]
    return all(
        isinstance(state.leaf, Compare | EventAtom | SignalAtom)
        and not any(
            spec.signals[name].stale_after
            for name in reads(state.leaf).names
            if name in spec.signals
        )
        for state in states
    )


class UnitFlow(UnitStanding):
    """What leaves are read of where code is generated; see `MarginJudge`."""

    def __init__(self, plan: Plan, unit: Unit) -> None:
        super().__init__(plan, unit)
        self.plan = plan
        self.unit = unit

    @property
    def absent(self) -> frozenset[str]:
        """The names without a source."""
        return self.unit.absent

    def value_of(self, signal: str) -> Scalar:
        """See `rvmon.runtime.expressions.Input`."""
        found: Scalar = self.unit.s[self.unit.SIGNALS.index(signal)]
        return found

    def history_of(self, signal: str) -> History:
        """See `rvmon.runtime.expressions.Input`."""
        found = self.unit.h[self.unit.SIGNALS.index(signal)]
        assert found is not None  # noqa: S101 - who reads it has asked for it
        return found

    def payloads_of(self, _: str) -> Sequence[Payload | None]:
        """See `rvmon.runtime.expressions.Input`."""
        raise AssertionError("they are gone when a sample was taken")


class _Clerk(UnitClerk):
    """Has the attempts of a requirement measured, and writes no records.

    Attributes:
        gauged: takes the figures.
        beside: measures the attempts.
    """

    beside: MarginJudge

    def __init__(self, gauged: Gauged, *given: Any) -> None:
        super().__init__(*given)
        self.gauged = gauged

    def opened(self, rule: Rule, triggered: int, token: Token, sure: bool) -> Open:
        """See `UnitClerk`."""
        attempt = super().opened(rule, triggered, token, sure)
        self.gauged.measure(self.beside, attempt)
        return attempt

    def entered(self, rule: Rule) -> tuple[int, tuple[int, ...]]:
        """See `UnitClerk`."""
        number, seen = super().entered(rule)
        attempt = Open(self._unit.position, (0, ()), seen)
        attempt.number = number
        attempt.sure = True
        self.gauged.measure(self.beside, attempt)
        return number, seen

    def decided(self, _: Rule, attempt: Open, verdict: bool, t: int, before: Token) -> None:
        """See `UnitClerk`."""
        self.gauged.decided(self.beside, attempt, verdict, t, before)

    def decided_in_run(self, *_: Any) -> None:
        """See `UnitClerk`."""


class MeasuringEvaluators(GeneratedEvaluators):
    """Evaluators in which another judge, beside each of the usual ones, measures its attempts.

    Args:
        gauged: takes the figures.
        streams: whether each position of a sample is measured, and not those of attempts alone.
        forms: as for `GeneratedEvaluators`; so are the others.

    Attributes:
        beside_unit: what measures what generated code judges.
    """

    forgets = False

    def __init__(
        self,
        gauged: Gauged,
        streams: bool,
        forms: Forms,
        unit: Unit,
        *given: Any,
    ) -> None:
        self._gauged = gauged
        self._streams = streams
        super().__init__(forms, unit, *given)
        flow = UnitFlow(forms.plan, unit)
        self.beside_unit = [self._beside(n, rule, flow) for n, rule in enumerate(unit.rules)]
        watching: Any = unit
        watching.watching = [
            judge
            for judge in self.beside_unit
            if not _is_steady(judge.compiled.measured_plan, self.spec)
        ]

    def _beside(self, index: int, rule: Rule, flow: UnitFlow) -> MarginJudge:
        """Measures the attempts of a rule of generated code."""
        is_main = index < len(self._clerks)
        compiled = rule.compiled if isinstance(rule, AttemptJudge) else self._clerks[index].compiled
        plan = compiled.measured_plan
        read = margins_function(flow.plan, [core for _, core in plan.leaves])
        every = self._streams and is_main
        made = MarginJudge(
            compiled,
            plan,
            flow,
            self._gauged,
            {},
            self.spec,
            every=every,
            known=partial(read, flow.unit),
        )
        if isinstance(rule, AttemptJudge):
            self._gauged.beside[rule] = made
        else:
            rule.clerk.beside = made
        return made

    def clerk_of(self, compiled: CompiledRequirement, *given: Any) -> UnitClerk:
        """See `GeneratedEvaluators`."""
        return _Clerk(self._gauged, compiled, *given)

    def _judges(
        self,
        compiled: CompiledRequirement,
        evaluator: Evaluator,
        captured: Captured,
        instance: Instance | None,
        *,
        started_elsewhere: bool = False,
    ) -> Sequence[AttemptJudge]:
        judges = super()._judges(
            compiled, evaluator, captured, instance, started_elsewhere=started_elsewhere
        )
        is_main = compiled is self._by_id[compiled.requirement.id]
        every = self._streams and compiled.is_fed and is_main
        plan = compiled.measured_plan
        beside = MarginJudge(
            compiled, plan, evaluator, self._gauged, captured, self.spec, every=every
        )
        self._gauged.beside[judges[0]] = beside
        return [*judges, beside]

    def _make_keyed(self, compiled: CompiledRequirement) -> Keyed:
        keyed = super()._make_keyed(compiled)
        if any(one.measured_plan.looks_back for one in compiled.judges.values()):
            # What measures an instance has to see what was before it.
            keyed.reach = replace(keyed.reach, is_fresh=False)
        return keyed

    def _replays(self, compiled: CompiledRequirement) -> bool:
        return compiled.measured_plan.looks_back or super()._replays(compiled)

    @property
    def measuring(self) -> Sequence[MarginJudge]:
        """All that measures now, where attempts share their inputs in the order of the file."""
        shared, *apart = [
            [judge for judge in evaluator.judges if isinstance(judge, MarginJudge)]
            for evaluator in self.all
        ]
        shared = sorted([*self.beside_unit, *shared], key=lambda judge: judge.compiled.rank)
        return [*shared, *(judge for own in apart for judge in own)]

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """See `GeneratedEvaluators`."""
        self._gauged.heard = t
        super().sample(t, values)
        for judge in self.beside_unit:
            if judge.position < t:
                judge.visit(t)

    def finish(self, end: int, reached: int) -> None:
        """See `GeneratedEvaluators`; the positions that were not settled are measured as well."""
        super().finish(end, reached)
        for judge in self.beside_unit:
            for attempt in judge.attempts:
                self._gauged.ended(judge, attempt, end, reached)
        for judge in self.measuring:
            if judge.every:
                for t, found in judge.figures(end, reached).items():
                    self._gauged.passed(judge, t, found)
