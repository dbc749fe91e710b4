"""Progression on the fly: what an attempt owes is made when it is needed."""

from __future__ import annotations

from bisect import bisect_right

from rvmon.errors import RvmonError
from rvmon.logic.alphabet import Alphabet, holds
from rvmon.logic.automaton import FAILED, NOW, PASSED, Location, Token, location_of, normalise
from rvmon.logic.formula import Literal, Temporal
from rvmon.logic.progress import after, step, value
from rvmon.logic.residual import FAILS, HOLDS, NO_CLOCK, Residual, TooManyClausesError
from rvmon.logic.state_formula import UNKNOWN
from rvmon.trace.time import NEVER

MOST_CLOCKS = 16
"""Obligations with an age of their own that one attempt may owe at once.

A window above 0 that is started anew at every tick of held time would need one for every tick.
"""

MOST_CLAUSES = 32
"""Ways to fulfil what one attempt owes that may be weighed at once, before they are reduced."""


class TooManyObligationsError(RvmonError):
    """An attempt cannot be judged by progression within bounded memory."""


class Progression:
    """Judges any formula; memory grows with the residuals that occur.

    Source: AUTOMATA 1.

    Args:
        required: what an attempt requires, as `X` of it: it starts before its trigger's position.
        alphabet: of that formula.

    Raises:
        TooManyObligationsError: in a step, if an attempt owes more than `MOST_CLOCKS` at once, or
            in more than `MOST_CLAUSES` ways.
    """

    def __init__(self, required: Temporal, alphabet: Alphabet) -> None:
        self.alphabet = alphabet
        self._locations: list[Location] = []
        self._index: dict[Residual, int] = {}
        self._edges: dict[tuple[int, tuple[int, ...], int], tuple[int, tuple[int, ...]]] = {}
        for residual in (FAILS, HOLDS):
            self._location(residual)
        self.start: Token = (self._location(frozenset([frozenset([(required, NO_CLOCK)])])), ())

    def _location(self, residual: Residual) -> int:
        if residual not in self._index:
            self._index[residual] = len(self._locations)
            self._locations.append(location_of(residual))
        return self._index[residual]

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        index, anchors = token
        cuts = self._locations[index].cuts
        ages = [t - anchor for anchor in anchors]
        # Within a region of ages the same is owed.
        key = index, tuple(map(bisect_right, cuts, ages)), letter
        if key not in self._edges:
            self._edges[key] = self._edge(index, ages, letter)
        target, sources = self._edges[key]
        return target, tuple([t if source == NOW else anchors[source] for source in sources])

    def _edge(self, index: int, ages: list[int], letter: int) -> tuple[int, tuple[int, ...]]:
        """The target, and the sources of its clocks."""
        valuation = self.alphabet.valuation(letter)

        def read(literal: Literal) -> Residual:
            return HOLDS if holds(literal.sense, valuation[literal.proposition]) else FAILS

        try:
            reached = step(self._locations[index].residual, ages, read, MOST_CLAUSES)
        except TooManyClausesError:
            raise TooManyObligationsError("it can be fulfilled in too many ways") from None
        residual, sources = normalise(reached, len(ages))
        if len(sources) > MOST_CLOCKS:
            raise TooManyObligationsError("it has too many open obligations at once")
        return self._location(residual), sources

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages from which on it acts differently."""
        return self._locations[location].cuts

    def time_value(self, token: Token, t: int) -> int:
        """The truth once time has come to `t` and no position came."""
        index, anchors = token
        return value(after(self._locations[index].residual, [t - anchor for anchor in anchors]))


def settle(machine: Progression, token: Token, t: int, until: int) -> tuple[Token, int]:
    """Let time pass from `t` to `until` without a position.

    Returns the token and the instant of its decision, or the next at which it might be decided.
    """
    while (t := _next_cut(machine, token, t)) <= until:
        truth = machine.time_value(token, t)
        if truth != UNKNOWN:
            return (PASSED if truth else FAILED, ()), t
    return token, t


def _next_cut(machine: Progression, token: Token, t: int) -> int:
    """The first instant after `t` at which a clock of the token enters another region."""
    location, anchors = token
    cuts = zip(machine.cuts(location), anchors, strict=True) if anchors else ()
    return min((anchor + c for own, anchor in cuts for c in own if anchor + c > t), default=NEVER)
