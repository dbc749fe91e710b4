"""Reads derived operators through the primitive ones that define them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.checked.formula import Binary, Constant, Formula, Numeric, Unary
from rvmon.language.checked.operators import BinaryOp, Connectives, Interval, UnaryOp

T = TypeVar("T")
Part = TypeVar("Part", bound=Formula | Numeric | Interval)


def read(formula: Unary | Binary, of: Callable[[Formula], T], reading: Connectives[T]) -> T:
    """The reading of a formula; `of` reads its operands, each once.

    For a formula of connectives only, `reading` need not be a `Reading` with temporal operators.
    """
    operands = (formula.operand,) if isinstance(formula, Unary) else (formula.left, formula.right)
    window = formula.interval or Interval()
    result: T = formula.op.entry.meaning(reading, *map(of, operands), window)
    return result


class Formulas(Struct, frozen=True):
    """Reads operators as formulas of `not and or X U Y S`."""

    span: Span | None = None

    def constant(self, value: bool) -> Formula:
        """A constant."""
        return Constant(value, self.span)

    def no(self, operand: Formula) -> Formula:
        """`not operand`."""
        return Unary(UnaryOp.NOT, operand, None, operand.span)

    def both(self, left: Formula, right: Formula) -> Formula:
        """`left and right`."""
        return Binary(BinaryOp.AND, left, right, None, self.span)

    def either(self, left: Formula, right: Formula) -> Formula:
        """`left or right`."""
        return Binary(BinaryOp.OR, left, right, None, self.span)

    def next(self, operand: Formula) -> Formula:
        """`next operand`."""
        return Unary(UnaryOp.NEXT, operand, None, self.span)

    def previous(self, operand: Formula) -> Formula:
        """`previous operand`."""
        return Unary(UnaryOp.PREVIOUS, operand, None, self.span)

    def until(self, left: Formula, right: Formula, window: Interval) -> Formula:
        """`left until right`."""
        return Binary(BinaryOp.UNTIL, left, right, window, self.span)

    def since(self, left: Formula, right: Formula, window: Interval) -> Formula:
        """`left since right`."""
        return Binary(BinaryOp.SINCE, left, right, window, self.span)


def rewritten(formula: Unary | Binary) -> Formula:
    """The formula with its outermost operator expressed in `not and or X U Y S`.

    >>> from rvmon.language.checked.formula import EventAtom
    >>> e = EventAtom("e")
    >>> rewritten(Unary(UnaryOp.EVENTUALLY, e, Interval())) == Binary(
    ...     BinaryOp.UNTIL, Constant(True), e, Interval()
    ... )
    True
    """
    return read(formula, lambda operand: operand, Formulas(formula.span))


def chain(formula: Formula, op: BinaryOp = BinaryOp.AND) -> list[Formula]:
    """The operands of nested associative connectives, from the left, however they are grouped."""
    operands: list[Formula] = []
    waiting = [formula]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Binary) and node.op is op:
            waiting += (node.right, node.left)
        else:
            operands.append(node)
    return operands


def without_spans(part: Part) -> Part:
    """A formula or number without places, so that equal ones compare equal.

    >>> from rvmon.diagnostics import Source, Span
    >>> without_spans(Constant(True, Span(Source("", ""), 0, 0)))
    Constant(value=True, span=None)
    """
    values: list[Any] = []
    for name in type(part).__match_args__:
        value = getattr(part, name)
        if isinstance(value, tuple):
            value = tuple(map(without_spans, value))
        elif hasattr(type(value), "__match_args__"):
            value = None if name == "span" else without_spans(value)
        values.append(value)
    return type(part)(*values)
