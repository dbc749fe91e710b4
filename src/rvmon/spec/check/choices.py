"""Choices between numbers: what is made of one is a choice between what is made of both."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rvmon.diagnostics.span import Span
from rvmon.spec.check.values import Age, AmountOf, Chosen, Extreme, Quantity, Value
from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Unary, UnaryOp
from rvmon.spec.rules import types as rules
from rvmon.spec.rules.rule import Refusal

MOST_OUTCOMES = 64
"""Between so many numbers an expression may choose."""


def spread(values: Sequence[Value], span: Span, made: Callable[[Sequence[Value]], Value]) -> Value:
    """What is made of values, some of which may be choices.

    Raises:
        Refusal: they have too many outcomes, or what `made` says.
    """
    outcomes = 1
    for value in values:
        outcomes *= _outcomes(value)
    if outcomes > MOST_OUTCOMES:
        raise Refusal(rules.many_outcomes(span, MOST_OUTCOMES))
    return _spread(values, made)


def _outcomes(value: Value) -> int:
    if isinstance(value, Chosen):
        return _outcomes(value.chosen) + _outcomes(value.otherwise)
    return 1


def _spread(values: Sequence[Value], made: Callable[[Sequence[Value]], Value]) -> Value:
    for number, value in enumerate(values):
        if isinstance(value, Chosen):
            before, behind = values[:number], values[number + 1 :]
            sides = [
                _spread((*before, side, *behind), made) for side in (value.chosen, value.otherwise)
            ]
            return Chosen(value.condition, *sides)
    return made(values)


def decided(value: Value, span: Span) -> Formula:
    """A choice between formulas, as one."""
    if isinstance(value, Chosen):
        chosen, otherwise = decided(value.chosen, span), decided(value.otherwise, span)
        return either(value.condition, chosen, otherwise, span)
    if isinstance(value, Quantity | Age | AmountOf | Extreme):
        raise AssertionError("it was made of formulas")
    return value


def either(condition: Formula, chosen: Formula, otherwise: Formula, span: Span) -> Formula:
    """`if φ then ψ else χ`, which is known where both sides are the same, whatever φ is."""
    denied = Unary(UnaryOp.NOT, condition, None, span)
    first = Binary(BinaryOp.AND, condition, chosen, None, span)
    second = Binary(BinaryOp.AND, denied, otherwise, None, span)
    both = Binary(BinaryOp.AND, chosen, otherwise, None, span)
    one = Binary(BinaryOp.OR, first, second, None, span)
    return Binary(BinaryOp.OR, one, both, None, span)
