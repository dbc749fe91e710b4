"""Monitors of generated Python that lend their state to compiled C wherever nothing is unknown.

C takes the samples that say nothing but plain values, and notes with each decision what its reason
is worked out from. For all else (unknown values, what is wrong, questions, the end) Python takes
the state back: so the two differ in nothing but the time they take.

What C does not judge, evaluators in Python do all the while. C takes alone what is nothing new to
them, up to the instant at which something happens in them; other samples both are given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rvmon.codegen.c_online import ALWAYS, BY_CHANGE, NOBODY, OnlineLibrary
from rvmon.errors import OverlapError, TraceError
from rvmon.formula.core import Literal
from rvmon.monitor.attempts.evaluator_classes import names_looked_at
from rvmon.monitor.c.exchange import Exchange
from rvmon.monitor.c.noted_reasons import NotedReasons
from rvmon.monitor.compiled.refusal import of_tables
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.monitor.online.forms import Forms
from rvmon.monitor.online.generated import GeneratedMonitor
from rvmon.monitor.online.one_call import overlap
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.plan.planning import plan_of
from rvmon.runtime.nodes import LIMIT
from rvmon.trace.sample import Value
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report

if TYPE_CHECKING:
    from rvmon.monitor.online.evaluators import Evaluators

_FEW, _MANY = 4, 256
"""So many samples at least and at most Python takes before it lends its state again: doubled each
time that it had it back soon."""


def plan_beside(plan: Plan, requirements: Sequence[CompiledRequirement]) -> Plan:
    """What is compiled to stand beside generated Python: all but what reports the unknown.

    Where that follows windows, compiled code steps the automaton, if there is one.

    Args:
        plan: of the generated Python.
        requirements: that it is of.
    """
    known = [
        replace(_stepped(one, rule), hidden=None, determined=None)
        for one, rule in zip(requirements, plan.rules, strict=True)
    ]
    return plan_of(plan.spec, known)


def _stepped(one: CompiledRequirement, rule: PlannedRule) -> PlannedRule:
    if rule.automaton is not None or of_tables(one) is not None:
        return rule
    told = {core.proposition for _, core in one.network_plan.leaves if isinstance(core, Literal)}
    if not told.issuperset(rule.alphabet.propositions):
        return rule
    return replace(rule, automaton=one.slim, is_lettered=True)


@dataclass(frozen=True, slots=True)
class Beside:
    """What monitors of one choice of requirements need of compiled C.

    Attributes:
        library: compiled.
        exchange: of states.
        details: per requirement, gives records their reasons.
        concerns: per name, whether Python looks at it itself; see `Core.lend`.
    """

    library: OnlineLibrary
    exchange: Exchange
    details: tuple[Any, ...]
    concerns: bytes


def beside(forms: Forms, library: OnlineLibrary) -> Beside:
    """What stands beside generated Python.

    Args:
        forms: what was generated.
        library: compiled of its `plan_beside`.
    """
    details = [NotedReasons(one, forms.plan, Ledger()).details for one in forms.requirements]
    plan = forms.plan
    left = () if forms.left is None else forms.left.requirements
    looked_at = names_looked_at(plan.spec, [*forms.others, *left])
    concerns = [
        (ALWAYS if looked_at[name] else BY_CHANGE) if name in looked_at else NOBODY
        for name in (*plan.signals, *plan.events)
    ]
    return Beside(library, Exchange(forms, library), tuple(details), bytes(concerns))


class LendingMonitor(GeneratedMonitor):
    """A monitor of generated code that has compiled code beside it.

    Args:
        own: the compiled code.
        forms: what was generated, of the requirements that C takes; and which it does not.
        compiled: the specification.
        requirements: all that are to be judged.
        engine: that was asked for.
        sources: the names that can arrive; `None`: all.
        keep: see `build_monitor`.
    """

    def __init__(
        self,
        own: Beside,
        forms: Forms,
        compiled: CompiledSpec,
        requirements: Sequence[CompiledRequirement],
        engine: str,
        sources: frozenset[str] | None,
        keep: int | None,
    ) -> None:
        names = {*compiled.checked.signals, *compiled.checked.events}
        self._exchange = own.exchange
        self._concerns = own.concerns
        self._is_mixed = not forms.are_all
        self._ranks = {one.requirement.id: one.rank for one in requirements}
        self._core = own.library.core(
            frozenset() if sources is None else frozenset(names - sources),
            look_closer=self._take_at,
            look_closer_ns=self._by_python,
            heard=self._heard,
            details=own.details,
        )
        super().__init__(forms, compiled, requirements, engine, "now", sources, keep)
        self._in_python = self.step_ns
        self.step, self.step_ns = self._core.step, self._core.step_ns

    def _begin(self) -> None:
        self._core.reset()
        self._is_lent = False
        self._shown = -LIMIT
        """The last instant of which the evaluators know all that C does."""
        self._looks_at = -LIMIT
        """Before that, nothing happens in them without a sample."""
        self._wait, self._patience = 1, _FEW
        super()._begin()

    def _attend(self) -> None:
        super()._attend()
        self._core.attend(bool(self._listeners) or self.options.keep is not None)

    def _enter(self) -> None:
        """Have C take no samples, and note how far it has come."""
        if not self._core.hold(True):
            raise overlap()
        if self._is_lent:
            _, _, self._last, self._reached = self._core.times()
        super()._enter()

    def _leave(self) -> None:
        super()._leave()
        self._core.hold(False)

    def _by_python(self, t_ns: int, values: Mapping[str, Any]) -> Sequence[Attempt]:
        """Take a sample that C does not take."""
        if self._is_lent:
            return self._take(t_ns, values)
        decided = self._in_python(t_ns, values)
        self._wait -= 1
        if self._wait <= 0:
            with suppress(OverlapError):  # another call has come meanwhile
                self.one_call(self._lend)
        return decided

    def _lend(self) -> None:
        """Have C go on, if it can by now."""
        state = None
        if self._last is not None and self._reached is not None and self._report is None:
            state = self._exchange.lent(self._unit_evaluators, self._last, self._reached)
        self._wait = self._patience
        self._patience = min(2 * self._patience, _MANY)
        if state is not None:
            self._core.lend(state, self._ledger.attempts, self._concerns)
            self._is_lent = self._unit_evaluators.lent = True
            self._unit.wake = -LIMIT
            if self._last is not None:
                self._shown = self._last
            self._set_look()

    def _have_back(self) -> None:
        """Have Python go on."""
        if self._is_lent:
            self._show_last()
            taken = self._exchange.take_back(self._unit_evaluators, self._core.take_back())
            self._is_lent = self._unit_evaluators.lent = False
            self._core.give_up()
            if self._last is not None and self._reached is not None:
                self._floor = max(self._last, self._reached - 1)
            if taken > _MANY:
                self._patience = _FEW
            self._wait = self._patience

    def _heard(self, decided: Sequence[Attempt]) -> None:
        """Hear of what C has decided; it takes no sample until the records are bounded."""
        try:
            self._kept.bound(self._unit_evaluators)
        finally:
            self._core.free()
        self._listeners.call(decided)

    # What C does not judge.

    def _show_last(self) -> None:
        """Lead the evaluators to the last sample that C took alone; they learn nothing else."""
        last = self._last
        if self._is_mixed and last is not None and last > self._shown:
            self._unit_evaluators.through(last - 1)
            self._unit_evaluators.sample(last, {})
            self._shown = last

    def _set_look(self) -> None:
        """Have C take no sample alone once something happens in the evaluators."""
        if self._is_mixed:
            self._looks_at = max(-LIMIT, min(self._unit_evaluators.alarm, LIMIT))
            self._core.look_at(self._looks_at)

    def _admit(self, t: int, values: Mapping[str, Value]) -> None:
        """Lead the evaluators to a sample, before C takes it: they may refuse it."""
        if self._is_mixed:
            evaluators = self._unit_evaluators
            if evaluators.instances.keyed:
                self._show_last()  # new ones begin where that left off
            self._shown = t
            if t > self._looks_at:
                evaluators.through(t - 1)
            try:
                evaluators.instances.admit(t, values)
            except TraceError:
                self._pass_to(t)
                raise

    # What both judge.

    def _judge(self, t: int, values: Mapping[str, Value]) -> None:
        if self._is_lent:
            self._admit(t, values)
            try:
                self._core.take(t, dict(values))
            except ValueError:
                self._have_back()
            else:
                if self._is_mixed:
                    self._unit_evaluators.sample(t, values)
                self._last = self._reached = t
                return
        super()._judge(t, values)

    def _pass_to(self, t: int) -> None:
        if self._is_lent and not self._core.is_fresh(t):
            self._have_back()
        if not self._is_lent:
            super()._pass_to(t)
        elif self._reached is None or t > self._reached:
            if self._is_mixed:
                self._show_last()
                self._unit_evaluators.through(t - 1)
                self._unit_evaluators.reach(t)
            self._core.advance(t)
            self._reached = t

    def _flush(self) -> Sequence[Attempt]:
        if not self._is_lent:
            return super()._flush()
        decided = self._core.flush()
        if self._is_mixed:
            decided = self._merged(decided)
            self._set_look()
        self._kept.bound(self._unit_evaluators)
        return decided

    def _merged(self, decided: Sequence[Attempt]) -> Sequence[Attempt]:
        """What C has decided, and put into the ledger, with what the evaluators have."""
        ledger, ranks = self._ledger, self._ranks
        if not decided:
            return ledger.flush()
        del ledger.attempts[len(ledger.attempts) - len(decided) :]
        ledger.recorded += [
            (one.decided or 0, ranks[one.requirement], one.number, one) for one in decided
        ]
        return ledger.flush()

    # What C does not know.

    @property
    def evaluators(self) -> Evaluators:
        """See `Monitor`."""
        self.one_call(self._have_back)
        return super().evaluators

    def _conclude(self, t_ns: int | None) -> tuple[Report, Sequence[Attempt]]:
        self._have_back()
        return super()._conclude(t_ns)

    def _put_away(self) -> bytes:
        self._have_back()
        return super()._put_away()

    def _owed(self, most: int | None) -> tuple[Mapping[str, int], Sequence[Attempt]]:
        self._have_back()
        return super()._owed(most)

    def _next_due(self) -> int | None:
        self._have_back()
        return super()._next_due()
