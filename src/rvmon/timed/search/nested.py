"""How a formula that speaks of runs itself is split, to be sought piece by piece."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.timed.model.expressions import TRUE, BinaryOperation, Expression, PathFormula
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.zones.zone_unions import has_paths, is_plain


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
        case [PathFormula(PathOp.POTENTIALLY_ALWAYS, body, _, left) as lasting] if (
            left == TRUE and is_plain(body)
        ):
            return lasting
        case _:
            return None
