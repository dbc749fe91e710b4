"""What compiled monitors take: whole numbers that doubles compute with as Python does."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import assert_never

from rvmon.errors import TraceError
from rvmon.formula.numeric import operands
from rvmon.plan.plan import Plan
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    FieldValue,
    Literal,
    Numeric,
    SignalValue,
    UpdateFunction,
    UpdateValue,
)
from rvmon.spec.checked.specification import Requirement
from rvmon.trace.time import TICKS_PER_SECOND, format_ticks

EXACT = 1 << 53
"""Up to this magnitude doubles hold all whole numbers."""

_LIMITS = (*(EXACT >> shift for shift in range(54)), 0)


def whole_limits(plan: Plan) -> Mapping[str, int]:
    """By signal and `event.field`, the greatest magnitude of whole numbers that C computes exactly.

    Floats have no limit: Python computes with doubles, too, where one takes part.
    """
    limits = dict.fromkeys(plan.signals, EXACT)
    for event in plan.events:
        limits |= {f"{event}.{field}": EXACT for field in plan.spec.events[event].fields}
    for expression in (one for part in (plan, *plan.units) for one in _compared(part)):
        limit = next(limit for limit in _LIMITS if limit == 0 or _stays_exact(expression, limit))
        for name in map(_input, operands(expression)):
            if name is not None:
                limits[name] = min(limits[name], limit)
    return limits


def too_large(name: str, value: int, limit: int, t: int) -> TraceError:
    """The error that a whole number of a sample is beyond what doubles compute with exactly."""
    return TraceError(
        f"sample at {format_ticks(t)}: `{name}` is {reprlib.repr(value)}, but compiled monitors "
        f"compute with doubles, here exactly up to {limit} only: use the engine `auto`, "
        "or make it a float"
    )


def _compared(plan: Plan) -> Iterator[Numeric]:
    """What is compared or captured, captured values spelt out."""
    captured: dict[str, Numeric] = {}
    for rule in plan.rules:
        captured |= spelt_out(rule.requirement)
    yield from captured.values()
    for state in plan.graph.nodes:
        if isinstance(state.leaf, Compare):
            yield _spelt_out(state.leaf.left, captured)
            yield _spelt_out(state.leaf.right, captured)


def spelt_out(requirement: Requirement) -> Mapping[str, Numeric]:
    """By name, the values that a requirement captures, in their order, by what is read."""
    each = requirement.for_each
    captured: dict[str, Numeric] = {} if each is None else {each.name: each.value}
    for capture in requirement.captures:
        captured[capture.name] = _spelt_out(capture.value, captured)
    return captured


def is_whole(expression: Numeric) -> bool:
    """Whether the result is a whole number if all that is read are."""
    return _size(expression, 1) is not None


def _spelt_out(expression: Numeric, captured: Mapping[str, Numeric]) -> Numeric:
    match expression:
        case Captured(name=name):
            return captured[name]
        case Arithmetic(args=args):
            return replace(expression, args=tuple(_spelt_out(arg, captured) for arg in args))
        case _:
            return expression


def _input(part: Numeric) -> str | None:
    match part:
        case SignalValue(name=name) | UpdateValue(name=name):
            return name
        case FieldValue(event=event, field=field):
            return f"{event}.{field}"
        case _:
            return None


def _stays_exact(expression: Numeric, limit: int) -> bool:
    """Whether no whole number in between is too large, if those that are read have a limit."""
    match expression:
        case Arithmetic(args=args):
            size = _size(expression, limit)
            return (size is None or size <= EXACT) and all(_stays_exact(a, limit) for a in args)
        case UpdateValue(function=UpdateFunction.RATE):
            # The powers of two in the ticks of a second do not count.
            return 2 * limit * TICKS_PER_SECOND <= EXACT << 9
        case UpdateValue(function=UpdateFunction.DELTA):
            return 2 * limit <= EXACT
        case _:
            return True


def _size(expression: Numeric, limit: int) -> int | None:
    """The greatest magnitude of a result that is a whole number; `None`: it is always a float."""
    match expression:
        case Literal(value=value):
            return abs(value) if isinstance(value, int) else None
        case SignalValue() | FieldValue():
            return limit
        case UpdateValue(function=UpdateFunction.RATE):
            return None
        case UpdateValue():
            return 2 * limit
        case Arithmetic(op=op, args=args):
            return _size_of_result(op, [_size(arg, limit) for arg in args])
        case Captured():
            raise AssertionError("it stands for what it captures")
        case _:
            assert_never(expression)


def _size_of_result(op: NumericOp, sizes: Sequence[int | None]) -> int | None:
    whole = [size for size in sizes if size is not None]
    picks = op.entry.most is None  # one of its arguments, whatever the others are
    if op.entry.largest is None or not whole or (len(whole) < len(sizes) and not picks):
        return None
    return op.entry.largest(whole)
