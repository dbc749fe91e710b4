"""Forecasts: whether every, or no, continuation of a trace satisfies a residual (LTL3).

Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4), 2011.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.logic.emptiness import Start, TooLargeError, is_satisfiable, start_of
from rvmon.logic.progress import Duals
from rvmon.logic.residual import FAILS, HOLDS, Residual, TooManyClausesError

MOST_CLAUSES = 60
"""The most clauses of a residual, and of its negation."""

_MOST_KNOWN = 10_000
"""The cache is emptied when it exceeds this many answers."""


class Forecaster:
    """Forecasts the value of residuals.

    A continuation is an infinite word in which every proposition is known, and independent of the
    others; for bounded windows the ages of clocks are over-approximated. So a forecast is sound,
    and within the limits of the search it is complete for formulas without bounds.

    Attributes:
        duals: the factory of residuals over known propositions, and of their negations.
    """

    def __init__(self) -> None:
        self.duals = Duals()
        self._known: dict[tuple[Start, int | None], bool] = {}

    def of(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        """The value of a residual under all continuations; `None` if they differ.

        Args:
            residual: the residual after a position.
            ages: of its clocks at that position, ticks.
            gap: ticks between two positions; `None` if it varies.

        Returns:
            `None` also where the search exceeds its limits.
        """
        if residual in (HOLDS, FAILS):
            return residual == HOLDS
        if len(residual) > MOST_CLAUSES:
            return None
        if not self.admits(self.duals.affirmed(residual), ages, gap):
            return False
        try:
            denied = self.duals.denied(residual, MOST_CLAUSES)
        except TooManyClausesError:
            return None
        return None if self.admits(denied, ages, gap) else True

    def admits(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool:
        """Whether a continuation may satisfy a residual; true also if the search is given up.

        Args:
            residual: over formulas made by `duals`.
            ages: as for `of`.
            gap: as for `of`.
        """
        if len(residual) > MOST_CLAUSES:
            return True
        start = start_of(residual, ages, gap)
        if start is None:
            return True
        key = (start, gap)
        if key not in self._known:
            if len(self._known) > _MOST_KNOWN:
                self._known.clear()
            try:
                self._known[key] = is_satisfiable(start, gap)
            except TooLargeError:
                self._known[key] = True
        return self._known[key]
