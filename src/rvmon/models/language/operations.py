"""Operators applied to resolved expressions, and the linear-time words of queries.

Constants are folded, clocks are refused where they may not occur, and integers are converted where
they meet numbers with a fraction.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics import Span
from rvmon.models import model_error
from rvmon.models.language.symbols import check_count, is_alike, leaves, value_of
from rvmon.models.network import LeadsToFormula
from rvmon.models.network import expressions as ex
from rvmon.models.network.evaluate import OPERATIONS as ON_INTEGERS
from rvmon.models.network.evaluate import UNARY, check_shift, evaluator
from rvmon.models.network.fractions import (
    FUNCTIONS,
    OPERATIONS,
    gives_fraction,
    literal,
    marked,
    number_of,
)
from rvmon.models.network.guards import is_discrete, is_fixed, is_linear, parts_of
from rvmon.models.network.scope import Symbol

COMPARISONS = {*[*ex.BinaryOp][3:9]}
SAMENESS = {ex.BinaryOp.EQ, ex.BinaryOp.NE}
MIRRORED = {op: ex.BinaryOp(op.translate(str.maketrans("<>", "><"))) for op in COMPARISONS}
_LOGICAL = {ex.BinaryOp.AND, ex.BinaryOp.OR, ex.BinaryOp.IMPLY}
_PLACED = {ex.BinaryOp.DIV, ex.BinaryOp.MOD, ex.BinaryOp.SHIFT_LEFT, ex.BinaryOp.SHIFT_RIGHT}
_TWO_BOUNDS: dict[ex.BinaryOp, tuple[ex.BinaryOp, ex.ClockOp, ex.ClockOp]] = {
    ex.BinaryOp.EQ: (ex.BinaryOp.AND, ex.ClockOp.GE, ex.ClockOp.LE),
    ex.BinaryOp.NE: (ex.BinaryOp.OR, ex.ClockOp.LT, ex.ClockOp.GT),
}


def compare_clock(clock: int, op: ex.BinaryOp, bound: ex.Expression, span: Span) -> ex.Expression:
    """Express a comparison of a clock by one or two bounds."""
    if not is_discrete(bound):
        raise model_error("TA008", "a clock compared with clocks", span)
    if isinstance(bound, ex.Constant) and not 0 <= bound.value < ex.MAX_TIME:
        fix = f"clocks are compared with numbers from 0 to {ex.MAX_TIME - 1:,}"
        raise model_error("TA007", f"a clock compared with {bound.value}", span, fix)
    if op not in _TWO_BOUNDS:
        return ex.ClockCompare(clock, ex.ClockOp(op.value), bound)
    joined, *signs = _TWO_BOUNDS[op]
    first, second = (ex.ClockCompare(clock, sign, bound) for sign in signs)
    return ex.BinaryOperation(joined, first, second)


def unary(op: ex.UnaryOp, operand: ex.Expression, span: Span) -> ex.Expression:
    """Apply an operator to one operand."""
    if op is not ex.UnaryOp.NOT:
        refuse_clocks(operand, span)
        if gives_fraction(operand):
            instead = ex.BinaryOp.SUB if op is ex.UnaryOp.NEGATE else ex.BinaryOp.BIT_XOR
            return binary(instead, ex.Constant(0), operand, span)
    if isinstance(operand, ex.Constant):
        return ex.Constant(UNARY[op](operand.value))
    return ex.UnaryOperation(op, operand)


def refuse_clocks(operand: ex.Expression, span: Span) -> None:
    """Refuse expressions that a discrete state alone does not determine."""
    if not is_discrete(operand):
        fix = "arithmetic is for numbers; join conditions by and, or, not, imply"
        raise model_error("TA009", "a condition on clocks or runs is not a number", span, fix)


def binary(op: ex.BinaryOp, left: ex.Expression, right: ex.Expression, span: Span) -> ex.Expression:
    """Apply an operator to two operands."""
    if op not in _LOGICAL and (gives_fraction(left) or gives_fraction(right)):
        if op not in OPERATIONS:
            raise model_error("TA004", f"`{op}` is for integers", span, "round them: fint(…)")
        return _fractional(op, (left, right), span)
    if op not in _LOGICAL | SAMENESS:
        refuse_clocks(left, span)
        refuse_clocks(right, span)
    match op, left, right:
        case ex.BinaryOp.DIV | ex.BinaryOp.MOD, _, ex.Constant(0):
            raise model_error("TA007", "division by zero", span)
        case ex.BinaryOp.SHIFT_LEFT | ex.BinaryOp.SHIFT_RIGHT, _, ex.Constant(bits):
            check_shift(bits, span)
    match op, left, right:
        case _, ex.Constant(a), ex.Constant(b):
            return ex.Constant(ON_INTEGERS[op](a, b))
        case ex.BinaryOp.AND, ex.Constant(value), other:
            return truth(other) if value else ex.Constant(0)
        case ex.BinaryOp.OR, ex.Constant(value), other:
            return ex.TRUE if value else truth(other)
        case ex.BinaryOp.IMPLY, ex.Constant(value), other:
            return truth(other) if value else ex.TRUE
        case ex.BinaryOp.IMPLY, other, ex.Constant(0):
            return ex.UnaryOperation(ex.UnaryOp.NOT, other)
        case _:
            return ex.BinaryOperation(op, left, right, span if op in _PLACED else None)


def joined(op: ex.BinaryOp, parts: Sequence[ex.Expression], span: Span) -> ex.Expression:
    """Join conditions as a balanced tree, so that many of them stay shallow."""
    if len(parts) == 1:
        return parts[0] if op is ex.BinaryOp.ADD else truth(parts[0])
    half = len(parts) // 2
    left, right = (joined(op, own, span) for own in (parts[:half], parts[half:]))
    return binary(op, left, right, span)


def truth(expression: ex.Expression) -> ex.Expression:
    """The expression as a truth value: a constant becomes 0 or 1."""
    if isinstance(expression, ex.Constant):
        return ex.Constant(int(bool(expression.value)))
    return expression


def whole_compare(op: ex.BinaryOp, left: Symbol, right: Symbol, span: Span) -> ex.Expression:
    """Compare arrays or records part by part."""
    if not is_alike(left, right):
        raise model_error("TA004", "these have different types", span)
    values = ((value_of(leaf, span) for leaf in leaves(side)) for side in (left, right))
    pairs = zip(*values, strict=True)
    parts = [binary(ex.BinaryOp.EQ, one, other, span) for one, other in pairs]
    same = joined(ex.BinaryOp.AND, parts, span)
    return same if op is ex.BinaryOp.EQ else unary(ex.UnaryOp.NOT, same, span)


LINEAR_WORDS = "AEGFX"  # path quantifiers and temporal operators, which look like calls

_OF_CTL = {
    ("A", ex.PathOp.FINALLY): ex.PathOp.EVENTUALLY,
    ("A", ex.PathOp.GLOBALLY): ex.PathOp.INVARIANTLY,
    ("E", ex.PathOp.FINALLY): ex.PathOp.POSSIBLY,
    ("E", ex.PathOp.GLOBALLY): ex.PathOp.POTENTIALLY_ALWAYS,
}
_LINEAR = {op: (ex.PathOp(runs), linear) for (runs, linear), op in _OF_CTL.items()}


def assuming(
    query: ex.Expression | LeadsToFormula, premise: ex.Expression, span: Span
) -> ex.PathFormula:
    """Restrict a query to the runs that satisfy a premise."""
    match query:
        case LeadsToFormula(left, right, None):
            answered = ex.BinaryOperation(
                ex.BinaryOp.IMPLY, left, ex.PathFormula(ex.PathOp.FINALLY, right)
            )
            quantifier, body = ex.PathOp.EVERY_RUN, ex.PathFormula(ex.PathOp.GLOBALLY, answered)
        case ex.PathFormula(op, inner, None, left) if op in _LINEAR:
            quantifier, linear = _LINEAR[op]
            body = ex.PathFormula(linear, inner, None, left)
        case ex.PathFormula(ex.PathOp.EVERY_RUN | ex.PathOp.SOME_RUN as quantifier, body):
            pass
        case _ if isinstance(query, LeadsToFormula) or not is_linear(query):
            fix = "write p --> q, A<> p, or a formula of LTL such as G (p imply F q)"
            raise model_error("TA020", "`assuming` needs a query about whole runs", span, fix)
        case body:
            quantifier = ex.PathOp.EVERY_RUN
    joined = ex.BinaryOp.IMPLY if quantifier is ex.PathOp.EVERY_RUN else ex.BinaryOp.AND
    return ex.PathFormula(quantifier, ex.BinaryOperation(joined, premise, body))


def linear_of(name: str, body: ex.Expression, span: Span) -> ex.Expression:
    """The formula of `G (…)`, `F (…)`, `A (…)` or `E (…)`; the last two become CTL if possible."""
    match name, body:
        case "G", _:
            return ex.PathFormula(ex.PathOp.GLOBALLY, body)
        case "F", _:
            return ex.PathFormula(ex.PathOp.FINALLY, body)
        case "X", _:
            fix = "EX p, AX p refer to the next action"
            raise model_error("TA020", "time is dense: runs have no next instant", span, fix)
        case _, ex.PathFormula(op, inner, None, left) if (name, op) in _OF_CTL and not any(
            map(is_linear, (inner, left))
        ):
            return ex.PathFormula(_OF_CTL[name, op], inner, None, left)
        case _ if is_linear(body):
            return ex.PathFormula(ex.PathOp(name), body)
        case _:
            fix = f"as in {name} (G F p), {name} (p U q)"
            raise model_error("TA020", f"`{name}` refers to runs", span, fix)


# Numbers with a fraction.


def as_real(value: ex.Expression, span: Span) -> ex.Expression:
    """A number as one with a fraction, marked accordingly."""
    match value:
        case ex.Constant(number):
            return literal(number)
        case _ if gives_fraction(value):
            return value
        case _ if is_discrete(value):
            return ex.Fractional("double", (value,))
        case _:
            fix = "compare a clock, alone on its side"
            raise model_error("TA009", "a clock has no value here", span, fix)


def choice(
    test: ex.Expression, then: ex.Expression, otherwise: ex.Expression, span: Span
) -> ex.Expression:
    """Build `test ? then : otherwise`."""
    if isinstance(test, ex.Constant):
        return then if test.value else otherwise
    if not (gives_fraction(then) or gives_fraction(otherwise)):
        return ex.Choice(test, then, otherwise)
    return marked(ex.Choice(test, as_real(then, span), as_real(otherwise, span)), True)


def fitted(value: ex.Expression, real: bool, span: Span) -> ex.Expression:
    """Convert a value for a variable with or without a fraction."""
    if real:
        return as_real(value, span)
    if gives_fraction(value):
        fix = "round it: fint(…)"
        raise model_error("TA004", "an integer is set to a number with a fraction", span, fix)
    return value


def fractional_call(name: str, arguments: Sequence[ex.Expression], span: Span) -> ex.Expression:
    """Call one of UPPAAL's functions on numbers with a fraction."""
    check_count(name, range(FUNCTIONS[name]), arguments, span)
    return _fractional(name, arguments, span)


def clock_number(value: ex.Expression) -> ex.Expression:
    """The number that a clock is compared with or set to; a fraction of a unit in grid steps."""
    if not gives_fraction(value):
        return value
    if is_fixed(value) and (number := number_of(evaluator(value)((), ()))).is_integer():
        return ex.Constant(int(number))
    return ex.Fractional("grid", (value,))


def _fractional(name: str, operands: Sequence[ex.Expression], span: Span) -> ex.Expression:
    made = ex.Fractional(name, tuple(as_real(operand, span) for operand in operands), span)
    if not all(isinstance(part, ex.Fractional | ex.Constant) for part in parts_of(made)):
        return made
    value = evaluator(made)((), ())
    return literal(number_of(value)) if gives_fraction(made) else ex.Constant(value)
