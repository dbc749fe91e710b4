"""The common fragment: the few operators in which every formula of ours is given to a peer.

For who knows no bounds they can be taken away.
"""

from collections.abc import Callable

from msgspec.structs import replace

from rvmon.language.checked.formula import (
    Amount,
    Binary,
    BinaryOp,
    BoundAtom,
    Compare,
    Constant,
    EventAtom,
    Formula,
    Interval,
    Passed,
    ProbeAtom,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.language.checked.rewrite import Formulas, read
from tests.tools.build import with_operands

EVER = Interval(0, None)
_KEPT = (UnaryOp.EVENTUALLY, UnaryOp.ALWAYS, UnaryOp.ONCE, UnaryOp.HISTORICALLY)
"""Peers have operators for them."""


class UntranslatableError(ValueError):
    """The peer has no formula of this meaning; the text says what it lacks."""


def both(left: Formula, right: Formula) -> Formula:
    """`left and right`."""
    return Binary(BinaryOp.AND, left, right)


def either(left: Formula, right: Formula) -> Formula:
    """`left or right`."""
    return Binary(BinaryOp.OR, left, right)


def to_core(formula: Formula) -> Formula:
    """An equal formula in `not and or X F G U Y O H S` over propositions (SEMANTICS 2).

    >>> from rvmon.language.checked.formula import SignalAtom
    >>> p = SignalAtom("p")
    >>> before = Unary(UnaryOp.PREVIOUS, p)
    >>> to_core(Unary(UnaryOp.RISE, p)) == both(p, Unary(UnaryOp.NOT, before))
    True
    """
    match formula:
        case Constant() | SignalAtom() | EventAtom() | Compare() | ProbeAtom() | BoundAtom():
            return formula
        case Unary(op=op) if op in _KEPT:
            return replace(formula, operand=to_core(formula.operand))
        case Unary() | Binary():
            return read(formula, to_core, Formulas())
        case Amount() | Passed():
            raise ValueError("it counts")


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
        case Unary(op=UnaryOp.EVENTUALLY | UnaryOp.ALWAYS, operand=operand, interval=interval):
            join = either if formula.op is UnaryOp.EVENTUALLY else both
            return _windowed(formula.op, join, _unrolled(operand), interval or EVER)
        case Binary(op=BinaryOp.UNTIL, left=left, right=right, interval=interval):
            return _until(_unrolled(left), _unrolled(right), interval or EVER)
        case _:
            return with_operands(formula, _unrolled)


def _windowed(
    op: UnaryOp, join: Callable[[Formula, Formula], Formula], operand: Formula, window: Interval
) -> Formula:
    later = _earlier(window)
    if window.low:
        return Unary(UnaryOp.NEXT, _windowed(op, join, operand, later))
    if window.high is None:
        return Unary(op, operand)
    if window.high == 0:
        return operand
    return join(operand, Unary(UnaryOp.NEXT, _windowed(op, join, operand, later)))


def _until(left: Formula, right: Formula, window: Interval) -> Formula:
    later = _earlier(window)
    if window.low:
        return both(left, Unary(UnaryOp.NEXT, _until(left, right, later)))
    if window.high is None:
        return Binary(BinaryOp.UNTIL, left, right)
    if window.high == 0:
        return right
    return either(right, both(left, Unary(UnaryOp.NEXT, _until(left, right, later))))


def _earlier(window: Interval) -> Interval:
    """The window as it is at the next tick."""
    return Interval(max(window.low - 1, 0), None if window.high is None else window.high - 1)
