"""What a formula is by its syntax: present or future, pulse or level."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from rvmon.spec.checked.formula import (
    Amount,
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
    Passed,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
)
from rvmon.spec.checked.operators import OPERATORS, Connectives, Tense
from rvmon.spec.checked.reading import read

FUTURE = frozenset(op for op in OPERATORS if op.entry.tense is Tense.FUTURE)
"""The operators that look ahead."""


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
            case Amount():
                waiting += reversed(node.operands)
            case Passed(known=known):
                waiting.append(known)
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
        part.op.entry.tense is Tense.PRESENT or part.op.entry.pulse
        for part in subformulas(formula)
        if isinstance(part, Unary | Binary)
    )


def is_pulse(formula: Formula) -> bool:
    """Whether the negation normal form of a trigger is a pulse.

    >>> from rvmon.spec.checked.formula import BinaryOp, UnaryOp
    >>> is_pulse(Binary(BinaryOp.AND, EventAtom("sensed"), SignalAtom("ready")))
    True
    >>> is_pulse(Unary(UnaryOp.NOT, EventAtom("sensed")))
    False
    """
    return _pulses(formula)[0]


Pulses = tuple[bool, bool]
"""Whether a formula is a pulse, and whether its negation is."""


class _Pulsing(Connectives[Pulses]):
    """Of a conjunction either has to be a pulse, of a disjunction both."""

    def constant(self, value: bool) -> Pulses:
        return not value, value

    def no(self, operand: Pulses) -> Pulses:
        return operand[1], operand[0]

    def both(self, left: Pulses, right: Pulses) -> Pulses:
        return left[0] or right[0], left[1] and right[1]


_PULSING = _Pulsing()


def _pulses(formula: Formula) -> Pulses:
    match formula:
        case Constant(value=value):
            return _PULSING.constant(value)
        case EventAtom():
            return True, False
        case Compare(left=left, right=right):
            return reads_field(left) or reads_field(right), False
        case ProbeAtom(probe=probe):
            return probe is not Probe.KNOWN, False
        case SignalAtom() | BoundAtom() | Amount() | Passed():
            return False, False
        case Unary(op=op) | Binary(op=op) if op.entry.tense is not Tense.PRESENT:
            return op.entry.pulse, False
        case Unary() | Binary():
            return read(formula, _pulses, _PULSING)
        case _:
            assert_never(formula)


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
