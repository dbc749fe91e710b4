"""Whether a trigger is a pulse, by syntax."""

from __future__ import annotations

from typing import assert_never

from rvmon.spec.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.testing.law.numbers import events_of


def is_pulse(formula: Formula, *, negated: bool = False) -> bool:
    """Whether the negation normal form of a trigger (or of its negation) is a pulse.

    Source: SEMANTICS, section 3 (Requirements, `upon`).

    >>> is_pulse(Binary(BinaryOp.AND, EventAtom("sensed"), SignalAtom("ready")))
    True
    >>> is_pulse(Unary(UnaryOp.NOT, EventAtom("sensed")))
    False
    """
    match formula:
        case Constant(value=value):
            return value is negated
        case EventAtom():
            return not negated
        case Compare(left=left, right=right):
            return not negated and bool([*events_of(left), *events_of(right)])
        case ProbeAtom(probe=probe):
            return not negated and probe is not Probe.KNOWN
        case SignalAtom() | BoundAtom() | Amount():
            return False
        case Unary(op=UnaryOp.NOT, operand=operand):
            return is_pulse(operand, negated=not negated)
        case Unary(op=op):
            return not negated and op in (UnaryOp.RISE, UnaryOp.FALL)
        case Binary(op=op, left=left, right=right):
            return _binary(op, left, right, negated)
        case _:
            assert_never(formula)


def _binary(op: BinaryOp, left: Formula, right: Formula, negated: bool) -> bool:
    def both(left_negated: bool, right_negated: bool) -> bool:
        """Of a disjunction both have to be pulses."""
        return is_pulse(left, negated=left_negated) and is_pulse(right, negated=right_negated)

    def either(left_negated: bool, right_negated: bool) -> bool:
        """Of a conjunction one has to be a pulse."""
        return is_pulse(left, negated=left_negated) or is_pulse(right, negated=right_negated)

    match op:
        case BinaryOp.AND:
            return both(True, True) if negated else either(False, False)
        case BinaryOp.OR:
            return either(True, True) if negated else both(False, False)
        case BinaryOp.IMPLIES:
            return either(False, True) if negated else both(True, False)
        case BinaryOp.IFF if negated:
            return both(True, True) or both(False, False)
        case BinaryOp.IFF:
            return either(False, False) and either(True, True)
        case BinaryOp.XOR if negated:
            return both(True, False) or both(False, True)
        case BinaryOp.XOR:
            return either(False, True) and either(True, False)
        case _:
            return False
