"""The plan of the code that is generated for requirements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.automaton.automaton import Automaton
from rvmon.errors import UnknownNameError
from rvmon.monitor.compiled.refusal import of_c, of_generated, refuse
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.plan.plan import Plan, PlannedRule
from rvmon.plan.planning import plan_of
from rvmon.spec.checked.selection import requirements_asked


def plan_requirements(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    *,
    explained: bool = True,
) -> Plan:
    """The plan of some requirements of a specification; it is made once.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        explained: whether somebody will ask what is owed: the tables are smaller if not.
    """
    key = "plan", tuple(one.requirement.id for one in requirements), explained
    made = compiled.forms.get(key)
    if not isinstance(made, Plan):
        made = plan_of(compiled.checked, [_rule(one, explained) for one in requirements])
        compiled.forms[key] = made
    return made


def _rule(one: CompiledRequirement, explained: bool, *, hidden: bool = False) -> PlannedRule:
    # In this process what judges attempts in doubt is made when one comes up.
    automaton = None if hidden and explained else _planned(one, explained)
    obligation = one.obligation
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
        hidden=None if one.hidden is None else _rule(one.hidden, explained, hidden=True),
        noted=tuple(leaf for leaf, _ in one.leaves) if explained else None,
    )


def _planned(requirement: CompiledRequirement, explained: bool) -> Automaton | None:
    """The automaton of a requirement that generated code is to step; `None`: a judge does."""
    if of_generated(requirement) is not None:
        return None
    return requirement.automaton if explained else requirement.slim


def plan_alone(compiled: CompiledSpec, only: Iterable[str] | None = None) -> Plan:
    """The plan of what is to run without rvmon.

    Args:
        compiled: the specification.
        only: ids of its requirements; default all.

    Raises:
        UnknownNameError: there is no such requirement, or none is asked for.
        RvmonError: one of them is beyond generated code; which and why is said.
    """
    ids = requirements_asked(compiled.checked, only)
    if ids is not None and not ids:
        known = ", ".join(compiled.requirements)
        raise UnknownNameError(f"the list of requirements is empty: there are {known}")
    chosen = compiled.chosen(ids)
    refuse(chosen, of_c, "generated code")
    return plan_requirements(compiled, chosen, explained=False)
