"""Scopes worked into trigger and consequent, so that nothing behind needs to know of them.

A scope is a stretch of the run: it opens where `opening` holds (or at the start) and closes right
before `closing` holds (or never). What is owed is judged as if the run ended where the scope
closes; where the scope has to close (`before`, `between`), nothing is owed until it does.

Source: Dwyer, Avrunin, Corbett, Patterns in Property Specifications for Finite-State Verification
(ICSE 1999): the formulas of their catalogue are instances of this translation.
"""

from __future__ import annotations

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Constant,
    Formula,
    Interval,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.operators import Tense
from rvmon.spec.checked.reading import rewritten
from rvmon.spec.checked.tense import has_future

_ALL = Interval()


def scoped_trigger(trigger: Formula, opening: Formula | None, closing: Formula | None) -> Formula:
    """The trigger inside the scope; `start` alone is where the scope opens."""
    inside = _inside(opening, closing)
    match trigger:
        case BoundAtom(bound=Bound.START) if opening is None:
            return _and(trigger, inside)
        case BoundAtom(bound=Bound.START):
            return Unary(UnaryOp.RISE, inside, None, trigger.span)
        case Constant(value=True):
            return inside
        case _:
            return _and(trigger, inside)


def scoped_consequent(consequent: Formula, closing: Formula | None, *, must_close: bool) -> Formula:
    """What is owed within the scope."""
    if closing is None:
        return consequent
    owed = _until_closed(consequent, closing)
    if not must_close:
        return owed
    never = Unary(UnaryOp.ALWAYS, _not(closing), _ALL, closing.span)
    return Binary(BinaryOp.OR, owed, never, None, consequent.span)


def _inside(opening: Formula | None, closing: Formula | None) -> Formula:
    """Whether the scope is open."""
    if opening is None and closing is not None:
        return _not(Unary(UnaryOp.ONCE, closing, _ALL, closing.span))
    if opening is None or closing is None:
        held = opening or Constant(True)
        return Unary(UnaryOp.ONCE, held, _ALL, held.span)
    opened = _and(opening, _not(closing))
    return Binary(BinaryOp.SINCE, _not(closing), opened, _ALL, opening.span)


def _until_closed(formula: Formula, closing: Formula) -> Formula:
    """The formula over the run that ends right before `closing` first holds from here on.

    What must come has to come before that (`U` takes `not closing` on both sides); what must hold
    has to hold until then (the dual).
    """
    if not has_future(formula):
        return formula
    # People read what comes of it: these have shorter forms than what they are made of.
    match formula:
        case Unary(op=op, operand=operand, interval=interval, span=span):
            inner = _until_closed(operand, closing)
            match op:
                case UnaryOp.EVENTUALLY:
                    reached = _and(inner, _not(closing))
                    return Binary(BinaryOp.UNTIL, _not(closing), reached, interval, span)
                case UnaryOp.ALWAYS:
                    excused = Binary(BinaryOp.OR, inner, closing, None, operand.span)
                    return Binary(BinaryOp.RELEASE, closing, excused, interval, span)
                case UnaryOp.NEXT:
                    return Unary(op, _and(inner, _not(closing)), None, span)
                case _ if op.entry.tense is Tense.FUTURE:
                    return _until_closed(rewritten(formula), closing)
                case _:
                    return Unary(op, inner, interval, span)
        case Binary(op=op, interval=interval, span=span):
            left = _until_closed(formula.left, closing)
            right = _until_closed(formula.right, closing)
            match op:
                case BinaryOp.UNTIL:
                    left, right = _and(left, _not(closing)), _and(right, _not(closing))
                case BinaryOp.RELEASE:
                    left, right = _or(left, closing), _or(right, closing)
                case BinaryOp.WEAK_UNTIL:
                    right = _or(right, closing)
                case BinaryOp.STRONG_RELEASE:
                    right = _and(right, _not(closing))
                case _ if op.entry.tense is Tense.FUTURE:
                    return _until_closed(rewritten(formula), closing)
            return Binary(op, left, right, interval, span)
        case _:
            return formula


def _and(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOp.AND, left, right, None, left.span)


def _or(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOp.OR, left, right, None, left.span)


def _not(formula: Formula) -> Formula:
    return Unary(UnaryOp.NOT, formula, None, formula.span)
