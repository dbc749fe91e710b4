"""Plans of what judges nothing."""

from __future__ import annotations

from rvmon.logic.automaton import Automaton
from rvmon.logic.plan import Plan, plan_of_truths
from rvmon.monitor.compiled_spec import CompiledSpec

TRACED_MOST = 64
"""As plan.h has it."""


def is_small(automaton: Automaton | None) -> bool:
    """Whether it may be counted where attempts go in an automaton."""
    return automaton is not None and len(automaton.locations) <= TRACED_MOST


def truths_plan(compiled: CompiledSpec) -> Plan:
    """The plan of who asks where all that is required is true; what is captured is 1."""
    required = dict.fromkeys(one.obligation.required for one in compiled.requirements.values())
    captured: dict[str, float | None] = {}
    for requirement in compiled.checked.requirements.values():
        each = requirement.for_each
        names = [one.name for one in requirement.captures]
        captured |= dict.fromkeys(names if each is None else [each.name, *names], 1)
    return plan_of_truths(compiled.checked, list(required), captured)
