"""Classifies formulas by syntax: tense, pulse or level, and facts known at an instant."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import assert_never

from rvmon.language.checked import formula as rv
from rvmon.language.checked.operators import OPERATORS, Connectives, Reading, Tense
from rvmon.language.checked.rewrite import read

FUTURE = frozenset(op for op in OPERATORS if op.entry.tense is Tense.FUTURE)
"""The operators of the future."""


def subformulas(formula: rv.Formula) -> Iterator[rv.Formula]:
    """The formula and its subformulas, operators before operands, from left to right.

    A part that a macro shares between several places is yielded once.
    """
    waiting = [formula]
    seen: set[int] = set()
    while waiting:
        node = waiting.pop()
        # Parts are told apart by identity: hashing a formula would visit all of it, and shared
        # parts are the same object.
        if id(node) in seen:
            continue
        seen.add(id(node))
        yield node
        match node:
            case rv.Unary(operand=operand):
                waiting.append(operand)
            case rv.Amount():
                waiting += reversed(node.operands)
            case rv.Compare(left=left, right=right):
                windows = rv.windows_in(left, right)
                waiting += (
                    part for window in reversed(windows) for part in reversed(window.operands)
                )
            case rv.Passed(known=known):
                waiting.append(known)
            case rv.Binary(left=left, right=right):
                waiting += (right, left)


def windows_of(*formulas: rv.Formula) -> Iterator[rv.WindowValue]:
    """All measured windows in formulas, including those inside other windows."""
    for part in (part for formula in formulas for part in subformulas(formula)):
        if isinstance(part, rv.Amount):
            yield part.of
        elif isinstance(part, rv.Compare):
            yield from rv.windows_in(part.left, part.right)


def future_part(formula: rv.Formula) -> rv.Formula | None:
    """The first subformula with an operator of the future, or `None`."""
    temporal = (part for part in subformulas(formula) if isinstance(part, rv.Unary | rv.Binary))
    return next((part for part in temporal if part.op in FUTURE), None)


def has_future(formula: rv.Formula) -> bool:
    """Whether a formula has an operator of the future."""
    return future_part(formula) is not None


def looks_back_at_future(formula: rv.Formula) -> bool:
    """Whether an operator of the future stands below an operator of the past."""
    return any(
        isinstance(part, rv.Unary | rv.Binary)
        and part.op.entry.tense is Tense.PAST
        and has_future(part)
        for part in subformulas(formula)
    )


def end_part(formula: rv.Formula) -> rv.Formula | None:
    """The first `end` in a formula, or `None`."""
    return next((part for part in subformulas(formula) if is_end(part)), None)


def is_end(formula: rv.Formula) -> bool:
    """Whether a formula is just `end`."""
    return isinstance(formula, rv.BoundAtom) and formula.bound is rv.Bound.END


def is_timeless(formula: rv.Formula) -> bool:
    """Whether a formula has no temporal operator except `rise` and `fall`."""
    return all(
        part.op.entry.tense is Tense.PRESENT or part.op.entry.pulse
        for part in subformulas(formula)
        if isinstance(part, rv.Unary | rv.Binary)
    )


def is_pulse(formula: rv.Formula) -> bool:
    """Whether the negation normal form of a trigger is a pulse.

    >>> sensed, ready = rv.EventAtom("sensed"), rv.SignalAtom("ready")
    >>> is_pulse(rv.Binary(rv.BinaryOp.AND, sensed, ready))
    True
    >>> is_pulse(rv.Unary(rv.UnaryOp.NOT, sensed))
    False
    """
    return _pulses(formula)[0]


Pulses = tuple[bool, bool]  # whether a formula is a pulse, and whether its negation is


class _Pulsing(Connectives[Pulses]):
    """Reads pulses: a conjunction is a pulse if either operand is, a disjunction if both are."""

    def constant(self, value: bool) -> Pulses:
        return not value, value

    def no(self, operand: Pulses) -> Pulses:
        return operand[1], operand[0]

    def both(self, left: Pulses, right: Pulses) -> Pulses:
        return left[0] or right[0], left[1] and right[1]


_PULSING = _Pulsing()


def _pulses(formula: rv.Formula) -> Pulses:
    match formula:
        case rv.Constant(value=value):
            return _PULSING.constant(value)
        case rv.EventAtom():
            return True, False
        case rv.Compare(left=left, right=right):
            return any(rv.fields_in(left, right)), False
        case rv.ProbeAtom(probe=probe):
            return probe is not rv.Probe.KNOWN, False
        case rv.SignalAtom() | rv.BoundAtom() | rv.Amount() | rv.Passed():
            return False, False
        case rv.Unary(op=op) | rv.Binary(op=op) if op.entry.tense is not Tense.PRESENT:
            return op.entry.pulse, False
        case rv.Unary() | rv.Binary():
            return read(formula, _pulses, _PULSING)
        case _:
            assert_never(formula)


def mixed_disjunction(trigger: rv.Formula) -> tuple[rv.Formula, rv.Formula] | None:
    """The pulse and the level of a disjunction that mixes both, or `None`; pulse first."""
    waiting = [trigger]
    while waiting:
        node = waiting.pop()
        if not isinstance(node, rv.Binary) or is_pulse(node):
            continue
        sides = (node.left, node.right)
        if node.op is rv.BinaryOp.OR and is_pulse(node.left) != is_pulse(node.right):
            return sides if is_pulse(node.left) else (node.right, node.left)
        if node.op in (rv.BinaryOp.AND, rv.BinaryOp.OR):
            waiting += reversed(sides)
    return None


Facts = Mapping[Hashable, bool]  # known truth values of propositions at an instant
FIRST: Facts = {rv.Bound.START: True}  # the facts of the first instant of a run


def facts_of(formula: rv.Formula) -> dict[Hashable, bool]:
    """The facts that hold wherever a formula without future operators is true.

    >>> no_p = rv.Unary(rv.UnaryOp.NOT, rv.SignalAtom("p"))
    >>> facts_of(rv.Binary(rv.BinaryOp.AND, rv.EventAtom("e"), no_p))
    {'e': True, 'p': False}
    """
    return dict(_both_facts(formula)[0])


Both = tuple[dict[Hashable, bool], dict[Hashable, bool]]
"""The facts where a formula is true, and the facts where it is false."""


class _Facts(Reading[Both]):
    """Reads facts; operators of time give none, because they refer to other instants."""

    def constant(self, _: bool) -> Both:
        return {}, {}

    def no(self, operand: Both) -> Both:
        return operand[1], operand[0]

    def both(self, left: Both, right: Both) -> Both:
        shared = {key: truth for key, truth in left[1].items() if right[1].get(key) is truth}
        return {**left[0], **right[0]}, shared

    def until(self, *_: object) -> Both:
        return {}, {}

    next = previous = since = until


def _both_facts(formula: rv.Formula) -> Both:
    match formula:
        case rv.Constant():
            return {}, {}
        # `held` includes the present instant, which its expansion by `since` does not show.
        case rv.Unary(op=rv.UnaryOp.HELD, operand=operand):
            return _both_facts(operand)[0], {}
        case rv.Unary() | rv.Binary():
            return read(formula, _both_facts, _Facts())
        case rv.Amount() | rv.Passed():
            return {}, {}
        case rv.Compare():
            key, same = _compared(formula)
            return {key: same, **dict.fromkeys(_events(formula), True)}, {key: not same}
        case _:
            key = _key(formula)
            return {key: True}, {key: False}


def truth_at(formula: rv.Formula, facts: Facts) -> bool | None:
    """The truth of a formula at an instant with the given facts; `None` if they do not decide."""
    match formula:
        case rv.Constant(value=value):
            return value
        case rv.Compare():
            key, same = _compared(formula)
            if any(facts.get(event) is False for event in _events(formula)):
                return False
            known = facts.get(key)
            return None if known is None else known is same
        case rv.SignalAtom() | rv.EventAtom() | rv.ProbeAtom() | rv.BoundAtom():
            return facts.get(_key(formula))
        case rv.Unary() | rv.Binary():
            return read(formula, lambda part: truth_at(part, facts), _Here(facts))
        case rv.Amount() | rv.Passed():
            return None


class _Here(Reading[bool | None]):
    """Reads truth from the present values of operands; values at other instants are not known."""

    def __init__(self, facts: Facts) -> None:
        self._first = facts.get(rv.Bound.START) is True

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

    def until(self, left: bool | None, right: bool | None, window: rv.Interval) -> bool | None:
        """Decided by the operands now, as the right one may come later."""
        if not window.low and right is not False:
            return right
        return False if left is False else None

    def since(self, left: bool | None, right: bool | None, window: rv.Interval) -> bool | None:
        """As `until`, but there is no position before the first one."""
        if self._first:
            return False if window.low else right
        return self.until(left, right, window)


def _compared(formula: rv.Compare) -> tuple[Hashable, bool]:
    """The key of a comparison or of its opposite, and whether it is that of the comparison.

    A comparison that reads a field of an event has no opposite: both would be false where the
    event does not occur.
    """
    # Of the opposite pairs (`<` and `>=`, `<=` and `>`, `==` and `!=`) the first is the key.
    positive = formula.op in (rv.CompareOp.LT, rv.CompareOp.LE, rv.CompareOp.EQ) or bool(
        _events(formula)
    )
    op = formula.op if positive else formula.op.denied
    return (op, formula.left, formula.right), positive


def _events(formula: rv.Compare) -> list[str]:
    return [field.event for field in rv.fields_in(formula.left, formula.right)]


def _key(atom: rv.SignalAtom | rv.EventAtom | rv.ProbeAtom | rv.BoundAtom) -> Hashable:
    match atom:
        case rv.SignalAtom(name=name) | rv.EventAtom(name=name):
            return name
        case rv.ProbeAtom(probe=probe, name=name):
            return probe, name
        case rv.BoundAtom(bound=bound):
            return bound
