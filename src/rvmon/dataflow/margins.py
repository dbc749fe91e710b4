"""By how much a leaf holds or fails to at the current position."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Leaf
from rvmon.plan.numbers import events_of
from rvmon.runtime.expressions import Input, reader
from rvmon.spec.checked.arithmetic import UnitRule
from rvmon.spec.checked.formula import (
    Arithmetic,
    Compare,
    CompareOp,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateValue,
)
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.syntax.units import parse_unit
from rvmon.trace.sample import Payload, Scalar

INFINITE = float("inf")

Margin = tuple[float, float]
"""Least and greatest value that the robustness can have, given what is not known."""

OF_TRUTH: Mapping[int, Margin] = {
    FALSE: (-INFINITE, -INFINITE),
    UNKNOWN: (-INFINITE, INFINITE),
    TRUE: (INFINITE, INFINITE),
}
"""What a proposition that is no comparison of numbers counts as."""


def margin_reader(
    leaf: Leaf,
    truth: Callable[[], int],
    inputs: Input,
    captured: Mapping[str, Scalar],
    spec: CheckedSpec,
) -> Callable[[], Margin]:
    """A function that gives the robustness of a leaf at the current position, in base units.

    Args:
        leaf: any.
        truth: gives its truth there; before the birth of its signals, what it is taken for.
        inputs: read at each call.
        captured: values of `let` and `for each`.
        spec: gives the units.

    Source: SEMANTICS 5.
    """
    if not isinstance(leaf, Compare):
        return lambda: OF_TRUTH[truth()]
    left = reader(leaf.left, inputs, captured)
    right = reader(leaf.right, inputs, captured)
    op, factor = leaf.op, base_factor(leaf, spec)

    def of(payloads: Mapping[str, Payload]) -> Margin:
        return margin(op, left(payloads), right(payloads), factor)

    def of_signals() -> Margin:
        found = of({})
        return OF_TRUTH[truth()] if found is OF_TRUTH[UNKNOWN] else found

    events = events_of(leaf.left, leaf.right)

    def of_occurrences() -> Margin:
        found = OF_TRUTH[FALSE]
        for chosen in product(*map(inputs.payloads_of, events)):
            payloads = {e: p for e, p in zip(events, chosen, strict=True) if p is not None}
            own = of(payloads) if len(payloads) == len(events) else OF_TRUTH[UNKNOWN]
            found = max(found[0], own[0]), max(found[1], own[1])
        return OF_TRUTH[truth()] if found == OF_TRUTH[UNKNOWN] else found

    return of_occurrences if events else of_signals


def margin(op: CompareOp, left: Scalar, right: Scalar, factor: float) -> Margin:
    """By how much a comparison holds; what is not known may be anything.

    >>> margin(CompareOp.LT, 3.0, 5.0, 0.01)
    (0.02, 0.02)
    """
    if left is None or right is None:
        return OF_TRUTH[UNKNOWN]
    if isinstance(left, str) or isinstance(right, str):
        return OF_TRUTH[TRUE if op.holds(left, right) else FALSE]
    value = signed(op, _difference(left, right, factor))
    return value, value


def signed(op: CompareOp, difference: Any) -> Any:
    """By how much a comparison holds, given how far its left side is above the right one.

    Args:
        op: the comparison.
        difference: a number, or an array of them.
    """
    match op:
        case CompareOp.LT | CompareOp.LE:
            return -difference
        case CompareOp.GT | CompareOp.GE:
            return difference
        case CompareOp.EQ:
            return -abs(difference)
        case CompareOp.NE:
            return abs(difference)


def _difference(left: float, right: float, factor: float) -> float:
    """One number less another; infinite where that is beyond what a float can be."""
    if left == right:
        return 0.0
    try:
        return (left - right) * factor
    except OverflowError:  # of an integer, which has no greatest
        return math.copysign(INFINITE, 1 if left > right else -1)


def base_factor(leaf: Compare, spec: CheckedSpec) -> float:
    """What the unit of a comparison is in base units; 1 where it is not plain."""
    for side in (leaf.left, leaf.right):
        if isinstance(side, Literal) and side.unit:
            return float(parse_unit(side.unit).factor)
    units = (_unit(side, spec) for side in (leaf.left, leaf.right))
    found = next((unit for unit in units if unit), "")
    return float(parse_unit(found).factor)


def _unit(expression: Numeric, spec: CheckedSpec) -> str:
    """The unit that an expression's values come in, "" if it has none or is a product."""
    match expression:
        case Literal(unit=unit):
            return unit
        case SignalValue(name=name) | UpdateValue(name=name):
            return spec.signals[name].type.unit
        case FieldValue(event=event, field=field):
            return spec.events[event].fields[field].unit
        case Arithmetic(op=op, args=args) if op.entry.unit is UnitRule.SAME:
            return next((unit for arg in args if (unit := _unit(arg, spec))), "")
        case _:
            return ""
