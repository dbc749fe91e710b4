"""A bare formula as trigger and consequent (SEMANTICS 3)."""

from __future__ import annotations

from rvmon.diagnostics.span import Span
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
from rvmon.spec.checked.specification import Mode
from rvmon.spec.checked.tense import future_part

_UNBOUNDED = Interval()


def normalised(formula: Formula) -> tuple[Mode, Formula, Formula]:
    """Mode, trigger and consequent of a requirement that is one formula.

    `G(θ → ψ)` is `whenever θ then ψ`, any other unbounded `G ψ` is `whenever true then ψ`, the
    rest is `upon start then φ`.
    """
    owed = _always(formula)
    if owed is None:
        return Mode.UPON, BoundAtom(Bound.START, formula.span), formula
    trigger: Formula | None = None
    while isinstance(owed, Binary) and owed.op is BinaryOp.IMPLIES and not future_part(owed.left):
        trigger = owed.left if trigger is None else _both(trigger, owed.left)
        owed = owed.right
    return Mode.WHENEVER, trigger or Constant(True, formula.span), owed


def _always(formula: Formula) -> Formula | None:
    """The φ of a formula that is `G φ` once `G G φ` and `G φ and G ψ` are joined."""
    match formula:
        case Unary(op=UnaryOp.ALWAYS, interval=interval) if interval == _UNBOUNDED:
            return _always(formula.operand) or formula.operand
        case Binary(op=BinaryOp.AND):
            left, right = _always(formula.left), _always(formula.right)
            return None if left is None or right is None else _both(left, right)
        case _:
            return None


def _both(left: Formula, right: Formula) -> Binary:
    return Binary(BinaryOp.AND, left, right, None, joined(left.span, right.span))


def joined(first: Span | None, second: Span | None) -> Span | None:
    """The range over two places of one text."""
    if first is None or second is None or first.source is not second.source:
        return first or second
    return first.to(second)
