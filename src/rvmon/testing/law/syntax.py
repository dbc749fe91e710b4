"""Properties of formulas that can be read off their syntax."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from rvmon.language.checked import formula as rv
from rvmon.language.checked.specification import Requirement
from rvmon.testing.law.word import Truth, conjunction, disjunction, negation, truth_of


def subformulas(formula: rv.Formula) -> Iterator[rv.Formula]:
    """The formula and all its subformulas, from the top."""
    yield formula
    match formula:
        case rv.Unary(operand=operand):
            yield from subformulas(operand)
        case rv.Amount():
            for part in formula.operands:
                yield from subformulas(part)
        case rv.Compare(left=left, right=right):
            for window in rv.windows_in(left, right):
                for part in window.operands:
                    yield from subformulas(part)
        case rv.Passed(known=known):
            yield known
        case rv.Binary(left=left, right=right):
            yield from subformulas(left)
            yield from subformulas(right)
        case _:
            return


_FUTURE = {
    *(rv.UnaryOp.NEXT, rv.UnaryOp.EVENTUALLY, rv.UnaryOp.ALWAYS),
    *(rv.BinaryOp.UNTIL, rv.BinaryOp.RELEASE, rv.BinaryOp.WEAK_UNTIL, rv.BinaryOp.STRONG_RELEASE),
}

_BOOLEAN = {
    rv.UnaryOp.NOT,
    rv.BinaryOp.AND,
    rv.BinaryOp.OR,
    rv.BinaryOp.IMPLIES,
    rv.BinaryOp.IFF,
    rv.BinaryOp.XOR,
}


def speaks_of_future(formula: rv.Formula) -> bool:
    """Whether a formula has a future operator."""
    return any(
        isinstance(part, rv.Unary | rv.Binary) and part.op in _FUTURE
        for part in subformulas(formula)
    )


def looks_back_at_future(formula: rv.Formula) -> bool:
    """Whether a future operator occurs below a past operator."""
    return any(
        isinstance(part, rv.Unary | rv.Binary)
        and part.op not in _BOOLEAN | _FUTURE
        and speaks_of_future(part)
        for part in subformulas(formula)
    )


def is_composed(formula: rv.Formula) -> TypeGuard[rv.Unary | rv.Binary]:
    """Whether a formula is not a proposition: a Boolean combination, or with future operators."""
    if isinstance(formula, rv.Unary | rv.Binary):
        return formula.op in _BOOLEAN or speaks_of_future(formula)
    return False


def intervals(formula: rv.Formula) -> Iterator[rv.Interval]:
    """The intervals of all temporal operators."""
    for part in subformulas(formula):
        if isinstance(part, rv.Unary | rv.Binary) and part.interval is not None:
            yield part.interval


def numerics(formula: rv.Formula) -> Iterator[rv.Numeric]:
    """All numeric expressions and their parts."""
    for part in subformulas(formula):
        if isinstance(part, rv.Compare):
            yield from rv.numbers_in(part.left, part.right)


def by_and_or(formula: rv.Binary) -> rv.Binary:
    """Rewrite `->`, `<->` and `xor` with `and`, `or` and `not`; other formulas are unchanged."""
    left, right = formula.left, formula.right
    no_left, no_right = rv.Unary(rv.UnaryOp.NOT, left), rv.Unary(rv.UnaryOp.NOT, right)
    match formula.op:
        case rv.BinaryOp.IMPLIES:
            return rv.Binary(rv.BinaryOp.OR, no_left, right)
        case rv.BinaryOp.IFF:
            both = rv.Binary(rv.BinaryOp.AND, left, right)
            return rv.Binary(rv.BinaryOp.OR, both, rv.Binary(rv.BinaryOp.AND, no_left, no_right))
        case rv.BinaryOp.XOR:
            one = rv.Binary(rv.BinaryOp.AND, left, no_right)
            return rv.Binary(rv.BinaryOp.OR, one, rv.Binary(rv.BinaryOp.AND, no_left, right))
        case _:
            return formula


def constant_value(formula: rv.Formula) -> Truth:
    """The truth of a formula if its constants alone decide it; else UNKNOWN."""
    match formula:
        case rv.Constant(value=value):
            return truth_of(value)
        case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
            return negation(constant_value(operand))
        case rv.Binary(op=rv.BinaryOp.AND, left=left, right=right):
            return conjunction([constant_value(left), constant_value(right)])
        case rv.Binary(op=rv.BinaryOp.OR, left=left, right=right):
            return disjunction([constant_value(left), constant_value(right)])
        case rv.Binary() if (spelled := by_and_or(formula)) is not formula:
            return constant_value(spelled)
    return Truth.UNKNOWN


def is_upon_end(requirement: Requirement) -> bool:
    """Whether the requirement is judged when the trace is finished."""
    trigger = requirement.trigger
    return isinstance(trigger, rv.BoundAtom) and trigger.bound is rv.Bound.END
