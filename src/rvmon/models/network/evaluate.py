"""Expressions and statements as closures; the arithmetic of operators, and what they refuse."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network import expressions as ex
from rvmon.models.network.fractions import GRID, operation

UNARY: dict[ex.UnaryOp, Callable[[int], int]] = {
    ex.UnaryOp.NOT: lambda a: int(not a),
    ex.UnaryOp.NEGATE: lambda a: -a,
    ex.UnaryOp.INVERT: lambda a: ~a,
}


def _divide(left: int, right: int) -> int:
    """The quotient, truncated as in C.

    >>> _divide(-7, 2), _divide(7, 2)
    (-3, 3)
    """
    quotient = abs(left) // abs(right)
    return quotient if (left < 0) == (right < 0) else -quotient


OPERATIONS: dict[ex.BinaryOp, Callable[[int, int], int]] = {
    ex.BinaryOp.AND: lambda a, b: int(bool(a) and bool(b)),
    ex.BinaryOp.OR: lambda a, b: int(bool(a) or bool(b)),
    ex.BinaryOp.IMPLY: lambda a, b: int(not a or bool(b)), ex.BinaryOp.LT: lambda a, b: int(a < b),
    ex.BinaryOp.LE: lambda a, b: int(a <= b), ex.BinaryOp.EQ: lambda a, b: int(a == b),
    ex.BinaryOp.NE: lambda a, b: int(a != b), ex.BinaryOp.GE: lambda a, b: int(a >= b),
    ex.BinaryOp.GT: lambda a, b: int(a > b), ex.BinaryOp.ADD: lambda a, b: a + b,
    ex.BinaryOp.SUB: lambda a, b: a - b, ex.BinaryOp.MUL: lambda a, b: a * b,
    ex.BinaryOp.DIV: _divide, ex.BinaryOp.MOD: lambda a, b: a - b * _divide(a, b),
    ex.BinaryOp.BIT_AND: lambda a, b: a & b, ex.BinaryOp.BIT_OR: lambda a, b: a | b,
    ex.BinaryOp.BIT_XOR: lambda a, b: a ^ b, ex.BinaryOp.SHIFT_LEFT: lambda a, b: a << b,
    ex.BinaryOp.SHIFT_RIGHT: lambda a, b: a >> b, ex.BinaryOp.MINIMUM: min,
    ex.BinaryOp.MAXIMUM: max,
}  # fmt: skip


def check_shift(bits: int, span: Span | None) -> int:
    """Refuse a shift by fewer than 0 or more than 31 bits."""
    if not 0 <= bits < 32:
        raise model_error("TA007", f"a shift by {bits} bits", span, "shift by 0 to 31 bits")
    return bits


def check_index(position: int, extent: range, span: Span | None) -> None:
    """Refuse an index outside its array."""
    if position not in extent:
        indices = f"the indices are {extent.start} to {extent.stop - 1}"
        fix = f"{indices}: guard the edge, or narrow the index's type"
        raise model_error("TA007", f"index {position} is outside the array", span, fix)


def fitting(number: int, variable: ex.Variable, span: Span | None) -> int:
    """The number as the variable stores it; an integer outside its range is refused."""
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
    if not 0 <= number < ex.MAX_TIME:
        fix = f"keep it from 0 to {ex.MAX_TIME - 1:,}, or choose a larger unit of time"
        raise model_error("TA007", f"{number} is not a valid value for a clock", span, fix)
    return number


Locations = Sequence[int]  # the location of each automaton
Values = Sequence[int]  # the value of each variable

Evaluator = Callable[[Locations, Values], int]


def evaluator(expression: ex.Expression) -> Evaluator:
    """Compile an expression without clocks to a function of locations and variables.

    Connectives evaluate their right side only if it matters, so that `i < N and a[i] > 0`
    never leaves the array.
    """
    match expression:
        case ex.Constant(value):
            return lambda _locations, _values: value
        case ex.VariableValue(ex.Slot(first, ())):
            return lambda _locations, values: values[first]
        case ex.VariableValue(slot):
            element = slot_evaluator(slot)
            return lambda locations, values: values[element(locations, values)]
        case ex.Lookup(table, slot):
            place = slot_evaluator(slot)
            return lambda locations, values: table[place(locations, values)]
        case ex.Invoke():
            return caller(expression)
        case ex.Fractional(name, operands, span):
            compute, parts = operation(name, span), [evaluator(part) for part in operands]
            return lambda locations, values: compute(*(part(locations, values) for part in parts))
        case ex.InLocation(automaton, location):
            return lambda locations, _values: int(locations[automaton] == location)
        case ex.UnaryOperation(unary, operand):
            compute, inner = UNARY[unary], evaluator(operand)
            return lambda locations, values: compute(inner(locations, values))
        case ex.BinaryOperation(ex.BinaryOp.AND | ex.BinaryOp.OR as op):
            joined = all if op is ex.BinaryOp.AND else any
            parts = [evaluator(part) for part in chained(op, expression)]
            return lambda locations, values: int(joined(part(locations, values) for part in parts))
        case ex.BinaryOperation(op, left, right, span):
            return _binary_evaluator(op, evaluator(left), evaluator(right), span)
        case ex.Choice(condition, then, otherwise):
            test, yes, no = evaluator(condition), evaluator(then), evaluator(otherwise)
            return lambda locations, values: (
                yes(locations, values) if test(locations, values) else no(locations, values)
            )
        case ex.ClockCompare() | ex.Deadlock() | ex.PathFormula():
            raise AssertionError(f"{expression} has no value in a discrete state")
        case _:
            assert_never(expression)


def chained(op: ex.BinaryOp, expression: ex.Expression) -> list[ex.Expression]:
    """The operands of a connective, with nested connectives of the same kind flattened."""
    match expression:
        case ex.BinaryOperation(found, left, right) if found is op:
            return [*chained(op, left), *chained(op, right)]
        case _:
            return [expression]


def _binary_evaluator(
    op: ex.BinaryOp, left: Evaluator, right: Evaluator, span: Span | None
) -> Evaluator:
    match op:
        case ex.BinaryOp.IMPLY:
            return lambda ls, vs: int(not left(ls, vs) or bool(right(ls, vs)))
        case ex.BinaryOp.DIV | ex.BinaryOp.MOD:
            divide = OPERATIONS[op]

            def quotient(ls: Locations, vs: Values) -> int:
                divisor = right(ls, vs)
                if divisor == 0:
                    fix = "guard it with a test of the divisor"
                    raise model_error("TA007", "division by zero", span, fix)
                return divide(left(ls, vs), divisor)

            return quotient
        case ex.BinaryOp.SHIFT_LEFT | ex.BinaryOp.SHIFT_RIGHT:
            shift = OPERATIONS[op]

            def shifted(ls: Locations, vs: Values) -> int:
                number = left(ls, vs)
                return shift(number, check_shift(right(ls, vs), span))

            return shifted
        case _:
            function = OPERATIONS[op]
            return lambda ls, vs: function(left(ls, vs), right(ls, vs))


def slot_evaluator(slot: ex.Slot) -> Evaluator:
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


class Frame(list[int]):
    """The values of all variables, then room for functions (slots below 0); clocks that were set.

    `clocks` holds the new values in units of time by clock, and `rounds` counts those of all loops.
    """

    def __init__(self, values: Values, room: int) -> None:
        super().__init__([*values, *[0] * room])
        self.clocks: dict[int, float] = {}
        self.rounds = 0
        self._variables = len(values)

    def variables(self) -> tuple[int, ...]:
        """The values of the variables, without the room for functions."""
        return tuple(self[: self._variables])


Runner = Callable[[Locations, Frame], int | None]
"""Runs statements and gives the value that they return, or `None`."""


def runner(statements: Sequence[ex.Statement]) -> Runner:
    """Compile statements to a function that runs them in order."""
    steps = [_step(statement) for statement in statements]

    def run(locations: Locations, frame: Frame) -> int | None:
        for step in steps:
            value = step(locations, frame)
            if value is not None:
                return value
        return None

    return run


def caller(call: ex.Invoke) -> Callable[[Locations, Values], int]:
    """Compile a call to a function that gives its value."""
    function = call.function
    arguments = [evaluator(argument) for argument in call.arguments]
    body: list[Runner] = []

    def value(locations: Locations, values: Values) -> int:
        frame = values if isinstance(values, Frame) else Frame(values, function.room)
        if not body:
            body.append(runner(function.body))
        given = [argument(locations, frame) for argument in arguments]
        for (slot, variable), number in zip(function.parameters, given, strict=True):
            frame[slot] = fitting(number, variable, call.span)
        result = body[0](locations, frame)
        assert result is not None, "every way through a body ends with a value"
        return fitting(result, function.result[1], call.span)

    return value


def _step(statement: ex.Statement) -> Runner:
    match statement:
        case ex.Assignment():
            return _assigner(statement)
        case ex.Reset(clock, written, span):
            value, steps = evaluator(written), GRID if isinstance(written, ex.Fractional) else 1

            def set_clock(locations: Locations, frame: Frame) -> None:
                frame.clocks[clock] = check_time(value(locations, frame), span) / steps

            return set_clock
        case ex.Invoke():
            perform = caller(statement)

            def do(locations: Locations, frame: Frame) -> None:
                perform(locations, frame)

            return do
        case ex.If(condition, then, otherwise):
            test, yes, no = evaluator(condition), runner(then), runner(otherwise)
            return lambda locations, frame: (
                yes(locations, frame) if test(locations, frame) else no(locations, frame)
            )
        case ex.While():
            return _repeater(statement)
        case ex.Return(written):
            return evaluator(written)
        case ex.Missing(name, span):

            def miss(_locations: Locations, _frame: Frame) -> int:
                fix = "end every way through it with `return`"
                raise model_error("TA007", f"`{name}` ends without a value", span, fix)

            return miss
        case _:
            assert_never(statement)


def _assigner(statement: ex.Assignment) -> Runner:
    slot, variable, span = statement.slot, statement.variable, statement.slot.span
    index, value = slot_evaluator(slot), evaluator(statement.value)

    def assign(locations: Locations, frame: Frame) -> None:
        place = index(locations, frame)
        frame[place] = fitting(value(locations, frame), variable, span)

    return assign


def _repeater(statement: ex.While) -> Runner:
    test, body, span = evaluator(statement.condition), runner(statement.body), statement.span

    def repeat(locations: Locations, frame: Frame) -> int | None:
        while test(locations, frame):
            frame.rounds += 1
            if frame.rounds > ex.MOST_ROUNDS:
                message = f"loops go round more than {ex.MOST_ROUNDS:,} times in one step"
                raise model_error("TA019", message, span, "let them end sooner")
            value = body(locations, frame)
            if value is not None:
                return value
        return None

    return repeat
