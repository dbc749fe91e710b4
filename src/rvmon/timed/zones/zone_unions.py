"""State formulas as unions of convex sets of clock valuations, state by state."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rvmon.timed.model.evaluate import Locations, Values, evaluator
from rvmon.timed.model.expressions import (
    BinaryOperation,
    ClockCompare,
    ClockOp,
    Deadlock,
    Expression,
    PathFormula,
)
from rvmon.timed.model.guards import is_discrete, parts_of
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BinaryOp
from rvmon.timed.zones.clock_bounds import ClockBounds, compared_bounds
from rvmon.timed.zones.compile import atoms_of
from rvmon.timed.zones.dbm import Atom

Constraint = tuple[Atom, ...]
"""A convex piece of a union: bounds that hold together; the empty one holds everywhere."""

ConstraintMaker = Callable[[Locations, Values], list[Constraint]]
"""The pieces of a formula in a discrete state; none: it holds nowhere there."""

EVERYWHERE: Constraint = ()


def constraint_maker(formula: Expression) -> ConstraintMaker:
    """Make a function that gives the pieces of a formula.

    Args:
        formula: normalised, without `deadlock` and path operators.
    """
    if is_discrete(formula):
        holds = evaluator(formula)
        return lambda locations, values: [EVERYWHERE] if holds(locations, values) else []
    match formula:
        case ClockCompare():
            atoms = atoms_of((formula,), None)
            return lambda locations, values: [tuple(atoms(locations, values))]
        case BinaryOperation(BinaryOp.AND, left, right):
            return _both(constraint_maker(left), constraint_maker(right))
        case BinaryOperation(BinaryOp.OR, left, right):
            return _either(constraint_maker(left), constraint_maker(right))
        case _:
            raise AssertionError(f"{formula} is not normalised")


def _both(left: ConstraintMaker, right: ConstraintMaker) -> ConstraintMaker:
    def constraints(locations: Locations, values: Values) -> list[Constraint]:
        firsts = left(locations, values)
        seconds = right(locations, values) if firsts else []
        return [(*first, *second) for first in firsts for second in seconds]

    return constraints


def _either(left: ConstraintMaker, right: ConstraintMaker) -> ConstraintMaker:
    def constraints(locations: Locations, values: Values) -> list[Constraint]:
        firsts = left(locations, values)
        if EVERYWHERE in firsts:
            return [EVERYWHERE]
        seconds = right(locations, values)
        return [EVERYWHERE] if EVERYWHERE in seconds else [*firsts, *seconds]

    return constraints


def compares_of(formula: Expression) -> Iterator[ClockCompare]:
    """All comparisons of clocks in a formula."""
    return (part for part in parts_of(formula) if isinstance(part, ClockCompare))


def speaks_of_deadlock(formula: Expression) -> bool:
    """Whether `deadlock` occurs in a formula."""
    return any(isinstance(part, Deadlock) for part in parts_of(formula))


def has_paths(formula: Expression) -> bool:
    """Whether a path operator occurs in a formula."""
    return any(isinstance(part, PathFormula) for part in parts_of(formula))


def is_plain(formula: Expression) -> bool:
    """Whether a formula speaks of the state alone: of no runs and no deadlock."""
    return not (has_paths(formula) or speaks_of_deadlock(formula))


def has_bounds(formula: Expression) -> bool:
    """Whether a path operator with a bound occurs in a formula."""
    parts = parts_of(formula)
    return any(isinstance(part, PathFormula) and part.bound is not None for part in parts)


def formula_bounds(formula: Expression, network: Network) -> ClockBounds:
    """What a formula compares clocks with."""
    return compared_bounds(network, compares_of(formula))


def has_strict_bounds(network: Network, *formulas: Expression) -> bool:
    """Whether some clock is compared by `<` or `>`, in the network or in a formula."""
    compares = [
        *(c for a in network.automata for place in a.locations for c in place.invariant.clocks),
        *(c for a in network.automata for edge in a.edges for c in edge.guard.clocks),
        *(c for formula in formulas for c in compares_of(formula)),
    ]
    return any(compare.op in (ClockOp.LT, ClockOp.GT) for compare in compares)
