"""A response monitor derived from a property by the roles of its signals (SEMANTICS 4.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

from rvmon.diagnostics.span import Span
from rvmon.spec.check.normalise import joined
from rvmon.spec.check.table import Table
from rvmon.spec.checked.ctl import PathUnary, Property, StateAtom
from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Formula,
    Interval,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.reads import names_read
from rvmon.spec.checked.specification import Event, Role, Signal
from rvmon.spec.rules import properties as rules
from rvmon.spec.rules.rule import Refusal


def derived_response(
    table: Table, property_: Property, within: int, place: Span
) -> tuple[Formula, Formula]:
    """Trigger and consequent of the monitor that awaits the outputs upon the inputs.

    Args:
        table: gives the roles.
        property_: `E<> (conjunction)`.
        within: the deadline, ticks.
        place: of the `monitor` clause.

    Raises:
        Refusal: the property has another form, a conjunct mixes roles, or there is no output.

    Source: SEMANTICS, section 4, third use.
    """
    goal = property_.formula
    span = property_.span or place
    if not isinstance(goal, PathUnary) or goal.universal or goal.op is not UnaryOp.EVENTUALLY:
        raise Refusal(rules.no_response(span))
    if not isinstance(goal.operand, StateAtom) or goal.interval != Interval():
        raise Refusal(rules.no_response(goal.operand.span or span))
    by_role: dict[Role, list[Formula]] = {Role.INPUT: [], Role.OUTPUT: []}
    for conjunct in _conjuncts(goal.operand.formula):
        by_role[_role(table, conjunct, conjunct.span or span)].append(conjunct)
    if not by_role[Role.OUTPUT]:
        raise Refusal(rules.no_output(span))
    inputs = by_role[Role.INPUT]
    trigger = _conjunction(inputs) if inputs else BoundAtom(Bound.START, place)
    return trigger, _owed(by_role[Role.OUTPUT], Interval(0, within))


def _owed(outputs: Sequence[Formula], interval: Interval) -> Formula:
    """Positive outputs have to come together, each negated one has to stay away."""
    negated = [part for part in outputs if isinstance(part, Unary) and part.op is UnaryOp.NOT]
    positive = [part for part in outputs if part not in negated]
    owed: list[Formula] = []
    if positive:
        goal = _conjunction(positive)
        owed.append(Unary(UnaryOp.EVENTUALLY, goal, interval, goal.span))
    owed += [Unary(UnaryOp.ALWAYS, part, interval, part.span) for part in negated]
    return _conjunction(owed)


def _role(table: Table, conjunct: Formula, place: Span) -> Role:
    declared: Mapping[str, Signal | Event] = {**table.signals, **table.events}
    roles = {name: declared[name].role for name in names_read(conjunct)}
    for name, role in roles.items():
        if role is None:
            raise Refusal(rules.no_role(place, name))
    found = set(roles.values())
    if len(found) != 1:
        raise Refusal(rules.mixed_roles(place, {name: str(role) for name, role in roles.items()}))
    return Role(str(found.pop()))


def _conjuncts(formula: Formula) -> list[Formula]:
    found: list[Formula] = []
    waiting = [formula]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Binary) and node.op is BinaryOp.AND:
            waiting += (node.right, node.left)
        else:
            found.append(node)
    return found


def _conjunction(parts: Sequence[Formula]) -> Formula:
    def both(left: Formula, right: Formula) -> Formula:
        return Binary(BinaryOp.AND, left, right, None, joined(left.span, right.span))

    return reduce(both, parts)
