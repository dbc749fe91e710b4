"""Walks over the syntax tree."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.spec.syntax.expressions import (
    Call,
    Choice,
    Comparison,
    Expression,
    Group,
    Immediately,
    Infix,
    LeadsTo,
    Operation,
    Path,
    Prefix,
    Quantified,
    Window,
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
