"""Expressions as programs of the native search: bytecode for a stack of 64-bit integers."""

from __future__ import annotations

from rvmon.timed.model.expressions import (
    BinaryOperation,
    Choice,
    Constant,
    Expression,
    InLocation,
    Lookup,
    Slot,
    UnaryOperation,
    VariableValue,
)
from rvmon.timed.model.operators import BinaryOp, UnaryOp
from rvmon.timed.model.rules import model_error

# The numbers of `plan.h`.
END, CONST, VARIABLE, INDEX, ROW, ELEMENT, LOOKUP, PLACE, NOT, NEGATE, TRUTH = range(11)
_JUMPS = {BinaryOp.AND: 11, BinaryOp.OR: 12, BinaryOp.IMPLY: 13}
UNLESS, GO = 14, 15
_BINARY = {
    BinaryOp.LT: 16,
    BinaryOp.LE: 17,
    BinaryOp.EQ: 18,
    BinaryOp.NE: 19,
    BinaryOp.GE: 20,
    BinaryOp.GT: 21,
    BinaryOp.ADD: 22,
    BinaryOp.SUB: 23,
    BinaryOp.MUL: 24,
    BinaryOp.DIV: 25,
    BinaryOp.MOD: 26,
}
STACK = 256
_HALF = 1 << 31


class Programs:
    """The programs of a plan, one behind the other.

    Attributes:
        code: all of them.
        table: the constant arrays that they look into.
    """

    def __init__(self) -> None:
        self.code: list[int] = []
        self.table: list[int] = []

    def add(self, expression: Expression) -> int:
        """Add a program that gives an expression's value; where it begins.

        Raises:
            ModelError: it is nested too deeply.
        """
        return self._finished(len(self.code), self._emit(expression))

    def add_offset(self, slot: Slot) -> int:
        """Add a program that gives the offset of a slot from its array's first; -1 if it is 0."""
        return self._finished(len(self.code), self._offset(slot)) if slot.extents else -1

    def add_index(self, slot: Slot) -> int:
        """Add a program that gives the number of a slot."""
        start = len(self.code)
        depth = self._offset(slot)
        self.code += [CONST, slot.first, _BINARY[BinaryOp.ADD]]
        return self._finished(start, 1 + depth)

    def _finished(self, start: int, depth: int) -> int:
        if depth > STACK:
            raise model_error("TA019", "an expression is nested too deeply", None, "split it")
        self.code.append(END)
        return start

    def _offset(self, slot: Slot) -> int:
        """Emit the offset of a slot; the depth of the stack that it needs."""
        depth = 1
        if not slot.extents:
            self.code += [CONST, 0]
        for place, (extent, index) in enumerate(zip(slot.extents, slot.indices, strict=True)):
            depth = max(depth, self._emit(index) + (place > 0))
            self.code += [INDEX, extent.start, len(extent)]
            if place:
                self.code += [ROW, len(extent)]
        return depth

    def _constant(self, value: int) -> int:
        if -_HALF <= value < _HALF:
            self.code += [CONST, value]
            return 1
        high, low = divmod(value, _HALF)
        depth = self._constant(high)
        times, plus = _BINARY[BinaryOp.MUL], _BINARY[BinaryOp.ADD]
        # 2^31 itself is none that a program can hold.
        self.code += [CONST, _HALF // 2, times, CONST, 2, times, CONST, low, plus]
        return depth + 1

    def _emit(self, expression: Expression) -> int:
        """Emit an expression; the depth of the stack that it needs."""
        code = self.code
        match expression:
            case Constant(value):
                return self._constant(value)
            case VariableValue(Slot(first, ())):
                code += [VARIABLE, first]
                return 1
            case VariableValue(slot):
                depth = self._offset(slot)
                code += [ELEMENT, slot.first, _size(slot)]
                return depth
            case Lookup(values, extent, index, _):
                depth = self._emit(index)
                code += [INDEX, extent.start, len(extent), LOOKUP, len(self.table), len(values)]
                self.table += values
                return depth
            case InLocation(automaton, location):
                code += [PLACE, automaton, location]
                return 1
            case UnaryOperation(op, operand):
                depth = self._emit(operand)
                code.append(NOT if op is UnaryOp.NOT else NEGATE)
                return depth
            case BinaryOperation(op, left, right) if op in _JUMPS:
                first = self._emit(left)
                hole = self._hole(_JUMPS[op])
                second = self._emit(right)
                code.append(TRUTH)
                code[hole] = len(code)
                return max(first, second)
            case BinaryOperation(op, left, right):
                first = self._emit(left)
                second = self._emit(right)
                code.append(_BINARY[op])
                return max(first, 1 + second)
            case Choice(condition, then, otherwise):
                first = self._emit(condition)
                to_otherwise = self._hole(UNLESS)
                second = self._emit(then)
                to_end = self._hole(GO)
                code[to_otherwise] = len(code)
                third = self._emit(otherwise)
                code[to_end] = len(code)
                return max(first, second, third)
            case _:
                raise AssertionError(f"{expression} has no value")

    def _hole(self, jump: int) -> int:
        self.code += [jump, 0]
        return len(self.code) - 1


def _size(slot: Slot) -> int:
    size = 1
    for extent in slot.extents:
        size *= len(extent)
    return size
