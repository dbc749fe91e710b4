"""The syntax tree of expressions: formulas, numbers and durations as they are written."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from msgspec import Struct
from msgspec.structs import astuple

from rvmon.diagnostics import Span
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.formula import BinaryOp, Bound, CompareOp, UnaryOp


class Ident(Struct, frozen=True):
    """A name with its place, without backticks."""

    text: str
    span: Span


class _Node(Struct, frozen=True):
    """A node of an expression; its fields are in the order of the text."""


class Number(_Node, frozen=True):
    """A number with its unit ("" for none); `value` is `None` if it is out of range."""

    value: Fraction | None
    unit: str
    span: Span


class Name(_Node, frozen=True):
    """A name of a signal, event, payload field, label, constant, macro or parameter."""

    text: str
    span: Span


class Truth(_Node, frozen=True):
    """`true` or `false`."""

    value: bool
    span: Span


class Edge(_Node, frozen=True):
    """`start` or `end`."""

    bound: Bound
    span: Span


class Call(_Node, frozen=True):
    """A built-in function or a macro with its arguments."""

    function: Ident
    args: tuple[Expression, ...]
    span: Span


class Group(_Node, frozen=True):
    """An expression in round brackets."""

    inner: Expression
    span: Span


class Window(_Node, frozen=True):
    """An interval of durations; `low` is `None` for 0, `high` is `None` if it has no end."""

    low: Expression | None
    high: Expression | None
    low_open: bool
    high_open: bool
    span: Span


class Prefix(_Node, frozen=True):
    """`not` or a temporal operator before a formula.

    `within D` is `eventually` and `for D` is `always` with a window from 0.
    """

    op: UnaryOp
    window: Window | None
    operand: Expression
    op_span: Span
    span: Span


class Immediately(_Node, frozen=True):
    """`immediately φ`: the same as φ, but says that one instant is meant."""

    operand: Expression
    span: Span


class Infix(_Node, frozen=True):
    """A connective or temporal operator between two formulas."""

    op: BinaryOp
    left: Expression
    window: Window | None
    right: Expression
    op_span: Span
    span: Span


class Comparison(_Node, frozen=True):
    """A comparison of two expressions."""

    op: CompareOp
    left: Expression
    right: Expression
    op_span: Span
    span: Span


class Choice(_Node, frozen=True):
    """`if φ then x else y`."""

    condition: Expression
    chosen: Expression
    otherwise: Expression
    span: Span


class Operation(_Node, frozen=True):
    """Arithmetic on one or two expressions."""

    op: NumericOp
    args: tuple[Expression, ...]
    span: Span


class Path(_Node, frozen=True):
    """`AG p`, `E<> p`; `universal` for `A`.

    `reaching` operators, such as `A[]`, apply to everything up to the end of the formula.
    """

    universal: bool
    op: UnaryOp
    window: Window | None
    operand: Expression
    reaching: bool
    op_span: Span
    span: Span


class Quantified(_Node, frozen=True):
    """`A[φ U ψ]`, `E[φ U ψ]`; `path` is the expression in the brackets."""

    universal: bool
    path: Expression
    span: Span


class LeadsTo(_Node, frozen=True):
    """`φ --> ψ`: on all paths φ is always followed by ψ."""

    left: Expression
    window: Window | None
    right: Expression
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
    """The expression and all its parts, those in windows included, from left to right."""
    waiting: list[object] = [expression]
    while waiting:
        node = waiting.pop()
        if isinstance(node, tuple):
            waiting += reversed(node)
        elif isinstance(node, _Node):
            waiting += reversed(astuple(node))
            if not isinstance(node, Window):
                yield node  # type: ignore[misc]  # all nodes but windows are expressions


def ungrouped(expression: Expression) -> Expression:
    """An expression without the brackets around it."""
    while isinstance(expression, Group):
        expression = expression.inner
    return expression
