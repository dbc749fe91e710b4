"""The common fragment: the few operators in which every formula of ours is said to a peer."""

from __future__ import annotations

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Interval,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    Unary,
    UnaryOp,
)
from rvmon.testing.walk import numerics, subformulas

EVER = Interval(0, None)


class UntranslatableError(ValueError):
    """The peer has no formula of this meaning; the text says what it lacks."""


def no(operand: Formula) -> Formula:
    """`not operand`."""
    return Unary(UnaryOp.NOT, operand)


def both(left: Formula, right: Formula) -> Formula:
    """`left and right`."""
    return Binary(BinaryOp.AND, left, right)


def either(left: Formula, right: Formula) -> Formula:
    """`left or right`."""
    return Binary(BinaryOp.OR, left, right)


def until(left: Formula, right: Formula, window: Interval) -> Formula:
    """`left U[window] right`."""
    return Binary(BinaryOp.UNTIL, left, right, window)


def names_in(formula: Formula) -> set[str]:
    """The signals and events that a formula reads."""
    found = {part.name for part in numerics(formula) if isinstance(part, SignalValue)}
    for part in subformulas(formula):
        match part:
            case SignalAtom(name=name) | EventAtom(name=name):
                found.add(name)
            case _:
                pass
    return found


def to_core(formula: Formula) -> Formula:
    """An equal formula in `not and or X F G U Y O H S` over propositions (SEMANTICS 2).

    >>> from rvmon.spec.checked.formula import SignalAtom
    >>> to_core(Unary(UnaryOp.RISE, SignalAtom("p"))) == both(
    ...     SignalAtom("p"), no(Unary(UnaryOp.PREVIOUS, SignalAtom("p"))))
    True
    """
    match formula:
        case Constant() | SignalAtom() | EventAtom() | Compare() | ProbeAtom() | BoundAtom():
            return formula
        case Unary():
            return _unary(formula, to_core(formula.operand))
        case Binary():
            return _binary(formula, to_core(formula.left), to_core(formula.right))


def _unary(formula: Unary, operand: Formula) -> Formula:
    match formula.op:
        case UnaryOp.RISE:
            return both(operand, no(Unary(UnaryOp.PREVIOUS, operand)))
        case UnaryOp.FALL:
            return both(no(operand), Unary(UnaryOp.PREVIOUS, operand))
        case UnaryOp.HELD:
            window = formula.interval or EVER
            held = Unary(UnaryOp.HISTORICALLY, operand, window)
            long_enough = Unary(UnaryOp.ONCE, Constant(True), Interval(window.high or 0, None))
            return both(held, long_enough)
        case _:
            return Unary(formula.op, operand, formula.interval)


def _binary(formula: Binary, left: Formula, right: Formula) -> Formula:
    window = formula.interval or EVER
    match formula.op:
        case BinaryOp.IMPLIES:
            return either(no(left), right)
        case BinaryOp.IFF:
            return either(both(left, right), both(no(left), no(right)))
        case BinaryOp.XOR:
            return either(both(left, no(right)), both(no(left), right))
        case BinaryOp.RELEASE:
            return no(until(no(left), no(right), window))
        case BinaryOp.WEAK_UNTIL:
            return no(until(no(right), no(either(left, right)), window))
        case BinaryOp.STRONG_RELEASE:
            return until(right, both(left, right), window)
        case _:
            return Binary(formula.op, left, right, formula.interval)
