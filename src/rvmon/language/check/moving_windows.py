"""Windows that move between samples, in `time held`: what is compared is brought to one alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from msgspec import structs

from rvmon.diagnostics import Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import (
    Amount,
    Arithmetic,
    Binary,
    BinaryOp,
    Compare,
    CompareOp,
    Formula,
    Literal,
    Measured,
    Numeric,
    Unary,
    UnaryOp,
    WindowValue,
    itself,
    windows_in,
)
from rvmon.language.checked.specification import TimeModel
from rvmon.language.rules import Refusal
from rvmon.language.rules import types as rules


def by_limits(op: CompareOp, make: Callable[[bool], Formula], span: Span) -> Formula:
    """A comparison made of `>= c` and, strict, `> c`."""
    match op:
        case CompareOp.GE:
            return make(False)
        case CompareOp.GT:
            return make(True)
        case CompareOp.LT:
            return Unary(UnaryOp.NOT, make(False), None, span)
        case CompareOp.LE:
            return Unary(UnaryOp.NOT, make(True), None, span)
    above = Unary(UnaryOp.NOT, make(True), None, span)
    same = Binary(BinaryOp.AND, make(False), above, None, span)
    return same if op is CompareOp.EQ else Unary(UnaryOp.NOT, same, None, span)


def above(of: WindowValue, limit: Numeric, strict: bool, span: Span) -> Amount:
    """A comparison of a window with a number; a duration is the integral of 1."""
    if of.measured is Measured.DURATION:
        of = structs.replace(of, measured=Measured.INTEGRAL, value=Literal(1))
    known = None if isinstance(limit, Literal) else itself(limit, span)
    return Amount(of, limit, strict, span, known)


def refuse_moving(time: TimeModel, captured: Numeric, span: Span) -> None:
    """Refuse to capture what moves between samples."""
    if time is TimeModel.HELD and _moves(captured):
        raise Refusal(rules.captured_moving(span))


_INVERSE = {
    NumericOp.ADD: NumericOp.SUB,
    NumericOp.SUB: NumericOp.ADD,
    NumericOp.MUL: NumericOp.DIV,
    NumericOp.DIV: NumericOp.MUL,
}


def brought_alone(compared: Compare, span: Span) -> Formula:
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


def _moves(number: Numeric) -> bool:
    return any(window.moves for window in windows_in(number))


def _alone(op: CompareOp, moving: Numeric, other: Numeric, span: Span) -> Formula:
    match moving:
        case WindowValue():
            return by_limits(op, lambda strict: above(moving, other, strict, span), span)
        case Arithmetic(op=NumericOp.NEG, args=(inner,)):
            return _alone(op.mirrored, inner, _negative(other), span)
        case Arithmetic(op=NumericOp.ABS, args=(inner,)):
            return _magnitude(op, inner, other, span)
        case Arithmetic(op=how, args=(first, second)) if how in _INVERSE:
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


def _negative(number: Numeric) -> Numeric:
    # `-0.0` equals 0 but would be printed differently.
    if isinstance(number, Literal) and not isinstance(number.value, str) and number.value != 0:
        return replace(number, value=-number.value)
    return Arithmetic(NumericOp.NEG, (number,))


def _joined(how: NumericOp, left: Numeric, right: Numeric) -> Numeric:
    """The same number as people write it: `+ 3` for `- -3`."""
    below = isinstance(right, Literal) and not isinstance(right.value, str) and right.value < 0
    if below and how in (NumericOp.ADD, NumericOp.SUB):
        how, right = _INVERSE[how], _negative(right)
    return Arithmetic(how, (left, right))


def _may_combine(how: NumericOp, other: Numeric) -> bool:
    """Whether a moving operand may be combined with another: a fixed term, or a constant factor."""
    if how in (NumericOp.ADD, NumericOp.SUB):
        return not _moves(other)
    # The sign of a factor decides whether the comparison is reversed, so it must be known here.
    return isinstance(other, Literal) and other.value != 0


def _is_upward(how: NumericOp, other: Numeric) -> bool:
    """Whether the whole grows as the moving side of it does."""
    if how in (NumericOp.ADD, NumericOp.SUB) or not isinstance(other, Literal):
        return True
    return not isinstance(other.value, str) and other.value > 0


def _magnitude(op: CompareOp, inner: Numeric, other: Numeric, span: Span) -> Formula:
    """`abs(x) <= c` is `x <= c and x >= -c`; the others are made of it and `abs(x) < c`."""

    def within(how: CompareOp) -> Formula:
        less = _alone(how, inner, other, span)
        more = _alone(how.mirrored, inner, _negative(other), span)
        return Binary(BinaryOp.AND, less, more, None, span)

    if op in (CompareOp.LT, CompareOp.LE):
        return within(op)

    def least(strict: bool) -> Formula:
        return Unary(UnaryOp.NOT, within(CompareOp.LE if strict else CompareOp.LT), None, span)

    return by_limits(op, least, span)
