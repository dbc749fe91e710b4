"""Conditions in normal form: negations at the atoms, clocks separated from variables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.network import Guard
from rvmon.models.network import expressions as ex
from rvmon.models.network.evaluate import chained

_BELOW, _ABOVE = (ex.ClockOp.LT, ex.ClockOp.LE), (ex.ClockOp.GE, ex.ClockOp.GT)
# The negation of < is >=, and so on.
_NEGATED_CLOCK = dict(zip(_BELOW + _ABOVE, _ABOVE + _BELOW, strict=True))
# `PathOp` lists each operator before its dual.
_DUALS = [*zip([*ex.PathOp][::2], [*ex.PathOp][1::2], strict=True)]
_NEGATED_PATH = dict(_DUALS) | {other: one for one, other in _DUALS}


def is_fixed(expression: ex.Expression) -> bool:
    """Whether an expression is constant. Functions may compute it from constants."""
    for part in parts_of(expression):
        match part:
            case ex.InLocation() | ex.ClockCompare() | ex.Deadlock() | ex.PathFormula():
                return False
            case ex.VariableValue(slot) if slot.first >= 0:
                return False
            case ex.Invoke(function):
                inside = (e for s in ex.statements_in(function.body) for e in ex.expressions_of(s))
                if function.changes or not all(map(is_fixed, inside)):
                    return False
            case _:
                pass
    return True


def parts_of(expression: ex.Expression) -> Iterator[ex.Expression]:
    """An expression and all its subexpressions, from the top."""
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        yield part
        match part:
            case ex.UnaryOperation(_, operand):
                waiting.append(operand)
            case ex.BinaryOperation(_, left, right):
                waiting += (right, left)
            case ex.Choice(condition, then, otherwise):
                waiting += (otherwise, then, condition)
            case ex.PathFormula(_, body, _, left):
                waiting += (body, left)
            case ex.VariableValue(slot) | ex.Lookup(_, slot):
                waiting += slot.indices
            case ex.Invoke(_, arguments) | ex.Fractional(_, arguments):
                waiting += arguments
            case _:
                pass


def parts_in(statements: Sequence[ex.Statement]) -> Iterator[ex.Expression]:
    """All expressions in statements, with all their subexpressions."""
    for statement in ex.statements_in(statements):
        for expression in ex.expressions_of(statement):
            yield from parts_of(expression)


def is_discrete(expression: ex.Expression) -> bool:
    """Whether locations and variables alone determine the value of the expression."""
    of_runs = ex.ClockCompare | ex.Deadlock | ex.PathFormula
    return not any(isinstance(part, of_runs) for part in parts_of(expression))


def resets_in(updates: Sequence[ex.Statement]) -> Iterator[ex.Reset]:
    """All resets of clocks in some statements and in the functions that they call."""
    for statement in ex.statements_in(updates):
        if isinstance(statement, ex.Reset):
            yield statement
        for part in (p for e in ex.expressions_of(statement) for p in parts_of(e)):
            if isinstance(part, ex.Invoke) and part.function.changes:
                yield from resets_in(part.function.body)


def refuse_changes(expression: ex.Expression, span: Span) -> None:
    """Refuse a condition or number whose evaluation changes variables."""
    for part in parts_of(expression):
        if isinstance(part, ex.Invoke) and part.function.changes:
            message = f"`{part.function.name}` changes variables or clocks"
            fix = "call it in an update; conditions must not change anything"
            raise model_error("TA009", message, span, fix)


def is_linear(expression: ex.Expression) -> bool:
    """Whether an expression has operators on a single run, as opposed to all runs from a state."""
    linear = (ex.PathOp.FINALLY, ex.PathOp.GLOBALLY, ex.PathOp.EVERY_RUN, ex.PathOp.SOME_RUN)
    parts = parts_of(expression)
    return any(isinstance(part, ex.PathFormula) and part.op in linear for part in parts)


def compares_of(expression: ex.Expression) -> Iterator[ex.ClockCompare]:
    """All comparisons of clocks in an expression."""
    return (part for part in parts_of(expression) if isinstance(part, ex.ClockCompare))


def has_deadlock(formula: ex.Expression) -> bool:
    """Whether `deadlock` occurs in a formula."""
    return any(isinstance(part, ex.Deadlock) for part in parts_of(formula))


def has_paths(formula: ex.Expression) -> bool:
    """Whether a path operator occurs in a formula."""
    return any(isinstance(part, ex.PathFormula) for part in parts_of(formula))


def is_plain(formula: ex.Expression) -> bool:
    """Whether a formula depends on the state alone: it has no path operator and no deadlock."""
    return not any(isinstance(part, ex.PathFormula | ex.Deadlock) for part in parts_of(formula))


def _denied(expression: ex.Expression) -> ex.Expression:
    """The negation of an expression, without double negation."""
    match expression:
        case ex.UnaryOperation(ex.UnaryOp.NOT, operand):
            return operand
        case _:
            return ex.UnaryOperation(ex.UnaryOp.NOT, expression)


def normal_form(expression: ex.Expression, positive: bool = True) -> ex.Expression:
    """The expression or its negation, with `and` and `or` over discrete parts and atoms.

    Raises:
        ModelError: the normal form would have more than `MOST_PARTS` parts.
    """
    if _size(expression) > MOST_PARTS:
        raise model_error("TA019", "too many conditions are compared", None, "split the condition")
    return _normal_form(expression, positive)


def _size(expression: ex.Expression) -> int:
    """The number of parts of the normal form, in which each side of a comparison occurs twice."""
    if is_discrete(expression):
        return 1
    match expression:
        case ex.UnaryOperation(_, operand):
            return _size(operand)
        case ex.PathFormula(_, body, _, left):
            return _size(body) + _size(left)
        case ex.BinaryOperation(op, left, right):
            return (1 + (op in (ex.BinaryOp.EQ, ex.BinaryOp.NE))) * (_size(left) + _size(right))
        case ex.Choice(condition, then, otherwise):
            return 2 * _size(condition) + _size(then) + _size(otherwise)
        case _:
            return 1


def _normal_form(expression: ex.Expression, positive: bool = True) -> ex.Expression:
    if is_discrete(expression):
        return expression if positive else _denied(expression)
    match expression:
        case ex.ClockCompare(clock, op, bound):
            return expression if positive else ex.ClockCompare(clock, _NEGATED_CLOCK[op], bound)
        case ex.Deadlock():
            return expression if positive else ex.UnaryOperation(ex.UnaryOp.NOT, expression)
        case ex.PathFormula(op, body, bound, left):
            op = op if positive else _NEGATED_PATH[op]
            return ex.PathFormula(op, _normal_form(body, positive), bound, _normal_form(left))
        case ex.UnaryOperation(ex.UnaryOp.NOT, operand):
            return _normal_form(operand, not positive)
        case ex.BinaryOperation(
            ex.BinaryOp.AND | ex.BinaryOp.OR | ex.BinaryOp.IMPLY as op, left, right
        ):
            first = _normal_form(left, positive != (op is ex.BinaryOp.IMPLY))
            op = ex.BinaryOp.AND if (op is ex.BinaryOp.AND) == positive else ex.BinaryOp.OR
            return ex.BinaryOperation(op, first, _normal_form(right, positive))
        case ex.BinaryOperation(ex.BinaryOp.EQ | ex.BinaryOp.NE as op, left, right):
            # `p == q` between conditions is "both or neither", `p != q` is "one of them".
            same = (op is ex.BinaryOp.EQ) == positive
            return _chosen(left, _normal_form(right, same), _normal_form(right, not same))
        case ex.Choice(condition, then, otherwise):
            yes, no = _normal_form(then, positive), _normal_form(otherwise, positive)
            return _chosen(condition, yes, no)
        case _:  # arithmetic on something that is not discrete
            raise AssertionError(f"{expression} is no condition")


def _chosen(
    condition: ex.Expression, then: ex.Expression, otherwise: ex.Expression
) -> ex.Expression:
    """`condition and then or not condition and otherwise`."""
    yes = ex.BinaryOperation(ex.BinaryOp.AND, _normal_form(condition), then)
    no = ex.BinaryOperation(ex.BinaryOp.AND, _normal_form(condition, positive=False), otherwise)
    return ex.BinaryOperation(ex.BinaryOp.OR, yes, no)


def with_deadlock(formula: ex.Expression, value: bool) -> ex.Expression:
    """Replace `deadlock` in a normalised formula by a truth value."""
    match formula:
        case ex.Deadlock():
            return ex.Constant(int(value))
        case ex.UnaryOperation(ex.UnaryOp.NOT, ex.Deadlock()):
            return ex.Constant(int(not value))
        case ex.BinaryOperation(op, left, right) if not is_discrete(formula):
            return ex.BinaryOperation(op, with_deadlock(left, value), with_deadlock(right, value))
        case _:
            return formula


def split_guard(expression: ex.Expression, span: Span) -> Guard:
    """Split a condition into its discrete part and the clock bounds that must all hold."""
    guard, *others = islice(guards_of(expression), 2)
    if others:
        fix = "make one location for each alternative"
        raise model_error("TA009", "a clock under `or`", span, fix)
    return guard


def guards_of(expression: ex.Expression) -> Iterator[Guard]:
    """Split a condition into disjoint guards: exactly one holds wherever the condition does.

    The guards are made lazily.
    """
    return map(_guard, _cases(normal_form(expression)))


MOST_PARTS = 100_000  # limit for the parts of a condition in normal form
MOST_PIECES = 4000  # limit for the alternatives into which a formula is split


def conjunction(parts: Iterable[ex.Expression]) -> ex.Expression:
    """The conjunction of some formulas, without those that are always true."""
    formula: ex.Expression = ex.TRUE
    for part in parts:
        if part == ex.FALSE:
            return ex.FALSE
        if formula == ex.TRUE:
            formula = part
        elif part != ex.TRUE:
            formula = ex.BinaryOperation(ex.BinaryOp.AND, formula, part)
    return formula


def disjunction(parts: Sequence[ex.Expression]) -> ex.Expression:
    """The disjunction of some formulas, as a balanced tree so that recursion stays shallow."""
    if len(parts) < 2:
        return parts[0] if parts else ex.FALSE
    middle = len(parts) // 2
    return ex.BinaryOperation(
        ex.BinaryOp.OR, disjunction(parts[:middle]), disjunction(parts[middle:])
    )


def alternatives_of(
    formula: ex.Expression | None, due: Sequence[ex.ClockCompare] = ()
) -> list[Guard]:
    """Split a plain normalised formula into guards, at least one of which holds where it does.

    Args:
        formula: without path operators and `deadlock`; `None` gives no guards.
        due: bounds that are added to each guard.
    """
    pieces = [] if formula is None else distributed(formula, is_discrete)
    return [_guard([*parts, *due]) for parts in pieces]


def distributed(
    formula: ex.Expression, is_whole: Callable[[ex.Expression], bool]
) -> list[list[ex.Expression]]:
    """Split a normalised formula into conjunctions; subformulas that are `is_whole` stay intact."""
    match formula:
        case ex.BinaryOperation(ex.BinaryOp.OR, left, right) if not is_whole(formula):
            return [*distributed(left, is_whole), *distributed(right, is_whole)]
        case ex.BinaryOperation(ex.BinaryOp.AND, left, right) if not is_whole(formula):
            some, others = distributed(left, is_whole), distributed(right, is_whole)
            if len(some) * len(others) > MOST_PIECES:
                raise model_error("TA019", "the query has too many alternatives", None)
            return [[*one, *other] for one in some for other in others]
        case _:
            return [[formula]]


def _guard(parts: Sequence[ex.Expression]) -> Guard:
    data = conjunction(part for part in parts if not isinstance(part, ex.ClockCompare))
    return Guard(data, tuple(part for part in parts if isinstance(part, ex.ClockCompare)))


def _cases(formula: ex.Expression) -> Iterator[list[ex.Expression]]:
    """Split a normalised condition into disjoint alternatives, each a list of conjuncts.

    `p or q` gives p, and q without p. The alternatives are made lazily, since there may be many
    more than the caller needs.
    """
    match formula:
        case _ if is_discrete(formula):
            yield [*chained(ex.BinaryOp.AND, formula)]
        case ex.BinaryOperation(ex.BinaryOp.AND, left, right):
            yield from ([*one, *other] for one in _cases(left) for other in _cases(right))
        case ex.BinaryOperation(ex.BinaryOp.OR, left, right):
            yield from _cases(left)
            yield from _cases(ex.BinaryOperation(ex.BinaryOp.AND, normal_form(left, False), right))
        case _:
            yield [formula]
