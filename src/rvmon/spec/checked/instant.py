"""What formulas are at one instant, as far as is known without a trace."""

from __future__ import annotations

from collections.abc import Hashable, Mapping

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Constant,
    EventAtom,
    Formula,
    Interval,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.tense import fields_in

Facts = Mapping[Hashable, bool]
"""What is known of propositions at an instant, by what they say."""

FIRST: Facts = {Bound.START: True}
"""Of the first instant of a run."""

_OPPOSITE = {
    CompareOp.GE: CompareOp.LT,
    CompareOp.GT: CompareOp.LE,
    CompareOp.NE: CompareOp.EQ,
}
_WHOLE = Interval()


def facts_of(formula: Formula, truth: bool = True) -> dict[Hashable, bool]:
    """What has to be so where a formula of the present and past is true, or false.

    >>> facts_of(Binary(BinaryOp.AND, EventAtom("e"), Unary(UnaryOp.NOT, SignalAtom("p"))))
    {'e': True, 'p': False}
    """
    match formula:
        case Constant():
            return {}
        case Unary(op=UnaryOp.NOT, operand=operand):
            return facts_of(operand, not truth)
        case Unary(op=UnaryOp.RISE | UnaryOp.HELD, operand=operand) if truth:
            return facts_of(operand)
        case Unary(op=UnaryOp.FALL, operand=operand) if truth:
            return facts_of(operand, False)
        case Binary(op=BinaryOp.AND | BinaryOp.OR as op, left=left, right=right):
            sides = facts_of(left, truth), facts_of(right, truth)
            return _joined(*sides, all_hold=truth is (op is BinaryOp.AND))
        case Binary(op=BinaryOp.IMPLIES, left=left, right=right):
            sides = facts_of(left, not truth), facts_of(right, truth)
            return _joined(*sides, all_hold=not truth)
        case Unary() | Binary():
            return {}
        case Compare():
            key, same = _compared(formula)
            occurring: dict[Hashable, bool] = dict.fromkeys(_events(formula) if truth else (), True)
            return {key: truth is same, **occurring}
        case _:
            return {_key(formula): truth}


def truth_at(formula: Formula, facts: Facts) -> bool | None:
    """What a formula is at an instant; `None` if that depends on more than is known.

    Args:
        formula: of any tense.
        facts: what is known of the instant; `FIRST` if it is the first one.
    """
    match formula:
        case Constant(value=value):
            return value
        case Compare():
            key, same = _compared(formula)
            if any(facts.get(event) is False for event in _events(formula)):
                return False
            known = facts.get(key)
            return None if known is None else known is same
        case SignalAtom() | EventAtom() | ProbeAtom() | BoundAtom():
            return facts.get(_key(formula))
        case Unary(op=op, operand=operand, interval=interval):
            return _unary(op, truth_at(operand, facts), interval or _WHOLE, facts)
        case Binary(op=op, left=left, right=right, interval=interval):
            sides = truth_at(left, facts), truth_at(right, facts)
            return _binary(op, *sides, interval or _WHOLE, facts)


def _unary(op: UnaryOp, here: bool | None, window: Interval, facts: Facts) -> bool | None:
    first = facts.get(Bound.START) is True
    match op:
        case UnaryOp.NOT:
            return None if here is None else not here
        case UnaryOp.EVENTUALLY:
            return True if here and not window.low else None
        case UnaryOp.ALWAYS:
            return False if here is False and not window.low else None
        case UnaryOp.ONCE:
            if window.low:
                return False if first else None
            return here if first or here else None
        case UnaryOp.HISTORICALLY:
            if window.low:
                return True if first else None
            return here if first or here is False else None
        case UnaryOp.RISE:
            return here if first or here is False else None
        case UnaryOp.FALL:
            return False if first or here else None
        case UnaryOp.HELD:
            return False if here is False or (first and window.high) else None
        case UnaryOp.PREVIOUS:
            return False if first else None
        case UnaryOp.NEXT:
            return None


def _binary(
    op: BinaryOp, left: bool | None, right: bool | None, window: Interval, facts: Facts
) -> bool | None:
    match op:
        case BinaryOp.AND:
            return _both(left, right)
        case BinaryOp.OR:
            return _either(left, right)
        case BinaryOp.IMPLIES:
            return _either(_not(left), right)
        case BinaryOp.IFF | BinaryOp.XOR:
            if left is None or right is None:
                return None
            return (left is right) is (op is BinaryOp.IFF)
        case BinaryOp.SINCE if facts.get(Bound.START):
            return False if window.low else right
        case BinaryOp.SINCE | BinaryOp.UNTIL:
            return _until(left, right, window.low)
        case BinaryOp.RELEASE:
            return _not(_until(_not(left), _not(right), window.low))
        case BinaryOp.WEAK_UNTIL:
            return _not(_until(_not(right), _not(_either(left, right)), window.low))
        case BinaryOp.STRONG_RELEASE:
            return _until(right, _both(left, right), window.low)


def _until(left: bool | None, right: bool | None, low: int) -> bool | None:
    """Of `left U right` by what both are now; the right side may come later."""
    if not low and right is not False:
        return right
    return False if left is False else None


def _joined(
    one: dict[Hashable, bool], other: dict[Hashable, bool], *, all_hold: bool
) -> dict[Hashable, bool]:
    """The facts of two formulas, both of which hold, or one of them."""
    if all_hold:
        return {**one, **other}
    return {key: truth for key, truth in one.items() if other.get(key) is truth}


def _not(one: bool | None) -> bool | None:
    return None if one is None else not one


def _both(one: bool | None, other: bool | None) -> bool | None:
    if one is False or other is False:
        return False
    return True if one and other else None


def _either(one: bool | None, other: bool | None) -> bool | None:
    return _not(_both(_not(one), _not(other)))


def _compared(formula: Compare) -> tuple[Hashable, bool]:
    """A comparison or its opposite, and whether it is the comparison itself.

    One that reads a field of an event has no opposite: both are false where that does not occur.
    """
    opposite = None if _events(formula) else _OPPOSITE.get(formula.op)
    return (opposite or formula.op, formula.left, formula.right), opposite is None


def _events(formula: Compare) -> list[str]:
    """The events whose fields are compared."""
    return [field.event for side in (formula.left, formula.right) for field in fields_in(side)]


def _key(atom: SignalAtom | EventAtom | ProbeAtom | BoundAtom) -> Hashable:
    match atom:
        case SignalAtom(name=name) | EventAtom(name=name):
            return name
        case ProbeAtom(probe=probe, name=name):
            return probe, name
        case BoundAtom(bound=bound):
            return bound
