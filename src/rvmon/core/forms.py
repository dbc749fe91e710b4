"""Packs formulas that are evaluated as networks, for verdicts and for robustness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum, auto
from typing import assert_never

from rvmon.core.sections import Listed, Section, Sections
from rvmon.language.checked.arithmetic import UnitRule
from rvmon.language.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
    WindowValue,
)
from rvmon.language.checked.formula import Literal as Number
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.checked.window_measures import Dimension
from rvmon.logic.formula import Constant, Literal, Sense
from rvmon.logic.network_plan import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, State, events_of
from rvmon.logic.window_chains import Chain, reach_of
from rvmon.trace.schema import Kind
from rvmon.units import parse_unit

_FARTHEST = (1 << 62) - 2
"""The bound, in ticks, to which offsets are clamped; no two instants are farther apart."""

_NEVER = (1 << 63) - 1

_PAST = -1
"""The deadline field of a window of the past."""

_WORSE, _BETTER = 1, 2


class Operator(IntEnum):
    """Kinds of operators."""

    LEAF = 0
    JUNCTION = auto()
    WINDOW = auto()
    SHIFT = auto()
    UNTIL = auto()
    SINCE = auto()


def add_form(
    sections: Sections, plan: NetworkPlan, chain: Chain | None, index: Mapping[State, int]
) -> int:
    """Add the formula of a network; returns its index.

    Args:
        sections: the sections of the plan.
        plan: the network of the formula.
        chain: its description as a chain; `None` if it is not one.
        index: the node of each proposition.
    """
    operators = add_operators(sections, plan, index)
    own: tuple[int, ...] = (*sections.listed(()), -1, -1, -1)
    if chain is not None:
        ends = (-1 if place is None else place for place in (chain.left, chain.excused))
        own = (*sections.listed(chain.places), chain.base, *ends)
    reach = reach_of(plan)
    ticks = _NEVER if reach is None else min(reach, _FARTHEST)
    return sections.add(
        Section.FORMS, ticks, *operators, len(plan.leaves), plan.looks_back, *own, 0
    )


def add_operators(sections: Sections, plan: NetworkPlan, index: Mapping[State, int]) -> Listed:
    """Add the nodes of a network; see `add_form`."""
    first = sections.count(Section.OPERATORS)
    leaves = 0
    for node in plan.nodes:
        _add(sections, plan, node, leaves, index)
        leaves += isinstance(node, Leaf)
    return first, len(plan.nodes)


def _add(
    sections: Sections, plan: NetworkPlan, node: Node, leaves: int, index: Mapping[State, int]
) -> None:
    def add(
        kind: Operator,
        left: int = -1,
        right: int = -1,
        *,
        turned: bool = False,
        kept: bool = False,
        ticks: tuple[int, int, int] = (0, 0, 0),
        operands: Sequence[int] = (),
        values: Sequence[int] = (0, 0, 0),
    ) -> None:
        bounded = (max(-_FARTHEST, min(tick, _FARTHEST)) for tick in ticks)
        listed = sections.listed(operands)
        how = kind, turned, kept, left, right
        sections.add(Section.OPERATORS, *bounded, *how, *listed, *values)

    match node:
        case Leaf(core=core):
            place = -1 if isinstance(core, Constant) else index[core.proposition]
            add(Operator.LEAF, leaves, place, values=_values(core))
        case Junction(operands=operands, every=every):
            add(Operator.JUNCTION, turned=every, operands=operands)
        case Window(operand=operand, low=low, high=high, every=every, over=over):
            ticks = low, high, _PAST if over is None else over
            add(Operator.WINDOW, operand, turned=every, ticks=ticks)
        case Sweep(left=left, right=right, future=future, dual=dual, kept=kept):
            kind = Operator.UNTIL if future else Operator.SINCE
            add(kind, left, right, turned=dual, kept=kept)
        case Shift(operand=operand, offset=offset, opens=opens):
            kept = plan.sweep_of(node).kept
            add(Operator.SHIFT, operand, kept=kept, ticks=(offset, offset, opens))
        case _:
            assert_never(node)


def _values(core: Literal | Constant) -> list[int]:
    """The two-bit reading (pessimistic, optimistic) of a leaf for FALSE, UNKNOWN and TRUE."""
    if isinstance(core, Constant):
        return [(_WORSE + _BETTER) * core.value] * 3
    wanted = TRUE if core.sense is Sense.TRUE else FALSE
    # An unknown literal is false in the pessimistic run and true in the optimistic one; a test of
    # knowledge is false in both.
    unknown = 0 if core.sense is Sense.KNOWN_FALSE else _BETTER
    return [
        unknown if value == UNKNOWN else (_WORSE + _BETTER) * (value == wanted)
        for value in (FALSE, UNKNOWN, TRUE)
    ]


class Measure(IntEnum):
    """The ways to compute the robustness of a leaf."""

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
    """Add the robustness formula of the judge added last."""
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
    """The measure of a leaf: factor to base units, kind, whether it is negated, and its node."""
    if isinstance(core, Constant):
        return 1.0, Measure.CONSTANT, not core.value, -1
    state = core.proposition
    node = index[state]
    if core.sense is Sense.KNOWN_FALSE:
        return 1.0, Measure.DENIED, False, node
    turned = core.sense is not Sense.TRUE
    leaf = state.leaf or state.compared
    if not isinstance(leaf, Compare) or _compares_labels(leaf, spec, requirement):
        return 1.0, Measure.TRUTH, turned, node
    return base_factor(leaf, spec), Measure.DISTANCE, turned, node


def is_followed(core: Literal | Constant, spec: CheckedSpec, requirement: Requirement) -> bool:
    """Whether measuring a leaf needs its node to be kept up to date once all signals are born.

    A distance is computed from the values alone, without the node.
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
    """Whether a comparison is between labels, which have no distance."""
    values = {capture.name: capture.value for capture in requirement.captures}
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
    """The factor from the unit of a comparison to SI base units; 1 if the unit is a product."""
    sides = (leaf.left, leaf.right)
    written: Sequence[str] = [side.unit for side in sides if isinstance(side, Number) and side.unit]
    units = [*written, *(_unit(side, spec) for side in sides)]
    return float(parse_unit(next((unit for unit in units if unit), "")).factor)


def _unit(expression: Numeric, spec: CheckedSpec) -> str:
    """The unit of an expression's value; "" if it has none or it is a product."""
    match expression:
        case Number(unit=unit):
            return unit
        case SignalValue(name=name) | UpdateValue(name=name):
            return spec.signals[name].type.unit
        case FieldValue(event=event, field=field):
            return spec.events[event].fields[field].unit
        case WindowValue(measured=measured, value=value) if value is not None:
            return _unit(value, spec) if measured.dimension is Dimension.SAME else ""
        case Arithmetic(op=op, args=args) if op.entry.unit in (UnitRule.SAME, UnitRule.TURN):
            return next((unit for arg in args if (unit := _unit(arg, spec))), "")
        case _:
            return ""
