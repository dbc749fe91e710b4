"""Operators applied to resolved expressions, and words of linear time in queries.

Constants are folded; clocks stand only where they may; integers join numbers with a fraction.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language.symbols import Calls, check_count, is_alike, leaves, value_of
from rvmon.models.network import LeadsToFormula
from rvmon.models.network.evaluate import apply_binary, apply_unary, check_shift, evaluator
from rvmon.models.network.expressions import (
    MAX_TIME,
    TRUE,
    BinaryOp,
    BinaryOperation,
    Choice,
    ClockCompare,
    ClockOp,
    Constant,
    Expression,
    Fractional,
    Invoke,
    PathFormula,
    PathOp,
    UnaryOp,
    UnaryOperation,
    VariableValue,
)
from rvmon.models.network.fractions import FUNCTIONS, OPERATIONS, gives_fraction, literal, number_of
from rvmon.models.network.guards import is_discrete, is_fixed, is_linear
from rvmon.models.network.scope import Symbol

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
_LOGICAL = {BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLY}
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


def unary(op: UnaryOp, operand: Expression, span: Span, calls: Calls) -> Expression:
    """An operator on one operand.

    Raises:
        ModelError: the operand speaks of clocks or runs, and the operator is arithmetic.
    """
    if op is not UnaryOp.NOT:
        refuse_clocks(operand, span)
        if is_real(operand, calls):
            instead = BinaryOp.SUB if op is UnaryOp.NEGATE else BinaryOp.BIT_XOR
            return binary(instead, Constant(0), operand, span, calls)
    if isinstance(operand, Constant):
        return Constant(apply_unary(op, operand.value))
    return UnaryOperation(op, operand)


def refuse_clocks(operand: Expression, span: Span) -> None:
    """Refuse what has no value in a discrete state."""
    if not is_discrete(operand):
        fix = "arithmetic is for numbers; join conditions by and, or, not, imply"
        raise model_error("TA009", "a condition on clocks or runs is no number", span, fix)


def binary(
    op: BinaryOp, left: Expression, right: Expression, span: Span, calls: Calls
) -> Expression:
    """An operator on two operands.

    Raises:
        ModelError: an operand speaks of clocks or runs and the operator is arithmetic; one has a
            fraction and the operator is of integers; a constant divisor is 0, or a constant shift
            none.
    """
    if op not in _LOGICAL and (is_real(left, calls) or is_real(right, calls)):
        if op not in OPERATIONS:
            raise model_error("TA004", f"`{op}` is for integers", span, "round them: fint(…)")
        return _fractional(op, (left, right), span, calls)
    if op not in _LOGICAL | SAMENESS:
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


def joined(op: BinaryOp, parts: Sequence[Expression], span: Span, calls: Calls) -> Expression:
    """Conditions joined as a balanced tree, which stays shallow however many there are."""
    if len(parts) == 1:
        return parts[0] if op is BinaryOp.ADD else truth(parts[0])
    half = len(parts) // 2
    left, right = (joined(op, own, span, calls) for own in (parts[:half], parts[half:]))
    return binary(op, left, right, span, calls)


def truth(expression: Expression) -> Expression:
    """The expression, which counts as a truth value where it stands."""
    return Constant(int(bool(expression.value))) if isinstance(expression, Constant) else expression


def whole_compare(
    op: BinaryOp, left: Symbol, right: Symbol, span: Span, calls: Calls
) -> Expression:
    """Arrays or records compared part by part.

    Raises:
        ModelError: they do not have the same parts.
    """
    if not is_alike(left, right):
        raise model_error("TA004", "these are not of one type", span)
    values = ((value_of(leaf, span) for leaf in leaves(side)) for side in (left, right))
    pairs = zip(*values, strict=True)
    parts = [binary(BinaryOp.EQ, one, other, span, calls) for one, other in pairs]
    same = joined(BinaryOp.AND, parts, span, calls)
    return same if op is BinaryOp.EQ else unary(UnaryOp.NOT, same, span, calls)


LINEAR_WORDS = "AEGFX"
"""Path quantifiers and temporal operators, which look like calls."""

_OF_CTL = {
    ("A", PathOp.FINALLY): PathOp.EVENTUALLY,
    ("A", PathOp.GLOBALLY): PathOp.INVARIANTLY,
    ("E", PathOp.FINALLY): PathOp.POSSIBLY,
    ("E", PathOp.GLOBALLY): PathOp.POTENTIALLY_ALWAYS,
}
_LINEAR = {
    PathOp.EVENTUALLY: (PathOp.EVERY_RUN, PathOp.FINALLY),
    PathOp.INVARIANTLY: (PathOp.EVERY_RUN, PathOp.GLOBALLY),
    PathOp.POSSIBLY: (PathOp.SOME_RUN, PathOp.FINALLY),
    PathOp.POTENTIALLY_ALWAYS: (PathOp.SOME_RUN, PathOp.GLOBALLY),
}


def assuming(asked: Expression | LeadsToFormula, premise: Expression, span: Span) -> PathFormula:
    """A query about those runs only of which a premise holds.

    Raises:
        ModelError: the query is none about whole runs.
    """
    match asked:
        case LeadsToFormula(left, right, None):
            answered = BinaryOperation(BinaryOp.IMPLY, left, PathFormula(PathOp.FINALLY, right))
            quantifier, body = PathOp.EVERY_RUN, PathFormula(PathOp.GLOBALLY, answered)
        case PathFormula(op, inner, None, left) if op in _LINEAR:
            quantifier, linear = _LINEAR[op]
            body = PathFormula(linear, inner, None, left)
        case PathFormula(PathOp.EVERY_RUN | PathOp.SOME_RUN as quantifier, body):
            pass
        case _ if isinstance(asked, LeadsToFormula) or not is_linear(asked):
            fix = "write p --> q, A<> p, or a formula of LTL such as G (p imply F q)"
            raise model_error("TA020", "`assuming` needs a query about whole runs", span, fix)
        case body:
            quantifier = PathOp.EVERY_RUN
    joined = BinaryOp.IMPLY if quantifier is PathOp.EVERY_RUN else BinaryOp.AND
    return PathFormula(quantifier, BinaryOperation(joined, premise, body))


def linear_of(name: str, body: Expression, span: Span) -> Expression:
    """The formula of `G (…)`, `F (…)`, `A (…)`, `E (…)`; the last two in CTL where possible."""
    match name, body:
        case "G", _:
            return PathFormula(PathOp.GLOBALLY, body)
        case "F", _:
            return PathFormula(PathOp.FINALLY, body)
        case "X", _:
            fix = "EX p, AX p refer to the next action"
            raise model_error("TA020", "time is dense: runs have no next instant", span, fix)
        case _, PathFormula(op, inner, None, left) if (name, op) in _OF_CTL and not any(
            map(is_linear, (inner, left))
        ):
            return PathFormula(_OF_CTL[name, op], inner, None, left)
        case _ if is_linear(body):
            return PathFormula(PathOp(name), body)
        case _:
            fix = f"as in {name} (G F p), {name} (p U q)"
            raise model_error("TA020", f"`{name}` refers to runs", span, fix)


# Numbers with a fraction.


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


def fractional_call(
    name: str, arguments: Sequence[Expression], span: Span, calls: Calls
) -> Expression:
    """A function of UPPAAL's."""
    check_count(name, range(FUNCTIONS[name]), arguments, span)
    return _fractional(name, arguments, span, calls)


def clock_number(value: Expression, calls: Calls) -> Expression:
    """The number for a clock in steps of the grid, also of a fraction of a unit."""
    if not is_real(value, calls):
        return value
    if is_fixed(value) and (number := number_of(evaluator(value)((), ()))).is_integer():
        return Constant(int(number))
    return Fractional("grid", (value,))


def _fractional(name: str, operands: Sequence[Expression], span: Span, calls: Calls) -> Expression:
    made = Fractional(name, tuple(as_real(operand, calls, span) for operand in operands), span)
    if not all(map(_is_literal, made.operands)):
        return made
    value = evaluator(made)((), ())
    return literal(number_of(value)) if gives_fraction(made) else Constant(value)


def _is_literal(value: Expression) -> bool:
    """Whether it is a number with a fraction as it is written."""
    match value:
        case Fractional("=", (Constant(),)):
            return True
        case _:
            return False
