"""LTL3 monitors: what must come to pass counts as decided."""

from __future__ import annotations

from array import array
from dataclasses import replace

from rvmon.automaton.automaton import Automaton
from rvmon.automaton.forecast import Forecaster
from rvmon.automaton.location import FAILED, PASSED, Location
from rvmon.automaton.reduce import reduce
from rvmon.formula.residual import FAILS
from rvmon.formula.state import FALSE, TRUE


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
