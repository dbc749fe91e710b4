"""Bounds that come from data: counted from the trigger, at which they are captured."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.check.moving_windows import refuse_moving
from rvmon.language.check.quantities import is_time, seconds_of
from rvmon.language.check.scope import Operands, Quantity, Scope
from rvmon.language.checked.formula import (
    TRIGGERED,
    Binary,
    BinaryOp,
    Captured,
    Formula,
    Interval,
    Numeric,
    Passed,
    Unary,
    UnaryOp,
    passed,
)
from rvmon.language.checked.rewrite import Formulas
from rvmon.language.syntax.expressions import Window

_BOUNDED = (UnaryOp.EVENTUALLY, UnaryOp.ALWAYS, BinaryOp.UNTIL, BinaryOp.WEAK_UNTIL)
"""The operators whose window may end where data says."""


class Bounded(Struct, frozen=True):
    """A window from now on whose end comes from data; what it bounds is required at the trigger."""

    seconds: Numeric
    scope: Scope

    def late(self, word: str, span: Span) -> Passed:
        """The condition that the window is over."""
        trigger = self.scope.trigger
        assert trigger is not None, "what is required at the trigger has one"
        trigger.begun(span)
        return passed(TRIGGERED, Captured(trigger.number(word, self.seconds)), True, span)


def bound_of(
    operands: Operands, op: UnaryOp | BinaryOp, window: Window | None, scope: Scope
) -> Bounded | None:
    """The end of a window that comes from data, where that is captured; `None`: another.

    Raises:
        Reported: it is wrong.
    """
    # Values are captured at the trigger only; below another temporal operator the data would have
    # to be read at other instants.
    if op not in _BOUNDED or window is None or not window.high or not scope.at_once:
        return None
    if window.high_open or window.low_open:
        return None
    if window.low and operands.duration(window.low, scope):
        return None
    value = operands.values((window.high,), scope)[0]
    if not isinstance(value, Quantity) or value.node is None or not is_time(value):
        return None
    seconds = seconds_of((value, window.high.span))
    refuse_moving(operands.table.time, seconds, window.high.span)
    return Bounded(seconds, scope)


def bounded(
    op: UnaryOp | BinaryOp, operands: Sequence[Formula], bound: Bounded, span: Span
) -> Formula:
    """`within (x) φ`, `for (x) φ`, `φ until[0, x] ψ`, `φ unless[0, x] ψ`.

    What must come has to come before it is too late; what must hold has to hold until it is.
    """
    make = Formulas(span)
    # Automata have constant bounds, so the window becomes unbounded, and its end a proposition that
    # is true once the captured duration has passed.
    if op in (UnaryOp.ALWAYS, BinaryOp.WEAK_UNTIL):
        lasting, *end = operands
        ended: Formula = bound.late("for", span)
        ended = make.either(end[0], ended) if end else ended
        return Binary(BinaryOp.RELEASE, ended, make.either(lasting, ended), Interval(), span)
    *before, reached = operands
    early: Formula = Unary(UnaryOp.NOT, bound.late("within", span), None, span)
    until_then = make.both(before[0], early) if before else early
    return make.until(until_then, make.both(reached, early), Interval())
