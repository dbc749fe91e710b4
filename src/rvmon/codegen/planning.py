"""From requirements to the plan of generated code."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.codegen.unit_plan import Plan, PlannedRule, Uses
from rvmon.dataflow.graph import Graph, graph_of
from rvmon.formula.numeric import operands
from rvmon.formula.state import Leaf, Unborn
from rvmon.spec.checked.formula import Compare, Probe, ProbeAtom, UpdateValue
from rvmon.spec.checked.specification import CheckedSpec, TimeModel


def plan_of(spec: CheckedSpec, rules: Sequence[PlannedRule]) -> Plan:
    """Share the state formulas of requirements and see what they ask of the input.

    Args:
        spec: they belong to.
        rules: in the order of the file.
    """
    graph = graph_of(state for rule in rules for state in rule.states)
    gap = {TimeModel.HELD: 1, TimeModel.SAMPLED: None}.get(spec.time, spec.period)
    uses = {name: _uses(graph, name) for name in graph.by_name}
    return Plan(spec, tuple(rules), graph, gap, tuple(spec.signals), tuple(spec.events), uses)


def _uses(graph: Graph, name: str) -> Uses:
    leaves = [leaf for place in graph.by_name[name] if (leaf := graph.nodes[place].leaf)]
    return Uses(
        history=any(_asks_history(leaf, name) for leaf in leaves),
        marked=any(
            isinstance(leaf, ProbeAtom) and leaf.probe is not Probe.KNOWN for leaf in leaves
        ),
    )


def _asks_history(leaf: Leaf, name: str) -> bool:
    if isinstance(leaf, ProbeAtom):
        return leaf.probe is Probe.CHANGED
    if isinstance(leaf, Unborn):
        return dict(leaf.signals).get(name, False)
    return isinstance(leaf, Compare) and any(
        isinstance(part, UpdateValue) and part.name == name
        for side in (leaf.left, leaf.right)
        for part in operands(side)
    )
