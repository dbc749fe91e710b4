"""State formulas as unions of convex sets of clock valuations, state by state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from rvmon.timed.model.evaluate import Locations, Values, evaluator
from rvmon.timed.model.expressions import TRUE, BinaryOperation, ClockCompare, Expression
from rvmon.timed.model.guards import is_discrete
from rvmon.timed.model.operators import BinaryOp
from rvmon.timed.model.rules import model_error
from rvmon.timed.zones.dbm import Atom
from rvmon.timed.zones.discrete import atoms_of

MOST_PIECES = 4000

Constraint = tuple[Atom, ...]
"""A convex piece of a union: bounds that hold together; the empty one holds everywhere."""

EVERYWHERE: Constraint = ()

ConstraintMaker = Callable[[Locations, Values], list[Constraint]]
"""The pieces of a formula in a discrete state; none: it holds nowhere there."""


@dataclass(frozen=True, slots=True)
class Alternative:
    """A condition on the discrete state and bounds of clocks, which hold together."""

    condition: Expression
    compares: tuple[ClockCompare, ...]


def together(parts: Iterable[Expression]) -> Expression:
    """One formula for parts that hold together."""
    formula: Expression = TRUE
    for part in parts:
        formula = part if formula == TRUE else BinaryOperation(BinaryOp.AND, formula, part)
    return formula


def alternatives_of(
    formula: Expression | None, due: Sequence[ClockCompare] = ()
) -> list[Alternative]:
    """A normalised formula as alternatives, in each of which more bounds hold; none for `None`."""
    if formula is None:
        return []
    return [
        Alternative(together(conditions), (*compares, *due))
        for conditions, compares in _split(formula)
    ]


_Parts = tuple[list[Expression], list[ClockCompare]]


def _split(formula: Expression) -> list[_Parts]:
    if is_discrete(formula):
        return [([formula], [])]
    match formula:
        case ClockCompare():
            return [([], [formula])]
        case BinaryOperation(BinaryOp.AND, left, right):
            some, others = _split(left), _split(right)
            if len(some) * len(others) > MOST_PIECES:
                raise model_error("TA019", "the query has too many alternatives", None)
            return [(a + c, b + d) for a, b in some for c, d in others]
        case BinaryOperation(BinaryOp.OR, left, right):
            return [*_split(left), *_split(right)]
        case _:
            raise AssertionError(f"{formula} is not normalised")


def constraint_maker(formula: Expression) -> ConstraintMaker:
    """Make a function that gives the pieces of a formula.

    Args:
        formula: normalised, without `deadlock` and path operators.
    """
    pieces = [
        (evaluator(one.condition), atoms_of(one.compares, None)) for one in alternatives_of(formula)
    ]
    return lambda locations, values: [
        tuple(atoms(locations, values)) for holds, atoms in pieces if holds(locations, values)
    ]
