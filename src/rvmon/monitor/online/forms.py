"""What is generated for one choice of requirements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.automaton.machine import Machine
from rvmon.codegen.python_unit import unit_class
from rvmon.monitor.compiled.code_plan import plan_requirements
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.compiled.specification import CompiledSpec
from rvmon.plan.plan import Plan
from rvmon.runtime.unit import Unit


@dataclass(frozen=True, slots=True)
class Forms:
    """What is generated for one choice of requirements and sources; serves any number of monitors.

    Attributes:
        requirements: those that generated code judges, or feeds a judge of.
        others: those that it can do nothing for.
        plan: of `requirements`.
        unit: the generated class.
        machines: per requirement, what judges its attempts; `None`: a judge.
    """

    requirements: Sequence[CompiledRequirement]
    others: Sequence[CompiledRequirement]
    plan: Plan
    unit: type[Unit]
    machines: Sequence[Machine | None]


def forms_of(
    compiled: CompiledSpec,
    requirements: Sequence[CompiledRequirement],
    sources: frozenset[str] | None,
) -> Forms:
    """Generate what monitors of some requirements run.

    Args:
        compiled: the specification.
        requirements: chosen from it.
        sources: the names that can arrive; `None`: all.
    """
    fed = [one for one in requirements if one.is_fed]
    plan = plan_requirements(compiled, fed)
    machines = [
        None if rule.automaton is None else one.machine("automaton")
        for one, rule in zip(fed, plan.rules, strict=True)
    ]
    # What judges attempts in doubt is made when one comes up.
    machines += [None for _ in plan.hidden_of]
    others = [one for one in requirements if not one.is_fed]
    unit = unit_class(plan, sources, Unit)
    return Forms(fed, others, plan, unit, machines)
