"""How a formula that speaks of runs itself is split, and which ones are decided."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.timed.model.expressions import TRUE, BinaryOperation, Expression, PathFormula
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.zones.zone_unions import has_paths, speaks_of_deadlock


def is_decidable(formula: Expression) -> bool:
    """Whether a normalised formula is decided by going backwards, state by state."""
    match formula:
        case BinaryOperation(_, left, right):
            return is_decidable(left) and is_decidable(right)
        case PathFormula(PathOp.POSSIBLY | PathOp.INVARIANTLY, body, None):
            return is_decidable(body)
        case PathFormula():
            return False
        case _:
            return not speaks_of_deadlock(formula)


def alternatives(formula: Expression) -> list[list[Expression]]:
    """A normalised formula as alternatives of parts that hold together; plain parts stay whole."""
    match formula:
        case BinaryOperation(BinaryOp.OR, left, right) if has_paths(formula):
            return [*alternatives(left), *alternatives(right)]
        case BinaryOperation(BinaryOp.AND, left, right) if has_paths(formula):
            return [
                [*some, *others] for some in alternatives(left) for others in alternatives(right)
            ]
        case _:
            return [[formula]]


def together(parts: Iterable[Expression]) -> Expression:
    """One formula for parts that hold together."""
    formula: Expression = TRUE
    for part in parts:
        formula = BinaryOperation(BinaryOp.AND, formula, part)
    return formula


def lasting_part(parts: Sequence[Expression]) -> PathFormula | None:
    """The only part that speaks of runs, if it is `E[]` with a plain formula inside."""
    match [part for part in parts if has_paths(part)]:
        case [PathFormula(PathOp.POTENTIALLY_ALWAYS, body, _) as lasting] if not has_paths(body):
            return lasting
        case _:
            return None
