"""Comparisons of windows whose value moves between samples, and windows whose end is data.

In `time held`, measures such as `duration` change between samples. A comparison with one is
rearranged until the moving window stands alone, so that its crossing can be computed. A window
whose end is data starts at the trigger, where the end is captured.
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
    """A comparison by any operator, made of `>= c`, which is `make(False)`, and of `> c`."""
    if op in (rv.CompareOp.EQ, rv.CompareOp.NE):
        above = rv.Unary(rv.UnaryOp.NOT, make(True), None, span)
        made: rv.Formula = rv.Binary(rv.BinaryOp.AND, make(False), above, None, span)
    else:
        made = make(op in (rv.CompareOp.GT, rv.CompareOp.LE))
    positive = op in (rv.CompareOp.EQ, rv.CompareOp.GE, rv.CompareOp.GT)
    return made if positive else rv.Unary(rv.UnaryOp.NOT, made, None, span)


def above(of: rv.WindowValue, limit: rv.Numeric, strict: bool, span: Span) -> rv.Amount:
    """The comparison of a window with a limit; a duration is measured as the integral of 1."""
    if of.measured is rv.Measured.DURATION:
        of = structs.replace(of, measured=rv.Measured.INTEGRAL, value=rv.Literal(1))
    known = None if isinstance(limit, rv.Literal) else rv.itself(limit, span)
    return rv.Amount(of, limit, strict, span, known)


def refuse_moving(time: TimeModel, captured: rv.Numeric, span: Span) -> None:
    """Refuse to capture a number that moves between samples."""
    if time is TimeModel.HELD and _moves(captured):
        raise Refusal(rules.captured_moving(span))


_INVERSE = {
    NumericOp.ADD: NumericOp.SUB,
    NumericOp.SUB: NumericOp.ADD,
    NumericOp.MUL: NumericOp.DIV,
    NumericOp.DIV: NumericOp.MUL,
}


def isolated(compared: rv.Compare, span: Span) -> rv.Formula:
    """A comparison rearranged so that its moving window stands alone on the left.

    Operations around the window are inverted on the other side, the outermost first; each inverse
    is rounded like any operation. `abs` gives two comparisons.

    Raises:
        Refusal: the comparison cannot be rearranged.
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
            # `c / x` is left out because it is not monotonic: it jumps where x passes 0.
            if how is not NumericOp.DIV and _moves(second) and _may_combine(how, first):
                turned = op if _is_upward(how, first) else op.mirrored
                if how is NumericOp.SUB:
                    return _alone(op.mirrored, second, _joined(how, first, other), span)
                return _alone(turned, second, _joined(_INVERSE[how], other, first), span)
    raise Refusal(rules.moves_beside(span))


def _negative(number: rv.Numeric) -> rv.Numeric:
    # A literal 0 is not negated here: `-0.0` equals 0 but would be printed differently.
    if isinstance(number, rv.Literal) and not isinstance(number.value, str) and number.value != 0:
        return replace(number, value=-number.value)
    return rv.Arithmetic(NumericOp.NEG, (number,))


def _joined(how: NumericOp, left: rv.Numeric, right: rv.Numeric) -> rv.Numeric:
    """An operation as people write it: `x + 3` for `x - -3`."""
    below = isinstance(right, rv.Literal) and not isinstance(right.value, str) and right.value < 0
    if below and how in (NumericOp.ADD, NumericOp.SUB):
        how, right = _INVERSE[how], _negative(right)
    return rv.Arithmetic(how, (left, right))


def _may_combine(how: NumericOp, other: rv.Numeric) -> bool:
    """Whether an operation with `other` can be inverted: a fixed term, or a constant factor."""
    if how in (NumericOp.ADD, NumericOp.SUB):
        return not _moves(other)
    # The sign of a factor decides whether the comparison is mirrored, so it must be known here.
    return isinstance(other, rv.Literal) and other.value != 0


def _is_upward(how: NumericOp, other: rv.Numeric) -> bool:
    """Whether the result of the operation grows when its moving side grows."""
    if how in (NumericOp.ADD, NumericOp.SUB) or not isinstance(other, rv.Literal):
        return True
    return not isinstance(other.value, str) and other.value > 0


def _magnitude(op: rv.CompareOp, inner: rv.Numeric, other: rv.Numeric, span: Span) -> rv.Formula:
    """A comparison of `abs(x)`: `abs(x) <= c` is `x <= c and x >= -c`, the others follow."""

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
"""The operators whose window may have an end that is data."""


class Bounded(Struct, frozen=True):
    """A window that starts at the trigger and whose length is data."""

    seconds: rv.Numeric
    scope: Scope

    def late(self, word: str, span: Span) -> rv.Passed:
        """The condition that the window is over; its length is captured under a name of `word`."""
        trigger = self.scope.trigger
        assert trigger is not None, "what is required at the trigger has one"
        trigger.started(span)
        return rv.passed(rv.TRIGGERED, rv.Captured(trigger.number(word, self.seconds)), True, span)


def bound_of(
    operands: Operands, op: rv.UnaryOp | rv.BinaryOp, window: Window | None, scope: Scope
) -> Bounded | None:
    """The window of an operator if its end is data that can be captured, else `None`.

    Raises:
        Reported: a bound has an error.
    """
    # Values are captured at the trigger only. Below another temporal operator the data would have
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
    """`within (x) φ`, `for (x) φ`, `φ until[0, x] ψ` or `φ unless[0, x] ψ`, where x is data.

    A formula that must come has to come before the window is over; one that must hold has to hold
    until then.
    """
    make = Formulas(span)
    # Automata have constant bounds. So the window becomes unbounded, and its end becomes a
    # proposition that is true once the captured duration has passed.
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
