"""Operators applied to resolved expressions: constants folded, clocks only where they may be."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics import Span
from rvmon.timed.language.symbols import is_alike, leaves, value_of
from rvmon.timed.model.arithmetic import apply_binary, apply_unary, check_shift
from rvmon.timed.model.expressions import (
    MAX_TIME,
    TRUE,
    BinaryOperation,
    ClockCompare,
    ClockOp,
    Constant,
    Expression,
    UnaryOperation,
)
from rvmon.timed.model.guards import is_discrete
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error
from rvmon.timed.model.scope import Symbol

COMPARISONS = {BinaryOp.LT, BinaryOp.LE, BinaryOp.EQ, BinaryOp.NE, BinaryOp.GE, BinaryOp.GT}
SAMENESS = {BinaryOp.EQ, BinaryOp.NE}
MIRRORED = {
    BinaryOp.LT: BinaryOp.GT,
    BinaryOp.LE: BinaryOp.GE,
    BinaryOp.GE: BinaryOp.LE,
    BinaryOp.GT: BinaryOp.LT,
    BinaryOp.EQ: BinaryOp.EQ,
    BinaryOp.NE: BinaryOp.NE,
}
_CONNECTIVES = {BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLY, BinaryOp.EQ, BinaryOp.NE}
_PLACED = {BinaryOp.DIV, BinaryOp.MOD, BinaryOp.SHIFT_LEFT, BinaryOp.SHIFT_RIGHT}


def compare_clock(clock: int, op: BinaryOp, bound: Expression, span: Span) -> Expression:
    """A comparison of a clock as one or two bounds.

    Raises:
        ModelError: the bound is no number of units of time.
    """
    if not is_discrete(bound):
        raise model_error("TA008", "a clock compared with clocks", span)
    if isinstance(bound, Constant) and not 0 <= bound.value < MAX_TIME:
        fix = f"clocks are compared with numbers from 0 to {MAX_TIME - 1:,}"
        raise model_error("TA007", f"a clock compared with {bound.value}", span, fix)
    match op:
        case BinaryOp.EQ:
            return BinaryOperation(
                BinaryOp.AND,
                ClockCompare(clock, ClockOp.GE, bound),
                ClockCompare(clock, ClockOp.LE, bound),
            )
        case BinaryOp.NE:
            return BinaryOperation(
                BinaryOp.OR,
                ClockCompare(clock, ClockOp.LT, bound),
                ClockCompare(clock, ClockOp.GT, bound),
            )
        case _:
            return ClockCompare(clock, ClockOp(op.value), bound)


def unary(op: UnaryOp, operand: Expression, span: Span) -> Expression:
    """An operator on one operand.

    Raises:
        ModelError: the operand speaks of clocks or runs, and the operator is arithmetic.
    """
    if op is not UnaryOp.NOT:
        refuse_clocks(operand, span)
    if isinstance(operand, Constant):
        return Constant(apply_unary(op, operand.value))
    return UnaryOperation(op, operand)


def refuse_clocks(operand: Expression, span: Span) -> None:
    """Refuse what has no value in a discrete state."""
    if not is_discrete(operand):
        fix = "arithmetic is for numbers; join conditions by and, or, not, imply"
        raise model_error("TA009", "a condition on clocks or runs is no number", span, fix)


def binary(op: BinaryOp, left: Expression, right: Expression, span: Span) -> Expression:
    """An operator on two operands.

    Raises:
        ModelError: an operand speaks of clocks or runs and the operator is arithmetic; a constant
            divisor is 0, or a constant shift none.
    """
    if op not in _CONNECTIVES:
        refuse_clocks(left, span)
        refuse_clocks(right, span)
    match op, left, right:
        case BinaryOp.DIV | BinaryOp.MOD, _, Constant(0):
            raise model_error("TA007", "division by zero", span)
        case BinaryOp.SHIFT_LEFT | BinaryOp.SHIFT_RIGHT, _, Constant(bits):
            check_shift(bits, span)
    match op, left, right:
        case _, Constant(a), Constant(b):
            return Constant(apply_binary(op, a, b))
        case BinaryOp.AND, Constant(value), other:
            return truth(other) if value else Constant(0)
        case BinaryOp.OR, Constant(value), other:
            return TRUE if value else truth(other)
        case BinaryOp.IMPLY, Constant(value), other:
            return truth(other) if value else TRUE
        case BinaryOp.IMPLY, other, Constant(0):
            return UnaryOperation(UnaryOp.NOT, other)
        case _:
            return BinaryOperation(op, left, right, span if op in _PLACED else None)


def joined(op: BinaryOp, parts: Sequence[Expression], span: Span) -> Expression:
    """Conditions joined as a balanced tree, which stays shallow however many there are."""
    if len(parts) == 1:
        return parts[0] if op is BinaryOp.ADD else truth(parts[0])
    half = len(parts) // 2
    return binary(op, joined(op, parts[:half], span), joined(op, parts[half:], span), span)


def truth(expression: Expression) -> Expression:
    """The expression, which counts as a truth value where it stands."""
    return Constant(int(bool(expression.value))) if isinstance(expression, Constant) else expression


def whole_compare(op: BinaryOp, left: Symbol, right: Symbol, span: Span) -> Expression:
    """Arrays or records compared part by part.

    Raises:
        ModelError: they do not have the same parts.
    """
    if not is_alike(left, right):
        raise model_error("TA004", "these are not of one type", span)
    values = ((value_of(leaf, span) for leaf in leaves(side)) for side in (left, right))
    parts = [binary(BinaryOp.EQ, one, other, span) for one, other in zip(*values, strict=True)]
    same = joined(BinaryOp.AND, parts, span)
    return same if op is BinaryOp.EQ else unary(UnaryOp.NOT, same, span)
