"""The plans of requirements, for generated Python and for the core."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

from rvmon.errors import UnknownNameError
from rvmon.formula.core import Literal
from rvmon.formula.state import State
from rvmon.monitor.compiled.refusal import of_tables
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.plan.planning import plan_in_units, plan_of
from rvmon.spec.checked.selection import requirements_asked


def plan_requirements(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    *,
    measured: bool = False,
) -> Plan:
    """The plan of some requirements of a specification, of which somebody will ask what is owed.

    It is made once.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        measured: whether somebody will ask for the values of all that robustness is made of.
    """
    key = "plan", tuple(one.requirement.id for one in requirements), measured
    made = compiled.forms.get(key)
    if not isinstance(made, Plan):
        how = {"explained": True, "measured": measured}
        rules = [_rule(one, **how) for one in requirements]
        made = plan_of(compiled.checked, rules)
        compiled.forms[key] = made
    return made


def _rule(
    one: CompiledRequirement,
    *,
    explained: bool,
    hidden: bool = False,
    measured: bool = False,
) -> PlannedRule:
    if explained:
        # In this process what judges attempts in doubt is made when one comes up.
        is_judged = hidden or (one.follows_windows and not measured)
        automaton = None if is_judged or of_tables(one) is not None else one.automaton
    else:
        automaton = one.shaped
    obligation = one.obligation
    doubted = one.doubted if one.requirement.for_each is not None else None
    captures = bool(one.requirement.captures)

    def beside(other: CompiledRequirement | None) -> PlannedRule | None:
        if other is None:
            return None
        return _rule(other, explained=explained, hidden=True, measured=measured)

    read = [core for _, core in one.measured_plan.leaves] if measured else []
    return PlannedRule(
        one.requirement,
        obligation.trigger,
        obligation.owed,
        one.alphabet,
        automaton,
        one.in_runs(automaton),
        again=obligation.again,
        unborn=obligation.unborn,
        determined=obligation.determined,
        hidden=beside(one.hidden),
        noted=tuple(leaf for leaf, _ in one.leaves),
        doubted=beside(doubted),
        running=obligation.running if captures else None,
        blurs=_blurs(one) if captures else None,
        blurs_anywhere=obligation.doubt is not None,
        asked=tuple(core.proposition for core in read if isinstance(core, Literal)),
    )


def _traced(one: CompiledRequirement) -> PlannedRule:
    """A requirement that its whole automaton judges, as people know it."""
    rule, automaton = _rule(one, explained=False), one.automaton
    in_runs = one.in_runs(automaton)
    return replace(rule, automaton=automaton, in_runs=in_runs, stepped=True, traced=True)


def _stepped(rule: PlannedRule) -> PlannedRule:
    hidden, doubted = (
        None if one is None else _stepped(one) for one in (rule.hidden, rule.doubted)
    )
    return replace(rule, hidden=hidden, doubted=doubted, stepped=True)


def _blurs(one: CompiledRequirement) -> State | None:
    """What is UNKNOWN where an attempt may have begun with other values than it captured."""
    obligation = one.obligation
    # What it owes by a trigger that is TRUE, it owes at one position.
    return obligation.doubt or (obligation.trigger if one.is_beside else None)


def plan_alone(
    compiled: CompiledSpec,
    only: Iterable[str] | None = None,
    *,
    traced: Collection[str] = (),
    stepped: bool = False,
) -> Plan:
    """The plan of what the core judges.

    Args:
        compiled: the specification.
        only: ids of its requirements; default all.
        traced: ids of those of which somebody asks where attempts go in their automata.
        stepped: whether no chain of windows is to judge any.

    Raises:
        UnknownNameError: there is no such requirement, or none is asked for.
        RvmonError: one of them is beyond all engines; which one and why is in the message.
    """
    ids = requirements_asked(compiled.checked, only)
    if ids is not None and not ids:
        known = ", ".join(compiled.requirements)
        raise UnknownNameError(f"the list of requirements is empty: there are {known}")
    rules = [
        _traced(one) if one.requirement.id in traced else _rule(one, explained=False)
        for one in compiled.chosen(ids)
    ]
    if stepped:
        rules = [_stepped(rule) for rule in rules]
    return plan_in_units(compiled.checked, rules)
