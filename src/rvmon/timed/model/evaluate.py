"""Expressions and statements as closures, for the rules that need no speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from rvmon.diagnostics import Span
from rvmon.timed.model.arithmetic import (
    OPERATIONS,
    apply_unary,
    check_index,
    check_shift,
    check_time,
    fitting,
)
from rvmon.timed.model.expressions import (
    MOST_ROUNDS,
    Assignment,
    BinaryOperation,
    Choice,
    ClockCompare,
    Constant,
    Deadlock,
    Expression,
    Fractional,
    If,
    InLocation,
    Invoke,
    Lookup,
    Missing,
    PathFormula,
    Perform,
    Reset,
    Return,
    Slot,
    Statement,
    UnaryOperation,
    VariableValue,
    While,
)
from rvmon.timed.model.fractions import GRID, operation
from rvmon.timed.model.operators import BinaryOp
from rvmon.timed.model.rules import model_error

Locations = Sequence[int]
"""The location of each automaton."""

Values = Sequence[int]
"""The value of each variable."""

Evaluator = Callable[[Locations, Values], int]


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
        case Lookup(table, slot):
            place = slot_evaluator(slot)
            return lambda locations, values: table[place(locations, values)]
        case Invoke():
            return caller(expression)
        case Fractional(name, operands, span):
            compute, parts = operation(name, span), [evaluator(part) for part in operands]
            return lambda locations, values: compute(*(part(locations, values) for part in parts))
        case InLocation(automaton, location):
            return lambda locations, _values: int(locations[automaton] == location)
        case UnaryOperation(unary, operand):
            inner = evaluator(operand)
            return lambda locations, values: apply_unary(unary, inner(locations, values))
        case BinaryOperation(BinaryOp.AND, _, _):
            every = [evaluator(part) for part in chained(BinaryOp.AND, expression)]
            return lambda locations, values: int(all(part(locations, values) for part in every))
        case BinaryOperation(BinaryOp.OR, _, _):
            some = [evaluator(part) for part in chained(BinaryOp.OR, expression)]
            return lambda locations, values: int(any(part(locations, values) for part in some))
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


def chained(op: BinaryOp, expression: Expression) -> list[Expression]:
    """What a connective joins, however it is nested."""
    match expression:
        case BinaryOperation(found, left, right) if found is op:
            return [*chained(op, left), *chained(op, right)]
        case _:
            return [expression]


def _binary_evaluator(
    op: BinaryOp, left: Evaluator, right: Evaluator, span: Span | None
) -> Evaluator:
    match op:
        case BinaryOp.IMPLY:
            return lambda ls, vs: int(not left(ls, vs) or bool(right(ls, vs)))
        case BinaryOp.DIV | BinaryOp.MOD:
            divide = OPERATIONS[op]

            def quotient(ls: Locations, vs: Values) -> int:
                divisor = right(ls, vs)
                if divisor == 0:
                    fix = "guard it with a test of the divisor"
                    raise model_error("TA007", "division by zero", span, fix)
                return divide(left(ls, vs), divisor)

            return quotient
        case BinaryOp.SHIFT_LEFT | BinaryOp.SHIFT_RIGHT:
            shift = OPERATIONS[op]

            def shifted(ls: Locations, vs: Values) -> int:
                number = left(ls, vs)
                return shift(number, check_shift(right(ls, vs), span))

            return shifted
        case _:
            function = OPERATIONS[op]
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


class Frame(list[int]):
    """The values of all variables, behind them room for functions, and the clocks that are set."""

    def __init__(self, values: Values, room: int) -> None:
        super().__init__([*values, *[0] * room])
        self.clocks: dict[int, float] = {}
        self.rounds = 0
        self._variables = len(values)

    def variables(self) -> tuple[int, ...]:
        """The values of the variables alone."""
        return tuple(self[: self._variables])


Runner = Callable[[Locations, Frame], int | None]
"""Runs statements; gives the value if they return one."""


def runner(statements: Sequence[Statement]) -> Runner:
    """Make a function that runs statements one behind the other."""
    steps = [_step(statement) for statement in statements]

    def run(locations: Locations, frame: Frame) -> int | None:
        for step in steps:
            value = step(locations, frame)
            if value is not None:
                return value
        return None

    return run


def caller(call: Invoke) -> Callable[[Locations, Values], int]:
    """Make a function that gives the value of a call."""
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


def _step(statement: Statement) -> Runner:
    match statement:
        case Assignment():
            return _assigner(statement)
        case Reset(clock, written, span):
            value, steps = evaluator(written), GRID if isinstance(written, Fractional) else 1

            def set_clock(locations: Locations, frame: Frame) -> None:
                frame.clocks[clock] = check_time(value(locations, frame), span) / steps

            return set_clock
        case Perform(call):
            perform = caller(call)

            def do(locations: Locations, frame: Frame) -> None:
                perform(locations, frame)

            return do
        case If(condition, then, otherwise):
            test, yes, no = evaluator(condition), runner(then), runner(otherwise)
            return lambda locations, frame: (
                yes(locations, frame) if test(locations, frame) else no(locations, frame)
            )
        case While():
            return _repeater(statement)
        case Return(written):
            return evaluator(written)
        case Missing(name, span):

            def miss(_locations: Locations, _frame: Frame) -> int:
                fix = "end every way through it with `return`"
                raise model_error("TA007", f"`{name}` ends without a value", span, fix)

            return miss
        case _:
            assert_never(statement)


def _assigner(statement: Assignment) -> Runner:
    slot, variable, span = statement.slot, statement.variable, statement.slot.span
    index, value = slot_evaluator(slot), evaluator(statement.value)

    def assign(locations: Locations, frame: Frame) -> None:
        place = index(locations, frame)
        frame[place] = fitting(value(locations, frame), variable, span)

    return assign


def _repeater(statement: While) -> Runner:
    test, body, span = evaluator(statement.condition), runner(statement.body), statement.span

    def repeat(locations: Locations, frame: Frame) -> int | None:
        while test(locations, frame):
            frame.rounds += 1
            if frame.rounds > MOST_ROUNDS:
                message = f"loops go round more than {MOST_ROUNDS:,} times in one step"
                raise model_error("TA019", message, span, "let them end sooner")
            value = body(locations, frame)
            if value is not None:
                return value
        return None

    return repeat
