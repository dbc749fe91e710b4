"""How far into the future a formula looks."""

from __future__ import annotations

from typing import assert_never

from rvmon.formula.core import (
    And,
    Constant,
    Core,
    Literal,
    Next,
    Or,
    Previous,
    Release,
    Since,
    Until,
)


def horizon(formula: Core) -> int | None:
    """The ticks after the trigger by which an attempt is decided; `None` if nothing bounds them.

    `Next` counts as nothing bounded, as its distance in time is not known.
    """
    match formula:
        case Constant() | Literal():
            return 0
        case And(args=args) | Or(args=args):
            return _greatest(args, 0)
        case Next():
            return None
        case Until(left=left, right=right, high=high) | Release(left=left, right=right, high=high):
            return _greatest((left, right), high)
        case Since(left=left, right=right):
            return _greatest((left, right), 0)
        case Previous(operand=operand):
            return horizon(operand)
        case _:
            assert_never(formula)


def _greatest(parts: tuple[Core, ...], further: int | None) -> int | None:
    if further is None:
        return None
    greatest = 0
    for part in parts:
        reach = horizon(part)
        if reach is None:
            return None
        greatest = max(greatest, reach)
    return greatest + further
