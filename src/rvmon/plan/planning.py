"""From requirements to the plan of what the core runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from rvmon.formula.alphabet import literals
from rvmon.formula.core import Core
from rvmon.formula.numeric import inputs_of, operands
from rvmon.formula.state import State, Unborn
from rvmon.plan.graph import Graph, graph_of
from rvmon.plan.plan import Plan, PlannedRule, Uses, Watch, WatchGroup
from rvmon.spec.checked.formula import Compare, Numeric, Probe, ProbeAtom, UpdateValue
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Scalar


def plan_of(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """Share the state formulas of requirements and see what they ask of the input."""
    graph = graph_of(state for rule in rules for state in rule.states)
    names = (tuple(spec.signals), tuple(spec.events))
    captured = [one.value for rule in rules for one in rule.requirement.captures]
    uses = uses_of([graph], captured)
    return Plan(spec, tuple(rules), graph, spec.gap, *names, uses, (), tuple(rules))


def plan_in_units(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """As `plan_of`, those with captured values apart: each attempt or instance is its own run."""
    shared = plan_of(spec, [rule for rule in rules if not rule.is_apart])
    units = tuple(plan_of(spec, [rule]) for rule in rules if rule.is_apart)
    return replace(shared, units=units, asked=tuple(rules))


def plan_of_truths(
    spec: CheckedSpec, formulas: Sequence[Core], captured: Mapping[str, Scalar]
) -> Plan:
    """The plan of what judges nothing: somebody asks where some formulas are true.

    Args:
        spec: the specification.
        formulas: that are asked for.
        captured: the values that they read as captured.
    """
    read = dict.fromkeys(one.proposition for core in formulas for one in literals(core))
    graph = graph_of(read)
    names = (tuple(spec.signals), tuple(spec.events))
    uses = uses_of([graph], ())
    return Plan(spec, (), graph, spec.gap, *names, uses, truths=tuple(formulas), constants=captured)


def plan_of_watches(
    spec: CheckedSpec, watches: Sequence[Watch], groups: Sequence[WatchGroup]
) -> Plan:
    """The plan of what judges nothing: somebody counts where some formulas come true.

    Args:
        spec: the specification.
        watches: the formulas.
        groups: what is counted of them.
    """
    graph = graph_of(watch.state for watch in watches)
    names = (tuple(spec.signals), tuple(spec.events))
    uses = uses_of([graph], ())
    return Plan(
        spec, (), graph, spec.gap, *names, uses, watches=tuple(watches), groups=tuple(groups)
    )


def uses_of(graphs: Iterable[Graph], captured: Iterable[Numeric]) -> dict[str, Uses]:
    """What is asked of signals and events."""
    leaves: dict[str, list[State]] = {}
    for graph in graphs:
        for name, places in graph.by_name.items():
            leaves.setdefault(name, []).extend(graph.nodes[place] for place in places)
    found = {name: _uses(own, name) for name, own in leaves.items()}
    for expression in captured:
        for name in inputs_of(expression):
            found.setdefault(name, Uses())
        for part in operands(expression):
            if isinstance(part, UpdateValue):
                found[part.name] = replace(found[part.name], history=True)
    return found


def _uses(leaves: Sequence[State], name: str) -> Uses:
    return Uses(
        history=any(_asks_history(state, name) for state in leaves),
        marked=any(
            isinstance(state.leaf, ProbeAtom) and state.leaf.probe is not Probe.KNOWN
            for state in leaves
        ),
    )


def _asks_history(state: State, name: str) -> bool:
    leaf = state.leaf
    if isinstance(leaf, ProbeAtom):
        return leaf.probe is Probe.CHANGED
    if isinstance(leaf, Unborn):
        return dict(leaf.signals).get(name, False)
    return isinstance(leaf, Compare) and any(
        isinstance(part, UpdateValue) and part.name == name
        for side in (leaf.left, leaf.right)
        for part in operands(side)
    )
