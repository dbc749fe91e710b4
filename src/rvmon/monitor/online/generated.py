"""Monitors that run generated code where they can; records and findings are made as ever."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rvmon.monitor.attempts.attempt_judge import AttemptJudge, Open
from rvmon.monitor.attempts.judges import judge_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.inputs.health import Arrivals
from rvmon.monitor.online.arrivals import arrivals_of
from rvmon.monitor.online.evaluators import Evaluators
from rvmon.monitor.online.forms import Forms
from rvmon.monitor.online.monitor import Monitor, Step
from rvmon.monitor.online.one_call import overlap
from rvmon.monitor.online.unit_clerks import JudgeClerk, UnitClerk, UnitStanding
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outages
from rvmon.runtime.nodes import BUSY, LIMIT
from rvmon.runtime.rule import Rule
from rvmon.runtime.unit import Unit
from rvmon.runtime.values import NEVER
from rvmon.trace.sample import Value
from rvmon.verdict.attempt import Attempt

Flush = Callable[[int], Sequence[Attempt]]

_HELD = BUSY + 1
"""As `BUSY`, while the monitor is called itself; behind a call that was interrupted as it ended."""


class GeneratedEvaluators(Evaluators):
    """Evaluators of which one is generated code; the others are for what that cannot judge."""

    STATE = ("outages", "unit", "counts", *Evaluators.STATE)

    alone = False

    def __init__(
        self,
        forms: Forms,
        unit: Unit,
        compiled: CompiledSpec,
        engine: str,
        sources: frozenset[str] | None,
        ledger: Ledger,
        other: Step,
    ) -> None:
        self.other = other
        self.flush: Flush = self._flush
        spec = compiled.checked
        super().__init__(spec, forms.others, engine, sources, ledger)
        self.forms = forms
        self.unit = unit
        self.outages = Outages(spec, sources)
        self.counts = [0] * len(forms.requirements)
        clerks: list[Any] = [None] * (len(forms.requirements) + len(forms.plan.hidden_of))
        unit.restart(self, clerks)
        standing = UnitStanding(forms.plan, unit)
        self._clerks = [
            self.clerk_of(one, forms.plan, unit, standing, ledger, self.counts, noted)
            for one, noted in zip(forms.requirements, unit.NOTED, strict=True)
        ]
        judged: list[CompiledRequirement | None] = [*forms.requirements]
        judged += [forms.requirements[index].hidden for index in forms.plan.hidden_of]
        judge_clerk = JudgeClerk(unit, ledger)
        for index, one in enumerate(judged):
            if forms.machines[index] is not None:
                unit.rules[index].clerk = self._clerks[index]
            elif one is not None:
                hidden = index >= len(forms.requirements)
                judge = judge_of(one, "auto", standing, judge_clerk, {}, index=index, hidden=hidden)
                unit.rules[index] = judge
                judge.restless = judge.watches
                unit.note(judge)

    def clerk_of(self, compiled: CompiledRequirement, *arguments: Any) -> UnitClerk:
        """Stands where the judge of a requirement would."""
        return UnitClerk(compiled, *arguments)

    # What the unit calls.

    def lost(self, name: str, t: int, why: str) -> None:
        """Hear that a signal is not known from `t` on."""
        self.outages.lost(name, t, why)

    def _flush(self, t: int) -> Sequence[Attempt]:
        """What a sample at `t` has decided; it is over."""
        decided = self.ledger.flush()
        self.unit.after = t
        return decided

    def found(self, name: str, t: int) -> None:
        """Hear that a signal has a value from `t` on."""
        self.outages.found(name, t)

    # What the monitor calls.

    @property
    def arrivals(self) -> Arrivals:
        """See `Evaluators`."""
        own, others = arrivals_of(self.unit), arrivals_of(self.main)
        first, expired = {**own.first, **others.first}, {**own.expired, **others.expired}
        return Arrivals(own.absent, first, expired)

    @property
    def judges(self) -> Sequence[AttemptJudge]:
        """The judges of all evaluators."""
        return [*(self._judge_now(rule) for rule in self.unit.rules), *super().judges]

    def holders(self) -> Sequence[tuple[str, Rule, Open | None]]:
        """See `Evaluators`."""
        own = [
            (rule.compiled.requirement.id, rule, rule.running_attempt)
            if isinstance(rule, AttemptJudge)
            else (self._clerks[rule.index].id, rule, rule.running_attempt)
            for rule in self.unit.rules
        ]
        return [*own, *super().holders()]

    def _judge_now(self, rule: Rule) -> AttemptJudge:
        """A rule that knows its requirement, or how one would stand in its place."""
        if isinstance(rule, AttemptJudge):
            return rule
        return self._clerks[rule.index].judge_now(rule)

    def take_along(self, t: int) -> None:
        """See `Evaluators`."""
        for rule in self.unit.rules:
            if rule.slides:
                rule.pass_to(t)
        super().take_along(t)

    def through(self, limit: int) -> None:
        """Let time pass up to `limit`."""
        self.unit.through(limit)
        if self.forms.others:
            super().through(limit)

    def reach(self, t: int) -> None:
        """Let time come to `t`, from the instant before."""
        if t >= self.unit.wake:
            self.unit.reach(t)
            self.unit.set_alarm()
        if self.forms.others:
            super().reach(t)

    def sample(self, t: int, values: Mapping[str, Value]) -> None:
        """Take a valid sample; time has come to `t − 1` before."""
        self.unit.take(t, values)
        self.unit.after = _HELD  # the call goes on
        if self.forms.others:
            super().sample(t, values)

    def finish(self, end: int, reached: int) -> None:
        """Settle what is undecided; time has come to `end` before."""
        self.unit.close(end, reached)
        for rule in self.unit.rules:
            judge = self._judge_now(rule)
            rule.attempts = judge.attempts
            rule.settle_flags()
            for attempt in judge.attempts:
                self.ledger.ended(judge, attempt, end, reached)
            rule.attempts, rule.runs = [], {}
        super().finish(end, reached)

    def undetermined(self) -> list[str]:
        """See `Evaluators`."""
        own = [
            one.compiled.requirement.id
            for index, one in enumerate(self._clerks)
            if not self.unit.is_determined(index)
        ]
        return [*own, *super().undetermined()]


class GeneratedMonitor(Monitor):
    """A monitor whose `step_ns` is generated code.

    Samples that need a closer look (the first, unknown values, payloads, what is wrong) take the
    way of every monitor.
    """

    STATE = (*Monitor.STATE, "_floor")

    def __init__(
        self,
        forms: Forms,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        engine: str,
        settle: str,
        sources: frozenset[str] | None,
        keep: int | None,
    ) -> None:
        names = {*compiled.checked.signals, *compiled.checked.events}
        absent = frozenset() if sources is None else frozenset(names - sources)
        self._forms = forms
        self._unit = forms.unit(forms.machines, absent)
        super().__init__(compiled, requirements, engine, settle, sources, keep)
        self._by_unit = not forms.others and self._intake is None
        """Whether the unit alone takes samples as they come."""
        # Generated code looks and closes in one go only where one thread has a turn at a time.
        if self._by_unit and getattr(sys, "_is_gil_enabled", lambda: True)():
            self.step_ns = self._unit.step

    def _make_evaluators(self) -> Evaluators:
        self._unit_evaluators = GeneratedEvaluators(
            self._forms,
            self._unit,
            self.options.compiled,
            self.options.engine,
            self.options.sources,
            self._ledger,
            self._take,
        )
        return self._unit_evaluators

    def _attend(self) -> None:
        attends = self._listeners or self.options.keep is not None
        self._unit_evaluators.flush = self._hear if attends else self._unit_evaluators._flush

    def _begin(self) -> None:
        super()._begin()
        self._floor = self._unit.after

    def _enter(self) -> None:
        """Note the samples that the generated code took by itself, and have it take no more."""
        unit = self._unit
        after = unit.after
        if after == BUSY:
            raise overlap()
        unit.after = _HELD
        if after not in (self._floor, _HELD):
            self._last = self._reached = self._floor = after
        if self._health.began is None:
            self._health.began = unit.began
        if self._torn is None:
            self._torn = unit.torn

    def _leave(self) -> None:
        """Have the generated code take samples behind what was taken, and what time has come to."""
        after = -LIMIT if self._last is None else self._last
        if self._reached is not None:
            after = max(after, self._reached - 1)
        self._unit.after = self._floor = after if self._report is None else LIMIT

    def _hear(self, t: int) -> Sequence[Attempt]:
        """Give out what the generated code has decided by itself, of a sample at `t`."""
        self._last = self._reached = t
        decided = self._flush()
        self._unit.after = self._floor = t
        self._listeners.call(decided)
        return decided

    def _flush(self) -> Sequence[Attempt]:
        self._unit.news = False
        return super()._flush()

    def _advance(self, t_ns: int) -> Sequence[Attempt]:
        if not (self._by_unit and type(t_ns) is int and self._floor < t_ns < self._unit.wake):
            return super()._advance(t_ns)
        self._reached = t_ns  # nothing happens up to then
        return ()

    def _put_away(self) -> bytes:
        # Generated code may take samples meanwhile: what it has taken is part of what is put away.
        self._unit.after = self._floor
        data = super()._put_away()
        if self._unit.after != self._floor:
            raise overlap()
        return data

    def _next_due(self) -> int | None:
        own = min(self._unit.next_position(), self._unit.next_due())
        others = super()._next_due()
        found = own if others is None else min(own, others)
        if found >= NEVER or self._reached is None or self._report is not None:
            return None
        return max(found, self._reached + 1)
