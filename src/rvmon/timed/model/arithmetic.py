"""What operators do with numbers, and what they refuse."""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.timed.model.expressions import MAX_TIME, Variable
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error


def apply_unary(op: UnaryOp, value: int) -> int:
    """The value of an operator on one operand."""
    match op:
        case UnaryOp.NOT:
            return int(not value)
        case UnaryOp.NEGATE:
            return -value
        case UnaryOp.INVERT:
            return ~value
        case _:
            assert_never(op)


def apply_binary(op: BinaryOp, left: int, right: int) -> int:
    """The value of an operator on two operands; division truncates, as in C.

    >>> apply_binary(BinaryOp.DIV, -7, 2), apply_binary(BinaryOp.MOD, -7, 2)
    (-3, -1)
    """
    return OPERATIONS[op](left, right)


def _divide(left: int, right: int) -> int:
    quotient = abs(left) // abs(right)
    return quotient if (left < 0) == (right < 0) else -quotient


OPERATIONS: dict[BinaryOp, Callable[[int, int], int]] = {
    BinaryOp.AND: lambda a, b: int(bool(a) and bool(b)),
    BinaryOp.OR: lambda a, b: int(bool(a) or bool(b)),
    BinaryOp.IMPLY: lambda a, b: int(not a or bool(b)),
    BinaryOp.LT: lambda a, b: int(a < b),
    BinaryOp.LE: lambda a, b: int(a <= b),
    BinaryOp.EQ: lambda a, b: int(a == b),
    BinaryOp.NE: lambda a, b: int(a != b),
    BinaryOp.GE: lambda a, b: int(a >= b),
    BinaryOp.GT: lambda a, b: int(a > b),
    BinaryOp.ADD: lambda a, b: a + b,
    BinaryOp.SUB: lambda a, b: a - b,
    BinaryOp.MUL: lambda a, b: a * b,
    BinaryOp.DIV: _divide,
    BinaryOp.MOD: lambda a, b: a - b * _divide(a, b),
    BinaryOp.BIT_AND: lambda a, b: a & b,
    BinaryOp.BIT_OR: lambda a, b: a | b,
    BinaryOp.BIT_XOR: lambda a, b: a ^ b,
    BinaryOp.SHIFT_LEFT: lambda a, b: a << b,
    BinaryOp.SHIFT_RIGHT: lambda a, b: a >> b,
    BinaryOp.MINIMUM: min,
    BinaryOp.MAXIMUM: max,
}


def check_shift(bits: int, span: Span | None) -> int:
    """Refuse a number of bits by which no number of 32 bits can be shifted."""
    if not 0 <= bits < 32:
        raise model_error("TA007", f"a shift by {bits} bits", span, "shift by 0 to 31 bits")
    return bits


def check_index(position: int, extent: range, span: Span | None) -> None:
    """Refuse an index outside its array."""
    if position not in extent:
        fix = (
            f"the indices are {extent.start} to {extent.stop - 1}: "
            "guard the edge, or narrow the index's type"
        )
        raise model_error("TA007", f"index {position} is outside the array", span, fix)


def fitting(number: int, variable: Variable, span: Span | None) -> int:
    """The number as a variable holds it.

    Raises:
        ModelError: it lies outside the variable's range.
    """
    if variable.is_bool:
        return int(bool(number))
    if variable.is_real:
        return number
    if not variable.low <= number <= variable.high:
        limits = f"[{variable.low}, {variable.high}]"
        message = f"`{variable.name}` is set to {number}, outside {limits}"
        raise model_error("TA007", message, span, "guard the edge, or widen the range")
    return number


def check_time(number: int, span: Span | None) -> int:
    """Refuse a number that no clock can be compared with or set to."""
    if not 0 <= number < MAX_TIME:
        fix = f"keep it from 0 to {MAX_TIME - 1:,}, or choose a larger unit of time"
        raise model_error("TA007", f"{number} is no time for a clock", span, fix)
    return number
