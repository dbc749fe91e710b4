"""The problem of reaching a formula that speaks of runs itself, and how such a formula is split."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.timed.model.expressions import TRUE, BinaryOperation, Expression, PathFormula
from rvmon.timed.model.network import Network
from rvmon.timed.model.operators import BinaryOp, PathOp
from rvmon.timed.search.ctl import Satisfaction
from rvmon.timed.search.meter import Meter
from rvmon.timed.zones.dbm import Zone
from rvmon.timed.zones.discrete import State
from rvmon.timed.zones.federation import constraint_of
from rvmon.timed.zones.symbolic import Steps, meets
from rvmon.timed.zones.zone_unions import Constraint, has_paths


class NestedReachability(Steps):
    """Reach a formula with `E<>` or `A[]` inside; sites are discrete states, links are moves."""

    def __init__(self, network: Network, formula: Expression, meter: Meter) -> None:
        super().__init__(network, formula, bisimilar=True)
        self._formula = formula
        self._meter = meter
        self._satisfaction = Satisfaction(self.space, meter)

    def goal(self, site: State, zone: Zone) -> Constraint | None:
        """A part of the zone where the formula holds."""
        parts = self._satisfaction.of(self._formula, site)
        if self._meter.stopped:
            return None  # what the backward search has not met yet may decide otherwise
        for part in parts:
            constraint = constraint_of(part, self.dim)
            if meets(zone, self.dim, constraint):
                return constraint
        return None


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
