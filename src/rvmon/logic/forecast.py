"""What the continuations of a trace can still bring: LTL3's anticipation for a residual.

Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4), 2011.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import replace

from rvmon.logic.automaton import FAILED, PASSED, Automaton, Location
from rvmon.logic.emptiness import Start, TooLargeError, is_satisfiable, start_of
from rvmon.logic.progress import Duals
from rvmon.logic.reduce import reduce
from rvmon.logic.residual import FAILS, HOLDS, Residual, TooManyClausesError
from rvmon.logic.state_formula import FALSE, TRUE

MOST_CLAUSES = 60
"""Of a residual, and of its negation."""

_MOST_KNOWN = 10_000
"""Answers that are kept; with more, all are forgotten (they can be worked out again)."""


class Forecaster:
    """Tells of residuals whether every, or no, continuation satisfies them.

    A continuation is an infinite word in which every proposition is known, independently of the
    others; bounded windows are judged by what is known of the ages of their clocks. So a forecast
    that is given is right, and for formulas without bounds none is missed within the limits of
    the search.

    Attributes:
        duals: makes formulas of propositions that are known, and their negations.
    """

    def __init__(self) -> None:
        self.duals = Duals()
        self._known: dict[tuple[Start, int | None], bool] = {}

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
        if not self.admits(self.duals.affirmed(residual), ages, gap):
            return False
        try:
            denied = self.duals.denied(residual, MOST_CLAUSES)
        except TooManyClausesError:
            return None
        return None if self.admits(denied, ages, gap) else True

    def admits(self, residual: Residual, ages: Sequence[int], gap: int | None) -> bool:
        """Whether continuations may satisfy a residual; true, too, where it is not worked out.

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


def ltl3_monitor(automaton: Automaton, forecaster: Forecaster) -> Automaton:
    """The least automaton that decides as soon as every continuation agrees.

    It knows nothing of what is owed, nor of the rule for the end of a trace, nor what to do where
    a proposition is unknown. Locations that no letters lead to may remain.

    Args:
        automaton: without clocks.
        forecaster: knows what is still possible.

    Raises:
        ValueError: it has clocks.

    Source: Bauer, Leucker and Schallhart, Runtime verification for LTL and TLTL, ACM TOSEM 20(4),
    2011, section 3.
    """
    if automaton.clocks:
        raise ValueError("an automaton with clocks has no least LTL3 monitor of this kind")
    ends = [forecaster.of(location.residual, (), None) for location in automaton.locations]

    def ahead(index: int) -> int:
        end = ends[index]
        return index if end is None else PASSED if end else FAILED

    count = len(automaton.locations)
    forgetful = replace(
        automaton,
        locations=(Location(FAILS, ()),) * count,
        initial=ahead(automaton.initial),
        edges=_where_all_is_known(automaton),
        targets=tuple(map(ahead, automaton.targets)),
        end_values=bytes(index == PASSED for index in range(count)),
    )
    return reduce(forgetful)


def _where_all_is_known(automaton: Automaton) -> array[int]:
    """The edges, those under other letters like those under one of which all is known."""
    letters = {0}
    for weights in automaton.alphabet.pessimistic:
        letters = {letter + weights[truth] for letter in letters for truth in (FALSE, TRUE)}
    known = {automaton.class_of[letter] for letter in letters}
    chosen = [one if one in known else min(known) for one in range(automaton.classes)]
    rows = range(0, len(automaton.edges), automaton.classes)
    return array(
        automaton.edges.typecode, (automaton.edges[row + one] for row in rows for one in chosen)
    )
