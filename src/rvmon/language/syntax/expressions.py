"""The syntax tree of expressions: formulas, numbers and durations as written; and its walks."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from msgspec import Struct

from rvmon.diagnostics import Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import BinaryOp, Bound, CompareOp, UnaryOp


class Ident(Struct, frozen=True):
    """A name where it is written; quotes are taken off."""

    text: str
    span: Span


class Number(Struct, frozen=True):
    """A number with its unit, "" if it has none; `value` is `None` if it is out of range."""

    value: Fraction | None
    unit: str
    span: Span


class Name(Struct, frozen=True):
    """A name of a signal, event, payload field, label, constant, macro or parameter."""

    text: str
    span: Span


class Truth(Struct, frozen=True):
    """`true` or `false`."""

    value: bool
    span: Span


class Edge(Struct, frozen=True):
    """`start` or `end`."""

    bound: Bound
    span: Span


class Call(Struct, frozen=True):
    """A built-in function or a macro with its arguments."""

    function: Ident
    args: tuple[Expression, ...]
    span: Span


class Group(Struct, frozen=True):
    """An expression in round brackets."""

    inner: Expression
    span: Span


class Window(Struct, frozen=True):
    """An interval of durations; `high` is `None` if it has no end."""

    low: Expression | None
    high: Expression | None
    low_open: bool
    high_open: bool
    span: Span


class Prefix(Struct, frozen=True):
    """`not` or a temporal operator before a formula.

    `within D` is `eventually` and `for D` is `always` with a window from 0.
    """

    op: UnaryOp
    operand: Expression
    window: Window | None
    op_span: Span
    span: Span


class Immediately(Struct, frozen=True):
    """`immediately φ`: φ itself, stated on purpose."""

    operand: Expression
    span: Span


class Infix(Struct, frozen=True):
    """A connective or temporal operator between two formulas."""

    op: BinaryOp
    left: Expression
    right: Expression
    window: Window | None
    op_span: Span
    span: Span


class Comparison(Struct, frozen=True):
    """A comparison of two expressions."""

    op: CompareOp
    left: Expression
    right: Expression
    op_span: Span
    span: Span


class Choice(Struct, frozen=True):
    """`if φ then x else y`."""

    condition: Expression
    chosen: Expression
    otherwise: Expression
    span: Span


class Operation(Struct, frozen=True):
    """Arithmetic on one or two expressions."""

    op: NumericOp
    args: tuple[Expression, ...]
    span: Span


class Path(Struct, frozen=True):
    """A path quantifier with a temporal operator: `AG p`, `E<> p`.

    Attributes:
        universal: whether it is `A`.
        reaching: whether it is written as `A[]`, which reaches to the end of the formula.
    """

    universal: bool
    op: UnaryOp
    operand: Expression
    window: Window | None
    reaching: bool
    op_span: Span
    span: Span


class Quantified(Struct, frozen=True):
    """`A[φ U ψ]`, `E[φ U ψ]`; `path` is what stands in the brackets."""

    universal: bool
    path: Expression
    span: Span


class LeadsTo(Struct, frozen=True):
    """`φ --> ψ`: on all paths φ is always followed by ψ."""

    left: Expression
    right: Expression
    window: Window | None
    span: Span


Expression = (
    Number
    | Name
    | Truth
    | Edge
    | Call
    | Group
    | Prefix
    | Immediately
    | Infix
    | Comparison
    | Choice
    | Operation
    | Path
    | Quantified
    | LeadsTo
)


def expressions_in(expression: Expression) -> Iterator[Expression]:
    """The expression and all below it, those of windows too."""
    waiting = [expression]
    while waiting:
        node = waiting.pop()
        yield node
        waiting += reversed(operands(node))


def operands(expression: Expression) -> tuple[Expression, ...]:
    """The expressions that one is made of, from left to right."""
    match expression:
        case Group(inner=inner) | Immediately(operand=inner) | Quantified(path=inner):
            return (inner,)
        case Prefix(operand=operand, window=window) | Path(operand=operand, window=window):
            return (*_bounds(window), operand)
        case Infix(left=left, right=right, window=window):
            return (left, *_bounds(window), right)
        case LeadsTo(left=left, right=right, window=window):
            return (left, *_bounds(window), right)
        case Comparison(left=left, right=right):
            return (left, right)
        case Choice(condition=condition, chosen=chosen, otherwise=otherwise):
            return (condition, chosen, otherwise)
        case Call(args=args) | Operation(args=args):
            return args
        case _:
            return ()


def _bounds(window: Window | None) -> tuple[Expression, ...]:
    if window is None:
        return ()
    return tuple(bound for bound in (window.low, window.high) if bound is not None)


def ungrouped(expression: Expression) -> Expression:
    """An expression without the brackets around it."""
    while isinstance(expression, Group):
        expression = expression.inner
    return expression
