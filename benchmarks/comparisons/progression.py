"""Progression on the fly: a machine whose locations are made when they are needed, for tests."""

from __future__ import annotations

from bisect import bisect_right

from rvmon.errors import RvmonError
from rvmon.logic.automaton import NOW, Location, Token, location_of, normalise
from rvmon.logic.formula import Literal, Temporal
from rvmon.logic.letters import Alphabet, holds
from rvmon.logic.progress import after, step, value
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Residual, TooManyClausesError

_CACHE_LIMIT = 20_000
"""Edges that are kept; with more, all are forgotten (they can be made again)."""

MOST_CLOCKS = 16
"""Obligations with an age of their own that one attempt may owe at once.

A window above 0 that is started anew at every tick of held time would need one for every tick.
"""

MOST_CLAUSES = 32
"""Ways to fulfil what one attempt owes that may be weighed at once, before they are reduced."""

Edge = tuple[int, tuple[int, ...]]
"""Target and the sources of its clocks."""


class TooManyObligationsError(RvmonError):
    """An attempt cannot be judged by progression within bounded memory."""


class Progression:
    """Judges any formula; memory grows with the residuals that occur.

    Source: AUTOMATA 1.

    Args:
        required: what an attempt requires, as `X` of it: it starts before its trigger's position.
        alphabet: of that formula.
        name: of the requirement, for messages.

    Raises:
        TooManyObligationsError: in a step, if an attempt owes more than `MOST_CLOCKS` at once, or
            in more than `MOST_CLAUSES` ways.
    """

    def __init__(self, required: Temporal, alphabet: Alphabet, name: str = "a formula") -> None:
        self.alphabet = alphabet
        self._name = name
        self._required = required
        self._locations: list[Location] = []
        self._index: dict[Residual, int] = {}
        self._edges: dict[tuple[int, tuple[int, ...], int], Edge] = {}
        for residual in (FAILS, HOLDS):
            self._location(residual)
        first = self._location(frozenset([frozenset([(required, NO_CLOCK)])]))
        self.start: Token = (first, ())

    def _location(self, residual: Residual) -> int:
        index = self._index.get(residual)
        if index is None:
            index = self._index[residual] = len(self._locations)
            self._locations.append(location_of(residual))
        return index

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        index, anchors = token
        cuts = self._locations[index].cuts
        regions = tuple(
            bisect_right(cut, t - anchor) for cut, anchor in zip(cuts, anchors, strict=True)
        )
        key = (index, regions, letter)
        edge = self._edges.get(key)
        if edge is None:
            if len(self._edges) >= _CACHE_LIMIT:
                self._edges.clear()
            edge = self._edges[key] = self._edge(index, [t - anchor for anchor in anchors], letter)
        target, sources = edge
        return target, tuple([t if source == NOW else anchors[source] for source in sources])

    def _edge(self, index: int, ages: list[int], letter: int) -> Edge:
        valuation = self.alphabet.valuation(letter)

        def read(literal: Literal) -> Residual:
            return HOLDS if holds(literal.sense, valuation[literal.proposition]) else FAILS

        try:
            reached = step(self._locations[index].residual, ages, read, MOST_CLAUSES)
        except TooManyClausesError:
            raise TooManyObligationsError(
                f"an attempt of {self._name} can be fulfilled in more than {MOST_CLAUSES} ways"
            ) from None
        residual, sources = normalise(reached, len(ages))
        if len(sources) > MOST_CLOCKS:
            raise TooManyObligationsError(
                f"an attempt of {self._name} has more than {MOST_CLOCKS} open obligations at "
                "once: a window that does not begin at 0 starts again at every position. Begin the "
                "window at 0, start it `upon` an event, or use `time sampled`"
            )
        return self._location(residual), sources

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages from which on it acts differently."""
        return self._locations[location].cuts

    def time_value(self, token: Token, t: int) -> int:
        """The truth once time has come to `t` and no position came."""
        index, anchors = token
        return value(after(self._locations[index].residual, [t - anchor for anchor in anchors]))
