"""Expressions and updates as bytecode of the native search, for a stack of integers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import assert_never

from rvmon.models import model_error
from rvmon.models.network import expressions as ex
from rvmon.models.network.guards import parts_in, parts_of

# Opcodes, with the numbers of `plan.h`.
END, CONST, VARIABLE, INDEX, ROW, ELEMENT, LOOKUP, PLACE, NOT, NEGATE, TRUTH = range(11)
_JUMPS = dict(zip([*ex.BinaryOp][:3], (11, 12, 13), strict=True))
UNLESS, GO = 14, 15
_BINARY = {op: number for number, op in enumerate([*ex.BinaryOp][3:], start=16)}
INVERT, SET, STORE, CLOCK, CALL, DROP, HEAD, BACK, FAIL = range(34, 43)
_UNARY = {ex.UnaryOp.NOT: NOT, ex.UnaryOp.NEGATE: NEGATE, ex.UnaryOp.INVERT: INVERT}
STACK = 256
MOST_NEST = 60  # limit for the depth of nested calls
_HALF = 1 << 31


class Programs:
    """The programs of a plan, one after the other."""

    def __init__(self, slots: int) -> None:
        """Start without programs; `slots` counts all variables, including those of functions."""
        self.code: list[int] = []
        self.table: list[int] = []
        self._slots = slots
        self._starts: dict[int, int] = {}
        self._nests: dict[int, int] = {}
        """For each function, the start of its program and the depth of its nested calls."""
        self._added: dict[int, tuple[object, int]] = {}
        """By identity of an expression: the expression, kept alive; the start of its program."""
        self._ends: list[int] = []

    def add(self, expression: ex.Expression) -> int:
        """Add a program that computes an expression, and return its start."""
        if id(expression) not in self._added:
            self._add_called(parts_of(expression))
            start = self._finished(len(self.code), self._emit(expression))
            self._added[id(expression)] = expression, start
        return self._added[id(expression)][1]

    def add_updates(self, updates: Sequence[ex.Statement]) -> int:
        """Add a program that performs all updates of an edge, and return its start."""
        if id(updates) not in self._added:
            self._add_called(parts_in(updates))
            start = len(self.code)
            depth, _ = self._statements(updates)
            self.code += [CONST, 0]
            self._added[id(updates)] = updates, self._finished(start, max(depth, 1))
        return self._added[id(updates)][1]

    def add_index(self, slot: ex.Slot) -> int:
        """Add a program that computes the index that a slot denotes, and return its start."""
        self._add_called(part for index in slot.indices for part in parts_of(index))
        start = len(self.code)
        depth = self._offset(slot)
        self.code += [CONST, slot.first, _BINARY[ex.BinaryOp.ADD]]
        return self._finished(start, 1 + depth)

    def _add_called(self, parts: Iterable[ex.Expression]) -> int:
        """Add called functions, which must precede their callers; return the depth of the calls."""
        nest = 0
        for part in parts:
            if isinstance(part, ex.Invoke):
                if id(part.function) not in self._starts:
                    self._add_function(part.function)
                nest = max(nest, 1 + self._nests[id(part.function)])
        if nest > MOST_NEST:
            fix = "let functions call each other less deeply"
            raise model_error("TA019", f"more than {MOST_NEST} calls in calls", None, fix)
        return nest

    def _add_function(self, function: ex.Function) -> None:
        self._nests[id(function)] = self._add_called(parts_in(function.body))
        start = len(self.code)
        waiting, self._ends = self._ends, []
        depth, _ = self._statements(function.body)
        for hole in self._ends:
            self.code[hole] = len(self.code)
        self._ends = waiting
        slot, _ = function.result
        self.code += [SET, self._place(slot), VARIABLE, self._place(slot)]
        self._starts[id(function)] = self._finished(start, depth)

    def _place(self, slot: int) -> int:
        """The index of a slot in the plan, where slots of functions come last."""
        return slot if slot >= 0 else self._slots + slot

    def _statements(self, statements: Sequence[ex.Statement]) -> tuple[int, bool]:
        """Emit statements; return the stack depth they need, and whether their end is reached."""
        depth = 1
        for statement in statements:
            more, continues = self._statement(statement)
            depth = max(depth, more)
            if not continues:
                return depth, False
        return depth, True

    def _statement(self, statement: ex.Statement) -> tuple[int, bool]:
        code = self.code
        match statement:
            case ex.Assignment(ex.Slot(first, ()), value):
                depth = self._emit(value)
                code += [SET, self._place(first)]
            case ex.Assignment(slot, value):
                depth = max(self._offset(slot), 1 + self._emit(value))
                code += [STORE, self._place(slot.first), slot.size]
            case ex.Reset(clock, value):
                depth = self._emit(value)
                code += [CLOCK, clock + 1]
            case ex.Invoke():
                depth = self._emit(statement)
                code.append(DROP)
            case ex.If(condition, then, otherwise):
                first = self._emit(condition)
                to_otherwise = self._hole(UNLESS)
                second, after_then = self._statements(then)
                to_end = self._hole(GO) if after_then else None
                code[to_otherwise] = len(code)
                third, after_otherwise = self._statements(otherwise)
                if to_end is not None:
                    code[to_end] = len(code)
                return max(first, second, third), after_then or after_otherwise
            case ex.While(condition, body):
                head = len(code)
                code.append(HEAD)
                first = self._emit(condition)
                to_end = self._hole(UNLESS)
                second, after_body = self._statements(body)
                if after_body:
                    code += [BACK, head]
                code[to_end] = len(code)
                depth = max(first, second)
            case ex.Return(value):
                depth = self._emit(value)
                self._ends.append(self._hole(GO))
                return depth, False
            case ex.Missing():
                code.append(FAIL)
                self._ends.append(self._hole(GO))
                return 1, False
            case _:
                assert_never(statement)
        return depth, True

    def _finished(self, start: int, depth: int) -> int:
        if depth > STACK:
            raise model_error("TA019", "an expression is nested too deeply", None, "split it")
        self.code.append(END)
        return start

    def _offset(self, slot: ex.Slot) -> int:
        """Emit code for the offset in a slot; return the stack depth that it needs."""
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
        times, plus = _BINARY[ex.BinaryOp.MUL], _BINARY[ex.BinaryOp.ADD]
        # Programs hold numbers of 32 bits, so that 2^31 is not available as a constant.
        self.code += [CONST, _HALF // 2, times, CONST, 2, times, CONST, low, plus]
        return depth + 1

    def _emit(self, expression: ex.Expression) -> int:
        """Emit code for an expression; return the stack depth that it needs."""
        code = self.code
        match expression:
            case ex.Constant(value):
                return self._constant(value)
            case ex.VariableValue(ex.Slot(first, ())):
                code += [VARIABLE, self._place(first)]
                return 1
            case ex.VariableValue(slot):
                depth = self._offset(slot)
                code += [ELEMENT, self._place(slot.first), slot.size]
                return depth
            case ex.Lookup(values, slot):
                depth = self._offset(slot)
                code += [LOOKUP, len(self.table), len(values)]
                self.table += values
                return depth
            case ex.Invoke(function, arguments):
                depths = [place + self._emit(argument) for place, argument in enumerate(arguments)]
                for place, _ in reversed(function.parameters):
                    code += [SET, self._place(place)]
                code += [CALL, self._starts[id(function)]]
                return max(1, *depths) if depths else 1
            case ex.InLocation(automaton, location):
                code += [PLACE, automaton, location]
                return 1
            case ex.UnaryOperation(op, operand):
                depth = self._emit(operand)
                code.append(_UNARY[op])
                return depth
            case ex.BinaryOperation(op, left, right) if op in _JUMPS:
                first = self._emit(left)
                hole = self._hole(_JUMPS[op])
                second = self._emit(right)
                code.append(TRUTH)
                code[hole] = len(code)
                return max(first, second)
            case ex.BinaryOperation(op, left, right):
                first = self._emit(left)
                second = self._emit(right)
                code.append(_BINARY[op])
                return max(first, 1 + second)
            case ex.Choice(condition, then, otherwise):
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
