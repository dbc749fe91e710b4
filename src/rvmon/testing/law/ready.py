"""Whether what is owed has not failed at once: where an episode goes on after a failure."""

from __future__ import annotations

from dataclasses import replace

from rvmon.spec.checked.formula import Binary, BinaryOp, Formula, Interval, Unary, UnaryOp
from rvmon.testing.law.walk import speaks_of_future

_RELEASES = {UnaryOp.ALWAYS, BinaryOp.RELEASE, BinaryOp.WEAK_UNTIL}
_UNTILS = {UnaryOp.EVENTUALLY, BinaryOp.UNTIL, BinaryOp.STRONG_RELEASE}


def opened_at_once(formula: Formula, *, positive: bool = True) -> Formula:
    """The formula with the windows of all that has to be kept up opened at once.

    In negation normal form these are the windows of `G` and `R`: their lower bounds become 0.

    Args:
        formula: a consequent or a part of one, with nothing of the future below the past.
        positive: whether an even number of negations stands above it.

    Source: SEMANTICS, section 3 (After a failure).
    """

    def same(part: Formula) -> Formula:
        return opened_at_once(part, positive=positive)

    def other(part: Formula) -> Formula:
        return Unary(UnaryOp.NOT, opened_at_once(part, positive=not positive))

    if not speaks_of_future(formula) or not isinstance(formula, Unary | Binary):
        return formula
    kept_up = _RELEASES if positive else _UNTILS
    interval = formula.interval
    if formula.op in kept_up and interval is not None:
        interval = Interval(0, interval.high)
    match formula:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return other(operand)
        case Unary(operand=operand):
            return replace(formula, operand=same(operand), interval=interval)
        case Binary(op=BinaryOp.IMPLIES, left=left, right=right):
            return Binary(BinaryOp.OR, other(left), same(right))
        case Binary(op=BinaryOp.IFF, left=left, right=right):
            both = Binary(BinaryOp.AND, same(left), same(right))
            return Binary(BinaryOp.OR, both, Binary(BinaryOp.AND, other(left), other(right)))
        case Binary(op=BinaryOp.XOR, left=left, right=right):
            one = Binary(BinaryOp.AND, same(left), other(right))
            return Binary(BinaryOp.OR, one, Binary(BinaryOp.AND, other(left), same(right)))
        case Binary(left=left, right=right):
            return replace(formula, left=same(left), right=same(right), interval=interval)
