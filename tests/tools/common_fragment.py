"""The common fragment: the few operators in which every formula of ours is given to a peer."""

from __future__ import annotations

from dataclasses import replace

from rvmon.language.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Passed,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.rewrite import Formulas, read

EVER = Interval(0, None)
_KEPT = (UnaryOp.EVENTUALLY, UnaryOp.ALWAYS, UnaryOp.ONCE, UnaryOp.HISTORICALLY)
"""Peers have operators for them."""


class UntranslatableError(ValueError):
    """The peer has no formula of this meaning; the text says what it lacks."""


def both(left: Formula, right: Formula) -> Formula:
    """`left and right`."""
    return Binary(BinaryOp.AND, left, right)


def either(left: Formula, right: Formula) -> Formula:
    """`left or right`."""
    return Binary(BinaryOp.OR, left, right)


def to_core(formula: Formula) -> Formula:
    """An equal formula in `not and or X F G U Y O H S` over propositions (SEMANTICS 2).

    >>> from rvmon.language.checked.formula import SignalAtom
    >>> p = SignalAtom("p")
    >>> before = Unary(UnaryOp.PREVIOUS, p)
    >>> to_core(Unary(UnaryOp.RISE, p)) == both(p, Unary(UnaryOp.NOT, before))
    True
    """
    match formula:
        case Constant() | SignalAtom() | EventAtom() | Compare() | ProbeAtom() | BoundAtom():
            return formula
        case Unary(op=op) if op in _KEPT:
            return replace(formula, operand=to_core(formula.operand))
        case Unary() | Binary():
            return read(formula, to_core, Formulas())
        case Amount() | Passed():
            raise ValueError("it counts")
