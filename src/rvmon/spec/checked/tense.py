"""What a formula is by its syntax: present or future, pulse or level."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rvmon.spec.checked.formula import (
    Arithmetic,
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    FieldValue,
    Formula,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)

FUTURE: frozenset[UnaryOp | BinaryOp] = frozenset(
    {
        UnaryOp.NEXT,
        UnaryOp.EVENTUALLY,
        UnaryOp.ALWAYS,
        BinaryOp.UNTIL,
        BinaryOp.RELEASE,
        BinaryOp.WEAK_UNTIL,
        BinaryOp.STRONG_RELEASE,
    }
)
"""The operators that look ahead."""

PAST: frozenset[UnaryOp | BinaryOp] = frozenset(
    {
        UnaryOp.PREVIOUS,
        UnaryOp.ONCE,
        UnaryOp.HISTORICALLY,
        UnaryOp.RISE,
        UnaryOp.FALL,
        UnaryOp.HELD,
        BinaryOp.SINCE,
    }
)
"""The operators that look back."""

_TIMELESS = frozenset((UnaryOp.NOT, UnaryOp.RISE, UnaryOp.FALL))
_CONNECTIVES = frozenset((BinaryOp.AND, BinaryOp.OR, BinaryOp.IMPLIES, BinaryOp.IFF, BinaryOp.XOR))


def subformulas(formula: Formula) -> Iterator[Formula]:
    """The formula and all below it, from the outside in, left to right.

    A part that a macro shares between several places comes once.
    """
    waiting = [formula]
    seen: set[int] = set()
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        yield node
        match node:
            case Unary(operand=operand):
                waiting.append(operand)
            case Binary(left=left, right=right):
                waiting += (right, left)


def future_part(formula: Formula) -> Formula | None:
    """The first subformula that looks ahead."""
    for part in subformulas(formula):
        if isinstance(part, Unary | Binary) and part.op in FUTURE:
            return part
    return None


def has_future(formula: Formula) -> bool:
    """Whether a formula looks ahead."""
    return future_part(formula) is not None


def end_part(formula: Formula) -> Formula | None:
    """The first `end` in a formula."""
    for part in subformulas(formula):
        if isinstance(part, BoundAtom) and part.bound is Bound.END:
            return part
    return None


def is_timeless(formula: Formula) -> bool:
    """Whether no operator of time occurs, neither of the future nor of the past."""
    return all(
        part.op in (_TIMELESS | _CONNECTIVES)
        for part in subformulas(formula)
        if isinstance(part, Unary | Binary)
    )


def is_pulse(formula: Formula) -> bool:
    """Whether the negation normal form of a trigger is a pulse.

    >>> is_pulse(Binary(BinaryOp.AND, EventAtom("sensed"), SignalAtom("ready")))
    True
    >>> is_pulse(Unary(UnaryOp.NOT, EventAtom("sensed")))
    False
    """
    return _pulses(formula)[0]


def _pulses(formula: Formula) -> tuple[bool, bool]:
    """Whether the formula is a pulse, and whether its negation is."""
    match formula:
        case Constant(value=value):
            return not value, value
        case EventAtom():
            return True, False
        case Compare(left=left, right=right):
            return reads_field(left) or reads_field(right), False
        case ProbeAtom(probe=probe):
            return probe is not Probe.KNOWN, False
        case SignalAtom() | BoundAtom():
            return False, False
        case Unary(op=UnaryOp.NOT, operand=operand):
            positive, negative = _pulses(operand)
            return negative, positive
        case Unary(op=op):
            return op in (UnaryOp.RISE, UnaryOp.FALL), False
        case Binary(op=op, left=left, right=right):
            return _joined(op, _pulses(left), _pulses(right))
        case _:
            assert_never(formula)


def _joined(op: BinaryOp, left: tuple[bool, bool], right: tuple[bool, bool]) -> tuple[bool, bool]:
    """Of a conjunction either has to be a pulse, of a disjunction both."""
    (a, not_a), (b, not_b) = left, right
    match op:
        case BinaryOp.AND:
            return a or b, not_a and not_b
        case BinaryOp.OR:
            return a and b, not_a or not_b
        case BinaryOp.IMPLIES:
            return not_a and b, a or not_b
        case BinaryOp.IFF:
            return (a or b) and (not_a or not_b), (not_a and not_b) or (a and b)
        case BinaryOp.XOR:
            return (a or not_b) and (not_a or b), (not_a and b) or (a and not_b)
        case _:
            return False, False


def mixed_disjunction(trigger: Formula) -> tuple[Formula, Formula] | None:
    """A pulse and a level that a trigger joins by `or`, if it is no pulse altogether."""
    waiting = [trigger]
    while waiting:
        node = waiting.pop()
        if not isinstance(node, Binary) or is_pulse(node):
            continue
        sides = (node.left, node.right)
        if node.op is BinaryOp.OR and is_pulse(node.left) != is_pulse(node.right):
            return sides if is_pulse(node.left) else (node.right, node.left)
        if node.op in (BinaryOp.AND, BinaryOp.OR):
            waiting += reversed(sides)
    return None


def reads_field(numeric: Numeric) -> bool:
    """Whether a payload field is read."""
    return any(True for _ in fields_in(numeric))


def fields_in(numeric: Numeric) -> Iterator[FieldValue]:
    """The payload fields that a number is made of."""
    waiting = [numeric]
    while waiting:
        match waiting.pop():
            case FieldValue() as field:
                yield field
            case Arithmetic(args=args):
                waiting += args
