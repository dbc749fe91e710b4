"""By how much what attempts owe holds: networks of formulas, and what their leaves count as."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum, auto

from rvmon.core.forms import add_operators
from rvmon.core.sections import Section, Sections
from rvmon.logic.formula import Constant, Literal, Sense
from rvmon.logic.network_plan import NetworkPlan
from rvmon.logic.state_formula import State, events_of
from rvmon.spec.checked.arithmetic import UnitRule
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.formula import Literal as Number
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.trace.schema import Kind
from rvmon.units import parse_unit


class Measure(IntEnum):
    """What a leaf is measured by."""

    CONSTANT = 0
    TRUTH = auto()
    DENIED = auto()
    DISTANCE = auto()


def add_margin(
    sections: Sections,
    plan: NetworkPlan,
    index: Mapping[State, int],
    spec: CheckedSpec,
    requirement: Requirement,
) -> None:
    """Add what is measured of the attempts of a judge, which is the next one.

    Args:
        sections: of the plan.
        plan: of the formula.
        index: the places of propositions.
        spec: gives the units.
        requirement: whose attempts they are.
    """
    measures = sections.count(Section.MEASURES)
    for _, core in plan.leaves:
        sections.add(Section.MEASURES, *_measure(core, index, spec, requirement), 0)
    operators = add_operators(sections, plan, index)
    count = len(plan.leaves)
    sections.add(Section.MARGINS, *operators, measures, count, plan.looks_back, 0)


def _measure(
    core: Literal | Constant,
    index: Mapping[State, int],
    spec: CheckedSpec,
    requirement: Requirement,
) -> tuple[float, int, int, int]:
    """Factor, kind, whether it is negated, and the node."""
    if isinstance(core, Constant):
        return 1.0, Measure.CONSTANT, not core.value, -1
    state = core.proposition
    node = index[state]
    if core.sense is Sense.KNOWN_FALSE:
        return 1.0, Measure.DENIED, False, node
    turned = core.sense is not Sense.TRUE
    leaf = state.leaf
    if not isinstance(leaf, Compare) or _compares_labels(leaf, spec, requirement):
        return 1.0, Measure.TRUTH, turned, node
    return base_factor(leaf, spec), Measure.DISTANCE, turned, node


def is_followed(core: Literal | Constant, spec: CheckedSpec, requirement: Requirement) -> bool:
    """Whether it matters to what is measured that a node of a leaf is kept up.

    A distance is read off the values; while something is not born all nodes are kept up.
    """
    if isinstance(core, Constant):
        return False
    leaf = core.proposition.leaf
    return (
        core.sense is Sense.KNOWN_FALSE
        or not isinstance(leaf, Compare)
        or bool(events_of(leaf.left, leaf.right))
        or _compares_labels(leaf, spec, requirement)
    )


def _compares_labels(leaf: Compare, spec: CheckedSpec, requirement: Requirement) -> bool:
    """Whether its sides are labels: two of them have no distance."""
    values = {one.name: one.value for one in requirement.captures}
    each = requirement.for_each
    if each is not None:
        values[each.name] = each.value

    def is_label(value: Numeric) -> bool:
        match value:
            case Number(value=str()):
                return True
            case SignalValue(name=name) | UpdateValue(function=UpdateFunction.PREV, name=name):
                return spec.signals[name].type.kind is Kind.LABEL
            case FieldValue(event=event, field=field):
                return spec.events[event].fields[field].kind is Kind.LABEL
            case Captured(name=name):
                return is_label(values[name])
            case _:
                return False

    return is_label(leaf.left) or is_label(leaf.right)


def base_factor(leaf: Compare, spec: CheckedSpec) -> float:
    """What the unit of a comparison is in base units; 1 where it is not plain."""
    sides = (leaf.left, leaf.right)
    written: Sequence[str] = [side.unit for side in sides if isinstance(side, Number) and side.unit]
    units = [*written, *(_unit(side, spec) for side in sides)]
    return float(parse_unit(next((unit for unit in units if unit), "")).factor)


def _unit(expression: Numeric, spec: CheckedSpec) -> str:
    """The unit that an expression's values come in, "" if it has none or is a product."""
    match expression:
        case Number(unit=unit):
            return unit
        case SignalValue(name=name) | UpdateValue(name=name):
            return spec.signals[name].type.unit
        case FieldValue(event=event, field=field):
            return spec.events[event].fields[field].unit
        case Arithmetic(op=op, args=args) if op.entry.unit in (UnitRule.SAME, UnitRule.TURN):
            return next((unit for arg in args if (unit := _unit(arg, spec))), "")
        case _:
            return ""
