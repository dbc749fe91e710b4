"""Formulas with bounds as formulas without, for who knows only those."""

from __future__ import annotations

from collections.abc import Callable

from tests.tools.build import with_operands
from tests.tools.common_fragment import both, either, to_core

from rvmon.language.checked.formula import Binary, BinaryOp, Formula, Interval, Unary
from rvmon.language.checked.formula import UnaryOp as Op


def unrolled(formula: Formula) -> Formula:
    """The same formula without bounds, where every tick is a position: windows as nests of `X`.

    >>> from tests.tools.build import eventually, p
    >>> from rvmon.language.print import format_formula
    >>> format_formula(unrolled(eventually(p, 1, 2)))
    'next (p or next p)'
    """
    return _unrolled(to_core(formula))


def _unrolled(formula: Formula) -> Formula:
    match formula:
        case Unary(op=Op.EVENTUALLY | Op.ALWAYS, operand=operand, interval=interval):
            join = either if formula.op is Op.EVENTUALLY else both
            return _windowed(formula.op, join, _unrolled(operand), interval or Interval(0, None))
        case Binary(op=BinaryOp.UNTIL, left=left, right=right, interval=interval):
            return _until(_unrolled(left), _unrolled(right), interval or Interval(0, None))
        case _:
            return with_operands(formula, _unrolled)


def _windowed(
    op: Op, join: Callable[[Formula, Formula], Formula], operand: Formula, window: Interval
) -> Formula:
    later = _earlier(window)
    if window.low:
        return Unary(Op.NEXT, _windowed(op, join, operand, later))
    if window.high is None:
        return Unary(op, operand)
    if window.high == 0:
        return operand
    return join(operand, Unary(Op.NEXT, _windowed(op, join, operand, later)))


def _until(left: Formula, right: Formula, window: Interval) -> Formula:
    later = _earlier(window)
    if window.low:
        return both(left, Unary(Op.NEXT, _until(left, right, later)))
    if window.high is None:
        return Binary(BinaryOp.UNTIL, left, right)
    if window.high == 0:
        return right
    return either(right, both(left, Unary(Op.NEXT, _until(left, right, later))))


def _earlier(window: Interval) -> Interval:
    """The window as it is at the next tick."""
    return Interval(max(window.low - 1, 0), None if window.high is None else window.high - 1)
