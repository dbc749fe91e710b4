"""Forecasts: whether every, or no, continuation of a trace satisfies a residual (LTL3).

Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4), 2011.
"""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.logic.emptiness import Start, TooLargeError, is_satisfiable, start_of
from rvmon.logic.progress import Duals
from rvmon.logic.residual import FAILS, HOLDS, Residual, TooManyClausesError

MOST_CLAUSES = 60
"""Of a residual, and of its negation."""

_MOST_KNOWN = 10_000
"""Answers that are kept; with more, all are forgotten (they can be worked out again)."""


class Forecaster:
    """Forecasts the value of residuals.

    A continuation is an infinite word in which every proposition is known, independently of the
    others; bounded windows are judged by what is known of the ages of their clocks. So a forecast
    that is given is right, and for formulas without bounds none is missed within the limits of
    the search.

    Attributes:
        duals: the factory of residuals over known propositions, and of their negations.
    """

    def __init__(self) -> None:
        self.duals = Duals()
        self._known: dict[tuple[Start, int | None], bool] = {}

    def of(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        """The value of a residual under all continuations; `None` if they differ.

        Args:
            residual: what is required after a position.
            ages: of its clocks at that position, ticks.
            gap: ticks between two positions; `None` if any number of them.

        Returns:
            `None`, too, where the search would outgrow its limits.
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
            residual: of formulas of `duals`.
            ages: as for `of`.
            gap: the same.
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
