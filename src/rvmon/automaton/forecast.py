"""What the continuations of a trace can still bring: LTL3's anticipation for a residual.

Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4), 2011.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from rvmon.automaton.emptiness import TooLargeError, is_satisfiable
from rvmon.automaton.location import location_of
from rvmon.formula.dual import Duals
from rvmon.formula.residual import FAILS, HOLDS, Residual, TooManyClausesError

MOST_CLAUSES = 60
"""Of a residual, and of its negation."""

_MOST_KNOWN = 10_000
"""Answers that are kept; with more, all are forgotten (they can be worked out again)."""


class Forecaster:
    """Tells of residuals whether every, or no, continuation satisfies them.

    A continuation is an infinite word in which every proposition is known, independently of the
    others; bounded windows are judged by the ages of their clocks, each for itself. So a forecast
    that is given is right, and for formulas without bounds none is missed within the limits of
    the search.
    """

    def __init__(self) -> None:
        self._duals = Duals()
        self._known: dict[tuple[Residual, tuple[int, ...], int | None], bool | None] = {}

    def of(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        """The value that all continuations give a residual; `None` if they differ.

        Args:
            residual: what is owed after a position.
            ages: of its clocks at that position, ticks.
            gap: ticks between two positions; `None` if any number of them.

        Returns:
            `None`, too, where the search would outgrow its limits.
        """
        if residual in (HOLDS, FAILS):
            return residual == HOLDS
        if len(residual) > MOST_CLAUSES:
            return None
        cuts = location_of(residual).cuts
        regions = tuple(map(bisect_right, cuts, ages))
        key = (residual, regions, gap)
        if key not in self._known:
            if len(self._known) > _MOST_KNOWN:
                self._known.clear()
            self._known[key] = self._of(residual, ages, gap)
        return self._known[key]

    def _of(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool | None:
        try:
            if not is_satisfiable(self._duals.affirmed(residual), ages, gap):
                return False
            denied = self._duals.denied(residual, MOST_CLAUSES)
            return None if is_satisfiable(denied, ages, gap) else True
        except (TooLargeError, TooManyClausesError):
            return None
