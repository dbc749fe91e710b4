"""Conditions in normal form: negation at the atoms, clocks apart from variables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network import Guard
from rvmon.models.network.evaluate import chained
from rvmon.models.network.expressions import (
    FALSE,
    TRUE,
    BinaryOp,
    BinaryOperation,
    Choice,
    ClockCompare,
    ClockOp,
    Constant,
    Deadlock,
    Expression,
    Fractional,
    InLocation,
    Invoke,
    Lookup,
    PathFormula,
    PathOp,
    Reset,
    Statement,
    UnaryOp,
    UnaryOperation,
    VariableValue,
    expressions_of,
    statements_in,
)

_NEGATED_CLOCK = {
    ClockOp.LT: ClockOp.GE,
    ClockOp.LE: ClockOp.GT,
    ClockOp.GE: ClockOp.LT,
    ClockOp.GT: ClockOp.LE,
}
_NEGATED_PATH = {
    PathOp.POSSIBLY: PathOp.INVARIANTLY,
    PathOp.INVARIANTLY: PathOp.POSSIBLY,
    PathOp.EVENTUALLY: PathOp.POTENTIALLY_ALWAYS,
    PathOp.POTENTIALLY_ALWAYS: PathOp.EVENTUALLY,
    PathOp.SOME_NEXT: PathOp.EVERY_NEXT,
    PathOp.EVERY_NEXT: PathOp.SOME_NEXT,
    PathOp.FINALLY: PathOp.GLOBALLY,
    PathOp.GLOBALLY: PathOp.FINALLY,
    PathOp.EVERY_RUN: PathOp.SOME_RUN,
    PathOp.SOME_RUN: PathOp.EVERY_RUN,
}


def is_fixed(expression: Expression) -> bool:
    """Whether an expression has the same value always: functions may compute it from constants."""
    for part in parts_of(expression):
        match part:
            case InLocation() | ClockCompare() | Deadlock() | PathFormula():
                return False
            case VariableValue(slot) if slot.first >= 0:
                return False
            case Invoke(function):
                inside = (e for s in statements_in(function.body) for e in expressions_of(s))
                if function.changes or not all(map(is_fixed, inside)):
                    return False
            case _:
                pass
    return True


def parts_of(expression: Expression) -> Iterator[Expression]:
    """An expression and all that its operators join, from the top."""
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        yield part
        match part:
            case UnaryOperation(_, operand):
                waiting.append(operand)
            case BinaryOperation(_, left, right):
                waiting += (right, left)
            case Choice(condition, then, otherwise):
                waiting += (otherwise, then, condition)
            case PathFormula(_, body, _, left):
                waiting += (body, left)
            case VariableValue(slot) | Lookup(_, slot):
                waiting += slot.indices
            case Invoke(_, arguments) | Fractional(_, arguments):
                waiting += arguments
            case _:
                pass


def is_discrete(expression: Expression) -> bool:
    """Whether locations and variables alone give the expression a value."""
    of_runs = ClockCompare | Deadlock | PathFormula
    return not any(isinstance(part, of_runs) for part in parts_of(expression))


def resets_in(updates: Sequence[Statement]) -> Iterator[Reset]:
    """All statements that set clocks among some, and in the functions that they call."""
    for statement in statements_in(updates):
        if isinstance(statement, Reset):
            yield statement
        for part in (p for e in expressions_of(statement) for p in parts_of(e)):
            if isinstance(part, Invoke) and part.function.changes:
                yield from resets_in(part.function.body)


def refuse_changes(expression: Expression, span: Span) -> None:
    """Refuse a condition or number that changes variables when it is asked for.

    Raises:
        ModelError: it calls a function that does.
    """
    for part in parts_of(expression):
        if isinstance(part, Invoke) and part.function.changes:
            message = f"`{part.function.name}` changes variables or clocks"
            fix = "call it in an update; conditions are only looked at"
            raise model_error("TA009", message, span, fix)


def is_linear(expression: Expression) -> bool:
    """Whether operators occur that speak of one run, not of all that begin in a state."""
    linear = (PathOp.FINALLY, PathOp.GLOBALLY, PathOp.EVERY_RUN, PathOp.SOME_RUN)
    parts = parts_of(expression)
    return any(isinstance(part, PathFormula) and part.op in linear for part in parts)


def compares_of(expression: Expression) -> Iterator[ClockCompare]:
    """All comparisons of clocks in an expression."""
    return (part for part in parts_of(expression) if isinstance(part, ClockCompare))


def speaks_of_deadlock(formula: Expression) -> bool:
    """Whether `deadlock` occurs in a formula."""
    return any(isinstance(part, Deadlock) for part in parts_of(formula))


def has_paths(formula: Expression) -> bool:
    """Whether a path operator occurs in a formula."""
    return any(isinstance(part, PathFormula) for part in parts_of(formula))


def is_plain(formula: Expression) -> bool:
    """Whether a formula speaks of the state alone: of no runs and no deadlock."""
    return not any(isinstance(part, PathFormula | Deadlock) for part in parts_of(formula))


def _denied(expression: Expression) -> Expression:
    """The negation; that of a negation is what was negated."""
    match expression:
        case UnaryOperation(UnaryOp.NOT, operand):
            return operand
        case _:
            return UnaryOperation(UnaryOp.NOT, expression)


def normal_form(expression: Expression, positive: bool = True) -> Expression:
    """The expression, or its negation, with `and` and `or` over discrete parts and atoms.

    Raises:
        ModelError: it would have too many parts.
    """
    if _size(expression) > MOST_PARTS:
        raise model_error("TA019", "too many conditions are compared", None, "split the condition")
    return _normal_form(expression, positive)


def _size(expression: Expression) -> int:
    """The parts of the normal form: what compares conditions has each of them twice."""
    if is_discrete(expression):
        return 1
    match expression:
        case UnaryOperation(_, operand):
            return _size(operand)
        case PathFormula(_, body, _, left):
            return _size(body) + _size(left)
        case BinaryOperation(op, left, right):
            return (1 + (op in (BinaryOp.EQ, BinaryOp.NE))) * (_size(left) + _size(right))
        case Choice(condition, then, otherwise):
            return 2 * _size(condition) + _size(then) + _size(otherwise)
        case _:
            return 1


def _normal_form(expression: Expression, positive: bool = True) -> Expression:
    if is_discrete(expression):
        return expression if positive else _denied(expression)
    match expression:
        case ClockCompare(clock, op, bound):
            return expression if positive else ClockCompare(clock, _NEGATED_CLOCK[op], bound)
        case Deadlock():
            return expression if positive else UnaryOperation(UnaryOp.NOT, expression)
        case PathFormula(op, body, bound, left):
            op = op if positive else _NEGATED_PATH[op]
            return PathFormula(op, _normal_form(body, positive), bound, _normal_form(left))
        case UnaryOperation(UnaryOp.NOT, operand):
            return _normal_form(operand, not positive)
        case BinaryOperation(BinaryOp.AND | BinaryOp.OR as op, left, right):
            if not positive:
                op = BinaryOp.OR if op is BinaryOp.AND else BinaryOp.AND
            parts = _normal_form(left, positive), _normal_form(right, positive)
            return BinaryOperation(op, *parts)
        case BinaryOperation(BinaryOp.IMPLY, left, right):
            op = BinaryOp.OR if positive else BinaryOp.AND
            return BinaryOperation(
                op, _normal_form(left, not positive), _normal_form(right, positive)
            )
        case BinaryOperation(BinaryOp.EQ | BinaryOp.NE as op, left, right):
            # `p == q` between conditions is "both or neither", `p != q` is "one of them".
            same = (op is BinaryOp.EQ) == positive
            return BinaryOperation(
                BinaryOp.OR,
                BinaryOperation(BinaryOp.AND, _normal_form(left), _normal_form(right, same)),
                BinaryOperation(
                    BinaryOp.AND, _normal_form(left, positive=False), _normal_form(right, not same)
                ),
            )
        case Choice(condition, then, otherwise):
            return BinaryOperation(
                BinaryOp.OR,
                BinaryOperation(
                    BinaryOp.AND, _normal_form(condition), _normal_form(then, positive)
                ),
                BinaryOperation(
                    BinaryOp.AND,
                    _normal_form(condition, positive=False),
                    _normal_form(otherwise, positive),
                ),
            )
        case _:  # arithmetic, and what is discrete
            raise AssertionError(f"{expression} is no condition")


def with_deadlock(formula: Expression, value: bool) -> Expression:
    """A normalised formula in which `deadlock` is true, or false."""
    match formula:
        case Deadlock():
            return Constant(int(value))
        case UnaryOperation(UnaryOp.NOT, Deadlock()):
            return Constant(int(not value))
        case BinaryOperation(op, left, right) if not is_discrete(formula):
            return BinaryOperation(op, with_deadlock(left, value), with_deadlock(right, value))
        case _:
            return formula


def split_guard(expression: Expression, span: Span) -> Guard:
    """A condition as its discrete part and its clock bounds, which must all hold.

    Raises:
        ModelError: clocks stand under `or`.
    """
    guard, *others = islice(guards_of(expression), 2)
    if others:
        fix = "make one location for each alternative"
        raise model_error("TA009", "a clock under `or`", span, fix)
    return guard


def guards_of(expression: Expression) -> Iterator[Guard]:
    """A condition as guards of which one holds where it does, and never two; made as asked for."""
    for parts in _cases(normal_form(expression)):
        data = together(part for part in parts if not isinstance(part, ClockCompare))
        yield Guard(data, tuple(part for part in parts if isinstance(part, ClockCompare)))


MOST_PARTS = 100_000
"""Of a condition in normal form."""

MOST_PIECES = 4000
"""Alternatives of a formula that are taken apart."""


def together(parts: Iterable[Expression]) -> Expression:
    """One formula for parts that hold together, without those that always do."""
    formula: Expression = TRUE
    for part in parts:
        if part == FALSE:
            return FALSE
        if formula == TRUE:
            formula = part
        elif part != TRUE:
            formula = BinaryOperation(BinaryOp.AND, formula, part)
    return formula


def either(parts: Sequence[Expression]) -> Expression:
    """One formula for parts of which one holds; halved again and again, so that it is not deep."""
    if len(parts) < 2:
        return parts[0] if parts else FALSE
    middle = len(parts) // 2
    return BinaryOperation(BinaryOp.OR, either(parts[:middle]), either(parts[middle:]))


def alternatives_of(formula: Expression | None, due: Sequence[ClockCompare] = ()) -> list[Guard]:
    """A plain normalised formula as guards of which some hold where it does; none for `None`.

    Args:
        formula: without path operators and `deadlock`.
        due: bounds that hold besides in each.

    Raises:
        ModelError: they are too many.
    """
    if formula is None:
        return []
    return [
        Guard(together(conditions), (*compares, *due)) for conditions, compares in _split(formula)
    ]


_Parts = tuple[list[Expression], list[ClockCompare]]


def _split(formula: Expression) -> list[_Parts]:
    if is_discrete(formula):
        return [([formula], [])]
    match formula:
        case ClockCompare():
            return [([], [formula])]
        case BinaryOperation(BinaryOp.AND, left, right):
            some, others = _split(left), _split(right)
            if len(some) * len(others) > MOST_PIECES:
                raise model_error("TA019", "the query has too many alternatives", None)
            return [(a + c, b + d) for a, b in some for c, d in others]
        case BinaryOperation(BinaryOp.OR, left, right):
            return [*_split(left), *_split(right)]
        case _:
            raise AssertionError(f"{formula} is not normalised")


def _cases(formula: Expression) -> Iterator[list[Expression]]:
    """A normalised condition as alternatives of parts that hold together, each without the others.

    Where `p or q` holds, p does, or it does not and q does. There may be many more than are asked
    for.
    """
    match formula:
        case _ if is_discrete(formula):
            yield [*chained(BinaryOp.AND, formula)]
        case BinaryOperation(BinaryOp.AND, left, right):
            yield from ([*one, *other] for one in _cases(left) for other in _cases(right))
        case BinaryOperation(BinaryOp.OR, left, right):
            yield from _cases(left)
            yield from _cases(BinaryOperation(BinaryOp.AND, normal_form(left, False), right))
        case _:
            yield [formula]
