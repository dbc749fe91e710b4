"""Windows that move: between samples, in `time held`, and by an end that comes from data.

What is compared is brought to a moving window alone. An end that comes from data is counted from
the trigger, at which it is captured.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from msgspec import Struct, structs

from rvmon.diagnostics import Span
from rvmon.language.check.quantities import is_time, seconds_of
from rvmon.language.check.scope import Operands, Quantity, Scope
from rvmon.language.checked import formula as rv
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.rewrite import Formulas
from rvmon.language.checked.specification import TimeModel
from rvmon.language.rules import Refusal
from rvmon.language.rules import types as rules
from rvmon.language.syntax.expressions import Window


def by_limits(op: rv.CompareOp, make: Callable[[bool], rv.Formula], span: Span) -> rv.Formula:
    """A comparison made of `>= c` and, strict, `> c`."""
    if op in (rv.CompareOp.EQ, rv.CompareOp.NE):
        above = rv.Unary(rv.UnaryOp.NOT, make(True), None, span)
        made: rv.Formula = rv.Binary(rv.BinaryOp.AND, make(False), above, None, span)
    else:
        made = make(op in (rv.CompareOp.GT, rv.CompareOp.LE))
    positive = op in (rv.CompareOp.EQ, rv.CompareOp.GE, rv.CompareOp.GT)
    return made if positive else rv.Unary(rv.UnaryOp.NOT, made, None, span)


def above(of: rv.WindowValue, limit: rv.Numeric, strict: bool, span: Span) -> rv.Amount:
    """A comparison of a window with a number; a duration is the integral of 1."""
    if of.measured is rv.Measured.DURATION:
        of = structs.replace(of, measured=rv.Measured.INTEGRAL, value=rv.Literal(1))
    known = None if isinstance(limit, rv.Literal) else rv.itself(limit, span)
    return rv.Amount(of, limit, strict, span, known)


def refuse_moving(time: TimeModel, captured: rv.Numeric, span: Span) -> None:
    """Refuse to capture what moves between samples."""
    if time is TimeModel.HELD and _moves(captured):
        raise Refusal(rules.captured_moving(span))


_INVERSE = {
    NumericOp.ADD: NumericOp.SUB,
    NumericOp.SUB: NumericOp.ADD,
    NumericOp.MUL: NumericOp.DIV,
    NumericOp.DIV: NumericOp.MUL,
}


def brought_alone(compared: rv.Compare, span: Span) -> rv.Formula:
    """A comparison whose moving window stands alone on the left.

    What stands with it goes to the other side, from the outside in, each step rounded there as any
    operation is; a magnitude is compared twice.

    Raises:
        Refusal: it cannot be brought there.
    """
    left, right = compared.left, compared.right
    if not _moves(left):
        return _alone(compared.op.mirrored, right, left, span)
    if _moves(right):
        raise Refusal(rules.moves_beside(span))
    return _alone(compared.op, left, right, span)


def _moves(number: rv.Numeric) -> bool:
    return any(window.moves for window in rv.windows_in(number))


def _alone(op: rv.CompareOp, moving: rv.Numeric, other: rv.Numeric, span: Span) -> rv.Formula:
    match moving:
        case rv.WindowValue():
            return by_limits(op, lambda strict: above(moving, other, strict, span), span)
        case rv.Arithmetic(op=NumericOp.NEG, args=(inner,)):
            return _alone(op.mirrored, inner, _negative(other), span)
        case rv.Arithmetic(op=NumericOp.ABS, args=(inner,)):
            return _magnitude(op, inner, other, span)
        case rv.Arithmetic(op=how, args=(first, second)) if how in _INVERSE:
            if _moves(first) and _may_combine(how, second):
                turned = op if _is_upward(how, second) else op.mirrored
                return _alone(turned, first, _joined(_INVERSE[how], other, second), span)
            # `c / x` is not monotonic: it jumps where x passes 0.
            if how is not NumericOp.DIV and _moves(second) and _may_combine(how, first):
                turned = op if _is_upward(how, first) else op.mirrored
                if how is NumericOp.SUB:
                    return _alone(op.mirrored, second, _joined(how, first, other), span)
                return _alone(turned, second, _joined(_INVERSE[how], other, first), span)
    raise Refusal(rules.moves_beside(span))


def _negative(number: rv.Numeric) -> rv.Numeric:
    # `-0.0` equals 0 but would be printed differently.
    if isinstance(number, rv.Literal) and not isinstance(number.value, str) and number.value != 0:
        return replace(number, value=-number.value)
    return rv.Arithmetic(NumericOp.NEG, (number,))


def _joined(how: NumericOp, left: rv.Numeric, right: rv.Numeric) -> rv.Numeric:
    """The same number as people write it: `+ 3` for `- -3`."""
    below = isinstance(right, rv.Literal) and not isinstance(right.value, str) and right.value < 0
    if below and how in (NumericOp.ADD, NumericOp.SUB):
        how, right = _INVERSE[how], _negative(right)
    return rv.Arithmetic(how, (left, right))


def _may_combine(how: NumericOp, other: rv.Numeric) -> bool:
    """Whether a moving operand may be combined with another: a fixed term, or a constant factor."""
    if how in (NumericOp.ADD, NumericOp.SUB):
        return not _moves(other)
    # The sign of a factor decides whether the comparison is reversed, so it must be known here.
    return isinstance(other, rv.Literal) and other.value != 0


def _is_upward(how: NumericOp, other: rv.Numeric) -> bool:
    """Whether the whole grows as the moving side of it does."""
    if how in (NumericOp.ADD, NumericOp.SUB) or not isinstance(other, rv.Literal):
        return True
    return not isinstance(other.value, str) and other.value > 0


def _magnitude(op: rv.CompareOp, inner: rv.Numeric, other: rv.Numeric, span: Span) -> rv.Formula:
    """`abs(x) <= c` is `x <= c and x >= -c`; the others are made of it and `abs(x) < c`."""

    def within(how: rv.CompareOp) -> rv.Formula:
        less = _alone(how, inner, other, span)
        more = _alone(how.mirrored, inner, _negative(other), span)
        return rv.Binary(rv.BinaryOp.AND, less, more, None, span)

    if op in (rv.CompareOp.LT, rv.CompareOp.LE):
        return within(op)

    def least(strict: bool) -> rv.Formula:
        return rv.Unary(
            rv.UnaryOp.NOT, within(rv.CompareOp.LE if strict else rv.CompareOp.LT), None, span
        )

    return by_limits(op, least, span)


_BOUNDED = (rv.UnaryOp.EVENTUALLY, rv.UnaryOp.ALWAYS, rv.BinaryOp.UNTIL, rv.BinaryOp.WEAK_UNTIL)
"""The operators whose window may end where data says."""


class Bounded(Struct, frozen=True):
    """A window from now on whose end comes from data; what it bounds is required at the trigger."""

    seconds: rv.Numeric
    scope: Scope

    def late(self, word: str, span: Span) -> rv.Passed:
        """The condition that the window is over."""
        trigger = self.scope.trigger
        assert trigger is not None, "what is required at the trigger has one"
        trigger.begun(span)
        return rv.passed(rv.TRIGGERED, rv.Captured(trigger.number(word, self.seconds)), True, span)


def bound_of(
    operands: Operands, op: rv.UnaryOp | rv.BinaryOp, window: Window | None, scope: Scope
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
    op: rv.UnaryOp | rv.BinaryOp, operands: Sequence[rv.Formula], bound: Bounded, span: Span
) -> rv.Formula:
    """`within (x) φ`, `for (x) φ`, `φ until[0, x] ψ`, `φ unless[0, x] ψ`.

    What must come has to come before it is too late; what must hold has to hold until it is.
    """
    make = Formulas(span)
    # Automata have constant bounds, so the window becomes unbounded, and its end a proposition that
    # is true once the captured duration has passed.
    if op in (rv.UnaryOp.ALWAYS, rv.BinaryOp.WEAK_UNTIL):
        lasting, *end = operands
        ended: rv.Formula = bound.late("for", span)
        ended = make.either(end[0], ended) if end else ended
        return rv.Binary(
            rv.BinaryOp.RELEASE, ended, make.either(lasting, ended), rv.Interval(), span
        )
    *before, reached = operands
    early: rv.Formula = rv.Unary(rv.UnaryOp.NOT, bound.late("within", span), None, span)
    until_then = make.both(before[0], early) if before else early
    return make.until(until_then, make.both(reached, early), rv.Interval())
