"""Values of expressions: constants folded when a model is read, closures when it is explored."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.timed.model.expressions import (
    BinaryOperation,
    Choice,
    ClockCompare,
    Constant,
    Deadlock,
    Expression,
    InLocation,
    Lookup,
    PathFormula,
    Slot,
    UnaryOperation,
    VariableValue,
)
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error

Locations = Sequence[int]
"""The location of each automaton."""

Values = Sequence[int]
"""The value of each variable."""

Evaluator = Callable[[Locations, Values], int]


def apply_unary(op: UnaryOp, value: int) -> int:
    """The value of an operator on one operand."""
    match op:
        case UnaryOp.NOT:
            return int(not value)
        case UnaryOp.NEGATE:
            return -value
        case _:
            assert_never(op)


def apply_binary(op: BinaryOp, left: int, right: int) -> int:
    """The value of an operator on two operands; division truncates, as in C.

    >>> apply_binary(BinaryOp.DIV, -7, 2), apply_binary(BinaryOp.MOD, -7, 2)
    (-3, -1)
    """
    return _BINARY[op](left, right)


def _divide(left: int, right: int) -> int:
    quotient = abs(left) // abs(right)
    return quotient if (left < 0) == (right < 0) else -quotient


_BINARY: dict[BinaryOp, Callable[[int, int], int]] = {
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
}


def evaluator(expression: Expression) -> Evaluator:
    """Make a function of locations and variables for an expression without clocks.

    The connectives evaluate their right side only if it matters, so that `i < N and a[i] > 0`
    never leaves the array.
    """
    match expression:
        case Constant(value):
            return lambda _locations, _values: value
        case VariableValue(Slot(first, ())):
            return lambda _locations, values: values[first]
        case VariableValue(slot):
            element = slot_evaluator(slot)
            return lambda locations, values: values[element(locations, values)]
        case Lookup(table, extent, index, span):
            return _lookup(table, extent, evaluator(index), span)
        case InLocation(automaton, location):
            return lambda locations, _values: int(locations[automaton] == location)
        case UnaryOperation(op, operand):
            return _unary_evaluator(op, evaluator(operand))
        case BinaryOperation(BinaryOp.AND | BinaryOp.OR as op, _, _):
            return _chain_evaluator(op, chained(op, expression))
        case BinaryOperation(op, left, right, span):
            return _binary_evaluator(op, evaluator(left), evaluator(right), span)
        case Choice(condition, then, otherwise):
            test, yes, no = evaluator(condition), evaluator(then), evaluator(otherwise)
            return lambda locations, values: (
                yes(locations, values) if test(locations, values) else no(locations, values)
            )
        case ClockCompare() | Deadlock() | PathFormula():
            raise AssertionError(f"{expression} has no value in a discrete state")
        case _:
            assert_never(expression)


def _lookup(
    table: tuple[int, ...], extent: range, index: Evaluator, span: Span | None
) -> Evaluator:
    def element(locations: Locations, values: Values) -> int:
        position = index(locations, values)
        check_index(position, extent, span)
        return table[position - extent.start]

    return element


def _unary_evaluator(op: UnaryOp, operand: Evaluator) -> Evaluator:
    match op:
        case UnaryOp.NOT:
            return lambda locations, values: int(not operand(locations, values))
        case UnaryOp.NEGATE:
            return lambda locations, values: -operand(locations, values)
        case _:
            assert_never(op)


def chained(op: BinaryOp, expression: Expression) -> list[Expression]:
    """What a connective joins, however it is nested."""
    match expression:
        case BinaryOperation(found, left, right) if found is op:
            return [*chained(op, left), *chained(op, right)]
        case _:
            return [expression]


def _chain_evaluator(op: BinaryOp, expressions: Sequence[Expression]) -> Evaluator:
    """One function for a whole chain of `and` or `or`: queries have long ones."""
    places = [(e.automaton, e.location) for e in expressions if isinstance(e, InLocation)]
    if op is BinaryOp.AND and len(places) == len(expressions) == 2:
        (a, at_a), (b, at_b) = places
        return lambda ls, _vs: int(ls[a] == at_a and ls[b] == at_b)
    parts = [evaluator(expression) for expression in expressions]
    if op is BinaryOp.AND:

        def every(ls: Locations, vs: Values) -> int:
            for part in parts:
                if not part(ls, vs):
                    return 0
            return 1

        return every

    def some(ls: Locations, vs: Values) -> int:
        for part in parts:
            if part(ls, vs):
                return 1
        return 0

    return some


def _binary_evaluator(
    op: BinaryOp, left: Evaluator, right: Evaluator, span: Span | None
) -> Evaluator:
    match op:
        case BinaryOp.IMPLY:
            return lambda ls, vs: int(not left(ls, vs) or bool(right(ls, vs)))
        case BinaryOp.DIV | BinaryOp.MOD:
            divide = _BINARY[op]

            def quotient(ls: Locations, vs: Values) -> int:
                divisor = right(ls, vs)
                if divisor == 0:
                    fix = "guard it with a test of the divisor"
                    raise model_error("TA007", "division by zero", span, fix)
                return divide(left(ls, vs), divisor)

            return quotient
        case _:
            function = _BINARY[op]
            return lambda ls, vs: function(left(ls, vs), right(ls, vs))


def slot_evaluator(slot: Slot) -> Evaluator:
    """Make a function that gives the index of the variable or channel that a slot names."""
    if not slot.extents:
        return lambda _locations, _values: slot.first
    indices = [evaluator(index) for index in slot.indices]

    def element(locations: Locations, values: Values) -> int:
        offset = 0
        for extent, index in zip(slot.extents, indices, strict=True):
            position = index(locations, values)
            check_index(position, extent, slot.span)
            offset = offset * len(extent) + position - extent.start
        return slot.first + offset

    return element


def check_index(position: int, extent: range, span: Span | None) -> None:
    """Refuse an index outside its array."""
    if position not in extent:
        fix = (
            f"the indices are {extent.start} to {extent.stop - 1}: "
            "guard the edge, or narrow the index's type"
        )
        raise model_error("TA007", f"index {position} is outside the array", span, fix)
