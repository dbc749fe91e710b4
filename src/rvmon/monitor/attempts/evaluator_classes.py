"""The classes of evaluators, generated once for all runs of a specification."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

from rvmon.codegen.python_nodes import sparse_nodes, sparse_span
from rvmon.codegen.python_unit import evaluator_class
from rvmon.monitor.attempts.evaluator import Evaluator
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.plan.graph import Graph, graph_of
from rvmon.plan.plan import Uses
from rvmon.plan.planning import plan_of_evaluator, uses_of
from rvmon.spec.checked.specification import CheckedSpec

Made = TypeVar("Made", bound=Evaluator)

_IDLE: dict[int | None, type[Evaluator]] = {}
"""The classes of evaluators that read nothing, by the ticks between two positions."""


def class_of_all(
    spec: CheckedSpec, requirements: Sequence[CompiledRequirement], *, alone: bool = True
) -> type[Evaluator]:
    """The class of the evaluator that requirements without `for each` share.

    It sees when each signal that some requirement reads had its first value, and what is stale.

    Args:
        spec: of the requirements.
        requirements: that are judged.
        alone: whether they are all; else what they do not read becomes stale elsewhere.
    """
    if not requirements:
        if spec.gap not in _IDLE:
            _IDLE[spec.gap] = generated(spec, graph_of(()), (), {}, Evaluator)
        return _IDLE[spec.gap]
    key = (alone, *(one.rank for one in requirements))
    cached = requirements[0].evaluators
    if key not in cached:
        shared = [one for one in requirements if one.requirement.for_each is None]
        graph = graph_of(node for one in shared for node in one.shared_graph.nodes)
        names = {name for one in requirements for name in one.reads}
        if alone:
            perishable = (name for name, one in spec.signals.items() if one.stale_after is not None)
            names.update(perishable)
        uses = _uses_of([graph], shared)
        cached[key] = generated(spec, graph, {*names, *uses}, uses, Evaluator)
    made: type[Evaluator] = cached[key]
    return made


def class_of(compiled: CompiledRequirement, *, starts: bool) -> type[Evaluator]:
    """The class of the evaluators of a requirement's instances, or of its captured attempts.

    Args:
        compiled: the requirement, or what judges its attempts in doubt.
        starts: whether attempts start in it.
    """
    key = "instances" if starts else "attempts"
    if key not in compiled.evaluators:
        graph = compiled.shared_graph if starts else compiled.consequent_graph
        uses = _uses_of([graph], [compiled] if starts else [])
        compiled.evaluators[key] = generated(compiled.spec, graph, uses, uses, Evaluator)
    made: type[Evaluator] = compiled.evaluators[key]
    return made


def generated(
    spec: CheckedSpec,
    graph: Graph,
    names: Iterable[str],
    uses: Mapping[str, Uses],
    base: type[Made],
) -> type[Made]:
    """A class of evaluators.

    Args:
        spec: declares the names.
        graph: the formulas.
        names: the signals and events to keep something of.
        uses: what is asked of them.
        base: what it derives from.
    """
    plan = plan_of_evaluator(spec, graph, names, uses)
    made = evaluator_class(plan, base)
    made.graph, made.SPARSE, made.SPAN = graph, sparse_nodes(plan), sparse_span(plan)
    return made


def _uses_of(graphs: list[Graph], capturing: Iterable[CompiledRequirement]) -> dict[str, Uses]:
    """What is asked of signals and events, also by the captured attempts of requirements."""
    captured = []
    for compiled in capturing:
        if compiled.requirement.captures:
            graphs += [one.consequent_graph for one in compiled.judges.values()]
            captured += [capture.value for capture in compiled.requirement.captures]
    return uses_of(graphs, captured)
