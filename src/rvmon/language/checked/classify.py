"""Classifies formulas by syntax: present or future, pulse or level, constant at an instant."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import assert_never

from rvmon.language.checked.formula import (
    Amount,
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
    Passed,
    Probe,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
    WindowValue,
    fields_in,
    windows_in,
)
from rvmon.language.checked.operators import OPERATORS, Connectives, Reading, Tense
from rvmon.language.checked.rewrite import read

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
        # By identity: hashing a formula visits all of it, and shared parts are the same object.
        if id(node) in seen:
            continue
        seen.add(id(node))
        yield node
        match node:
            case Unary(operand=operand):
                waiting.append(operand)
            case Amount():
                waiting += reversed(node.operands)
            case Compare(left=left, right=right):
                windows = windows_in(left, right)
                waiting += (
                    part for window in reversed(windows) for part in reversed(window.operands)
                )
            case Passed(known=known):
                waiting.append(known)
            case Binary(left=left, right=right):
                waiting += (right, left)


def windows_of(*formulas: Formula) -> Iterator[WindowValue]:
    """The windows in formulas, those in windows among them."""
    for part in (part for formula in formulas for part in subformulas(formula)):
        if isinstance(part, Amount):
            yield part.of
        elif isinstance(part, Compare):
            yield from windows_in(part.left, part.right)


def future_part(formula: Formula) -> Formula | None:
    """The first subformula that looks ahead."""
    for part in subformulas(formula):
        if isinstance(part, Unary | Binary) and part.op in FUTURE:
            return part
    return None


def has_future(formula: Formula) -> bool:
    """Whether a formula looks ahead."""
    return future_part(formula) is not None


def looks_back_at_future(formula: Formula) -> bool:
    """Whether something that looks ahead stands below an operator of the past."""
    return any(
        isinstance(part, Unary | Binary) and part.op.entry.tense is Tense.PAST and has_future(part)
        for part in subformulas(formula)
    )


def end_part(formula: Formula) -> Formula | None:
    """The first `end` in a formula."""
    return next((part for part in subformulas(formula) if is_end(part)), None)


def is_end(formula: Formula) -> bool:
    """Whether a formula is `end`, wherever it stands."""
    return isinstance(formula, BoundAtom) and formula.bound is Bound.END


def is_timeless(formula: Formula) -> bool:
    """Whether no operator of time occurs, neither of the future nor of the past."""
    return all(
        part.op.entry.tense is Tense.PRESENT or part.op.entry.pulse
        for part in subformulas(formula)
        if isinstance(part, Unary | Binary)
    )


def is_pulse(formula: Formula) -> bool:
    """Whether the negation normal form of a trigger is a pulse.

    >>> from rvmon.language.checked.formula import BinaryOp, UnaryOp
    >>> is_pulse(Binary(BinaryOp.AND, EventAtom("sensed"), SignalAtom("ready")))
    True
    >>> is_pulse(Unary(UnaryOp.NOT, EventAtom("sensed")))
    False
    """
    return _pulses(formula)[0]


Pulses = tuple[bool, bool]
"""Whether a formula is a pulse, and whether its negation is."""


class _Pulsing(Connectives[Pulses]):
    """Pulses: a conjunction is one if either operand is, a disjunction if both are."""

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
            return any(fields_in(left, right)), False
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


Facts = Mapping[Hashable, bool]
"""The known truth values of propositions at an instant."""

FIRST: Facts = {Bound.START: True}
"""The facts of the first instant of a run."""


def facts_of(formula: Formula) -> dict[Hashable, bool]:
    """The facts that hold wherever a formula of the present and past is true.

    >>> from rvmon.language.checked.formula import BinaryOp
    >>> facts_of(Binary(BinaryOp.AND, EventAtom("e"), Unary(UnaryOp.NOT, SignalAtom("p"))))
    {'e': True, 'p': False}
    """
    return dict(_both_facts(formula)[0])


Both = tuple[dict[Hashable, bool], dict[Hashable, bool]]
"""The facts where a formula is true, and those where it is false."""


class _Facts(Reading[Both]):
    """The facts of operators; of what looks elsewhere there are none."""

    def constant(self, _: bool) -> Both:
        return {}, {}

    def no(self, operand: Both) -> Both:
        return operand[1], operand[0]

    def both(self, left: Both, right: Both) -> Both:
        shared = {key: truth for key, truth in left[1].items() if right[1].get(key) is truth}
        return {**left[0], **right[0]}, shared

    def next(self, _: Both) -> Both:
        return {}, {}

    def previous(self, _: Both) -> Both:
        return {}, {}

    def until(self, *_: object) -> Both:
        return {}, {}

    def since(self, *_: object) -> Both:
        return {}, {}


def _both_facts(formula: Formula) -> Both:
    match formula:
        case Constant():
            return {}, {}
        case Unary(op=UnaryOp.HELD, operand=operand):  # it says more than its parts: also here
            return _both_facts(operand)[0], {}
        case Unary() | Binary():
            return read(formula, _both_facts, _Facts())
        case Amount() | Passed():
            return {}, {}
        case Compare():
            key, same = _compared(formula)
            return {key: same, **dict.fromkeys(_events(formula), True)}, {key: not same}
        case _:
            key = _key(formula)
            return {key: True}, {key: False}


def truth_at(formula: Formula, facts: Facts) -> bool | None:
    """The truth of a formula at an instant with such facts; `None` if they do not decide it."""
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
        case Unary() | Binary():
            return read(formula, lambda part: truth_at(part, facts), _Here(facts))
        case Amount() | Passed():
            return None


class _Here(Reading[bool | None]):
    """Operators by what their operands are now; what else they look at is not known."""

    def __init__(self, facts: Facts) -> None:
        self._first = facts.get(Bound.START) is True

    def constant(self, value: bool) -> bool | None:
        return value

    def no(self, operand: bool | None) -> bool | None:
        return None if operand is None else not operand

    def both(self, left: bool | None, right: bool | None) -> bool | None:
        if left is False or right is False:
            return False
        return True if left and right else None

    def next(self, _: bool | None) -> bool | None:
        return None

    def previous(self, _: bool | None) -> bool | None:
        return False if self._first else None

    def until(self, left: bool | None, right: bool | None, window: Interval) -> bool | None:
        """The right side may come later."""
        if not window.low and right is not False:
            return right
        return False if left is False else None

    def since(self, left: bool | None, right: bool | None, window: Interval) -> bool | None:
        """There is nothing before the first instant."""
        if self._first:
            return False if window.low else right
        return self.until(left, right, window)


def _compared(formula: Compare) -> tuple[Hashable, bool]:
    """A comparison or its opposite, and whether it is the comparison itself.

    One that reads a field of an event has no opposite: both are false where that does not occur.
    """
    positive = formula.op in (CompareOp.LT, CompareOp.LE, CompareOp.EQ) or bool(_events(formula))
    op = formula.op if positive else formula.op.denied
    return (op, formula.left, formula.right), positive


def _events(formula: Compare) -> list[str]:
    return [field.event for field in fields_in(formula.left, formula.right)]


def _key(atom: SignalAtom | EventAtom | ProbeAtom | BoundAtom) -> Hashable:
    match atom:
        case SignalAtom(name=name) | EventAtom(name=name):
            return name
        case ProbeAtom(probe=probe, name=name):
            return probe, name
        case BoundAtom(bound=bound):
            return bound
