"""Properties of formulas that can be read off their syntax."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from rvmon.language.checked.formula import (
    Amount,
    Arithmetic,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Constant,
    Formula,
    Interval,
    Numeric,
    Passed,
    Unary,
    UnaryOp,
    windows_in,
)
from rvmon.language.checked.specification import Requirement
from rvmon.testing.law.word import Truth, conjunction, disjunction, negation, truth_of


def subformulas(formula: Formula) -> Iterator[Formula]:
    """The formula and all its subformulas, from the top."""
    yield formula
    match formula:
        case Unary(operand=operand):
            yield from subformulas(operand)
        case Amount():
            for part in formula.operands:
                yield from subformulas(part)
        case Compare(left=left, right=right):
            for window in windows_in(left, right):
                for part in window.operands:
                    yield from subformulas(part)
        case Passed(known=known):
            yield known
        case Binary(left=left, right=right):
            yield from subformulas(left)
            yield from subformulas(right)
        case _:
            return


_FUTURE = {
    *(UnaryOp.NEXT, UnaryOp.EVENTUALLY, UnaryOp.ALWAYS),
    *(BinaryOp.UNTIL, BinaryOp.RELEASE, BinaryOp.WEAK_UNTIL, BinaryOp.STRONG_RELEASE),
}

_BOOLEAN = {UnaryOp.NOT, BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLIES, BinaryOp.IFF, BinaryOp.XOR}


def speaks_of_future(formula: Formula) -> bool:
    """Whether a formula has a future operator."""
    return any(
        isinstance(part, Unary | Binary) and part.op in _FUTURE for part in subformulas(formula)
    )


def looks_back_at_future(formula: Formula) -> bool:
    """Whether a future operator stands below a past operator."""
    return any(
        isinstance(part, Unary | Binary)
        and part.op not in _BOOLEAN | _FUTURE
        and speaks_of_future(part)
        for part in subformulas(formula)
    )


def is_composed(formula: Formula) -> TypeGuard[Unary | Binary]:
    """Whether a formula is a Boolean combination, or has a future operator: no proposition."""
    if isinstance(formula, Unary | Binary):
        return formula.op in _BOOLEAN or speaks_of_future(formula)
    return False


def intervals(formula: Formula) -> Iterator[Interval]:
    """The intervals of all temporal operators."""
    for part in subformulas(formula):
        if isinstance(part, Unary | Binary) and part.interval is not None:
            yield part.interval


def numerics(formula: Formula) -> Iterator[Numeric]:
    """All numeric expressions and their parts."""
    for part in subformulas(formula):
        if isinstance(part, Compare):
            yield from parts_of(part.left)
            yield from parts_of(part.right)


def parts_of(expression: Numeric) -> Iterator[Numeric]:
    """The expression and all its parts, from the top."""
    yield expression
    if isinstance(expression, Arithmetic):
        for arg in expression.args:
            yield from parts_of(arg)


def by_and_or(formula: Binary) -> Binary:
    """`->`, `<->` and `xor` by conjunction, disjunction and negation; else the formula itself."""
    left, right = formula.left, formula.right
    no_left, no_right = Unary(UnaryOp.NOT, left), Unary(UnaryOp.NOT, right)
    match formula.op:
        case BinaryOp.IMPLIES:
            return Binary(BinaryOp.OR, no_left, right)
        case BinaryOp.IFF:
            both = Binary(BinaryOp.AND, left, right)
            return Binary(BinaryOp.OR, both, Binary(BinaryOp.AND, no_left, no_right))
        case BinaryOp.XOR:
            one = Binary(BinaryOp.AND, left, no_right)
            return Binary(BinaryOp.OR, one, Binary(BinaryOp.AND, no_left, right))
        case _:
            return formula


def constant_value(formula: Formula) -> Truth:
    """The truth of a formula if it is the same for all values of its propositions; else UNKNOWN."""
    match formula:
        case Constant(value=value):
            return truth_of(value)
        case Unary(op=UnaryOp.NOT, operand=operand):
            return negation(constant_value(operand))
        case Binary(op=BinaryOp.AND, left=left, right=right):
            return conjunction([constant_value(left), constant_value(right)])
        case Binary(op=BinaryOp.OR, left=left, right=right):
            return disjunction([constant_value(left), constant_value(right)])
        case Binary() if (spelled := by_and_or(formula)) is not formula:
            return constant_value(spelled)
    return Truth.UNKNOWN


def is_upon_end(requirement: Requirement) -> bool:
    """Whether the requirement is judged when the trace is finished."""
    trigger = requirement.trigger
    return isinstance(trigger, BoundAtom) and trigger.bound is Bound.END
