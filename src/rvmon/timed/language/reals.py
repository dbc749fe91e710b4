"""Expressions of numbers with a fraction: which are, and how integers join them."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics import Span
from rvmon.timed.language.layout import Calls, check_count
from rvmon.timed.model.evaluate import evaluator
from rvmon.timed.model.expressions import (
    Choice,
    Constant,
    Expression,
    Fractional,
    Invoke,
    VariableValue,
)
from rvmon.timed.model.fractions import FUNCTIONS, OPERATIONS, gives_fraction, literal, number_of
from rvmon.timed.model.guards import is_discrete, is_fixed
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error

_CONNECTIVES = {BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLY}


def is_real(value: Expression, calls: Calls) -> bool:
    """Whether an expression has a fraction."""
    match value:
        case VariableValue(slot):
            return calls.variable(slot).is_real
        case Invoke(function):
            return function.result[1].is_real
        case Choice(_, then, otherwise):
            return is_real(then, calls) or is_real(otherwise, calls)
        case _:
            return gives_fraction(value)


def as_real(value: Expression, calls: Calls, span: Span) -> Expression:
    """The same number with a fraction, marked as one."""
    match value:
        case Fractional() if gives_fraction(value):
            return value
        case Constant(number):
            return literal(number)
        case Choice(test, then, otherwise) if is_real(value, calls):
            return Fractional(
                "=", (Choice(test, as_real(then, calls, span), as_real(otherwise, calls, span)),)
            )
        case _ if is_real(value, calls):
            return Fractional("=", (value,))
        case _ if is_discrete(value):
            return Fractional("double", (value,))
        case _:
            fix = "compare a clock, alone on its side"
            raise model_error("TA009", "a clock has no value here", span, fix)


def fitted(value: Expression, real: bool, calls: Calls, span: Span) -> Expression:
    """A value as a variable holds it, with a fraction or without.

    Raises:
        ModelError: it has one, and the variable has not.
    """
    if real:
        return as_real(value, calls, span)
    if is_real(value, calls):
        fix = "round it: fint(…)"
        raise model_error("TA004", "an integer is set to a number with a fraction", span, fix)
    return value


def binary(
    op: BinaryOp, left: Expression, right: Expression, span: Span, calls: Calls
) -> Expression | None:
    """An operator on two operands, if one has a fraction.

    Raises:
        ModelError: the operator is one of integers.
    """
    if op in _CONNECTIVES or not (is_real(left, calls) or is_real(right, calls)):
        return None
    if op not in OPERATIONS:
        raise model_error("TA004", f"`{op}` is for integers", span, "round them: fint(…)")
    return _made(op, [as_real(one, calls, span) for one in (left, right)], span)


def unary(op: UnaryOp, operand: Expression, span: Span, calls: Calls) -> Expression | None:
    """An operator on one operand, if that has a fraction."""
    if op is UnaryOp.NOT or not is_real(operand, calls):
        return None
    return binary(BinaryOp.SUB if op is UnaryOp.NEGATE else BinaryOp.BIT_XOR, Constant(0), operand,
                  span, calls)  # fmt: skip


def call(name: str, arguments: Sequence[Expression], span: Span, calls: Calls) -> Expression:
    """A function of UPPAAL's."""
    check_count(name, range(FUNCTIONS[name]), arguments, span)
    return _made(name, [as_real(one, calls, span) for one in arguments], span)


def bound(value: Expression, calls: Calls) -> Expression:
    """What a clock is compared with, or set to: a fraction of a unit becomes steps of the grid."""
    if not is_real(value, calls):
        return value
    if is_fixed(value) and (number := number_of(evaluator(value)((), ()))).is_integer():
        return Constant(int(number))
    return Fractional("grid", (value,))


def _made(name: str, operands: Sequence[Expression], span: Span) -> Expression:
    made = Fractional(name, tuple(operands), span)
    if not all(isinstance(one, Fractional) and is_literal(one) for one in operands):
        return made
    value = evaluator(made)((), ())
    return literal(number_of(value)) if gives_fraction(made) else Constant(value)


def is_literal(value: Fractional) -> bool:
    """Whether it is a number as it is written."""
    return value.name == "=" and isinstance(value.operands[0], Constant)
