"""Formulas of a requirement as state formulas, and what these read of a recording."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from rvmon.formula.factory import Factory
from rvmon.formula.four import Reader
from rvmon.formula.numeric import operands
from rvmon.formula.state import UNKNOWN, Elapsed, Lapsed, Leaf, Lost, State, Unborn
from rvmon.plan.graph import Graph, graph_of
from rvmon.spec.checked.formula import (
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Literal,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
)
from rvmon.spec.checked.specification import CheckedSpec, Requirement, TimeModel


def state_of(formula: Formula, factory: Factory, spec: CheckedSpec) -> State:
    """A formula of present and past only, as the flow reads it; what is not born is unknown."""
    return Reader(factory, spec.period).four(formula).read(UNKNOWN)


def values_read(
    spec: CheckedSpec, requirement: Requirement, formulas: Iterable[Formula]
) -> Graph | None:
    """Some formulas of a requirement, if the values of what they read are all that counts.

    Returns:
        `None` if updates that repeat a value, payloads or positions may make a difference.
    """
    stale = {name for name, signal in spec.signals.items() if signal.stale_after is not None}
    if spec.time is TimeModel.SAMPLED or requirement.for_each is not None:
        return None
    factory = Factory()
    graph = graph_of(state_of(formula, factory, spec) for formula in formulas)
    leaves = [node.leaf for node in graph.nodes if node.leaf is not None]
    of_values = all(map(_is_of_values, leaves)) and stale.isdisjoint(graph.by_name)
    return graph if of_values else None


def _is_of_values(leaf: Leaf) -> bool:
    match leaf:
        case Compare(left=left, right=right):
            parts = (part for side in (left, right) for part in operands(side))
            return all(isinstance(part, SignalValue | Literal) for part in parts)
        case ProbeAtom(probe=probe):
            return probe is Probe.KNOWN
        case SignalAtom() | EventAtom() | BoundAtom() | Constant():
            return True
        case Elapsed() | Unborn() | Lost() | Lapsed():
            return True
        case _:
            assert_never(leaf)
