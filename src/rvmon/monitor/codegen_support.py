"""What generated code can do for requirements, and the plan of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.letter_classes import LetterDiagram
from rvmon.codegen.planning import plan_of
from rvmon.codegen.unit_plan import Plan, PlannedRule
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.monitor.compiled import CompiledRequirement, CompiledSpec
from rvmon.spec.checked.selection import requirements_asked


def can_feed(requirement: CompiledRequirement) -> bool:
    """Whether generated code in this process can work out what a requirement reads."""
    return requirement.requirement.for_each is None and not requirement.requirement.captures


def can_generate(requirement: CompiledRequirement) -> bool:
    """Whether generated code can judge the attempts of a requirement, too."""
    return not _beyond(requirement)


def can_stand_alone(requirement: CompiledRequirement) -> bool:
    """Whether generated code can judge it without a monitor in this process."""
    return not _beyond_alone(requirement)


def _beyond_alone(requirement: CompiledRequirement) -> str:
    """Why generated code cannot do that; empty if it can.

    Attempts in doubt need an automaton, too: in this process anything judges them.
    """
    reason = _beyond(requirement)
    if not reason and requirement.hidden is not None:
        reason = _beyond(requirement.hidden)
        reason = reason and f"{reason}, where its trigger may be unknown"
    return reason


def _beyond(requirement: CompiledRequirement) -> str:
    """Why generated code cannot judge a requirement; empty if it can."""
    if requirement.requirement.for_each:
        return "uses `for each`"
    if requirement.requirement.captures:
        return "uses `let`"
    if requirement.automaton is None:
        return f"has no automaton: {requirement.refusal}"
    if isinstance(requirement.automaton.class_of, LetterDiagram):
        return f"tells {requirement.alphabet.size:,} combinations of its propositions apart"
    return ""


def plan_requirements(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    *,
    explained: bool = True,
) -> Plan:
    """The plan of some requirements of a specification.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        explained: whether somebody will ask what is owed: the tables are smaller if not.
    """
    return plan_of(compiled.checked, [_rule(one, explained) for one in requirements])


def _rule(one: CompiledRequirement, explained: bool, *, hidden: bool = False) -> PlannedRule:
    # In this process what judges attempts in doubt is made when one comes up.
    automaton = None if hidden and explained else _planned(one, explained)
    obligation = one.obligation
    return PlannedRule(
        one.requirement,
        obligation.trigger,
        one.alphabet,
        automaton,
        one.in_runs(automaton),
        again=obligation.again,
        unborn=obligation.unborn,
        told=obligation.told,
        hidden=None if one.hidden is None else _rule(one.hidden, explained, hidden=True),
        noted=tuple(leaf for leaf, _ in one.leaves) if explained else None,
    )


def _planned(requirement: CompiledRequirement, explained: bool) -> Automaton | None:
    """The automaton of a requirement that generated code is to step; `None`: a judge does."""
    if not can_generate(requirement):
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
    chosen = list(compiled.requirements.values())
    names = requirements_asked(compiled.checked, only)
    if names is not None:
        if not names:
            known = ", ".join(compiled.requirements)
            raise UnknownNameError(f"the list of requirements is empty: there are {known}")
        chosen = [one for one in chosen if one.requirement.id in names]
    if compiled.checked.max_delay is not None:
        raise RvmonError(
            "generated code cannot sort samples: leave out `max delay`, or use the engine `auto`"
        )
    for one in chosen:
        if reason := _beyond_alone(one):
            raise RvmonError(
                f"{one.requirement.id} {reason}; generated code cannot judge it: "
                "leave it out (`only`, --only), or use the engine `auto`"
            )
    return plan_requirements(compiled, chosen, explained=False)
