"""Steps automata through their tables, position by position, for tests of what is built."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from rvmon.logic.automaton import FAILED, PASSED, Automaton, Token
from rvmon.logic.state_formula import UNKNOWN
from rvmon.trace.time import NEVER


class TableMachine:
    """An automaton as it runs.

    A token is a location with, for each clock, the instant at which it was started. A row is a
    location with a region for each clock.
    """

    def __init__(self, automaton: Automaton) -> None:
        self.automaton = automaton
        self.start: Token = (automaton.initial, ())

    def row(self, token: Token, t: int) -> int:
        """The row of a token at `t`."""
        location, anchors = token
        cuts, strides = self.cuts(location), self.automaton.strides[location]
        regions = (bisect_right(cuts[k], t - anchor) for k, anchor in enumerate(anchors))
        steps = (region * stride for region, stride in zip(regions, strides, strict=True))
        return self.automaton.bases[location] + sum(steps)

    def step(self, token: Token, t: int, letter: int) -> Token:
        """The token after a position at `t`."""
        one = self.automaton
        edge = one.edges[self.row(token, t) * one.classes + one.class_of[letter]]
        anchors = tuple(t if source < 0 else token[1][source] for source in one.sources[edge])
        return one.targets[edge], anchors

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location the ages from which on it acts differently."""
        return self.automaton.locations[location].cuts

    def time_value(self, token: Token, t: int) -> int:
        """The truth once time has come to `t` and no position came."""
        return self.automaton.time_values[self.row(token, t)]


def settle(machine: Any, token: Token, t: int, until: int) -> tuple[Token, int]:
    """Let time pass from `t` to `until` without a position.

    Returns the token and the instant of its decision, or the next at which it might be decided.
    """
    while (t := _next_cut(machine, token, t)) <= until:
        truth = machine.time_value(token, t)
        if truth != UNKNOWN:
            return (PASSED if truth else FAILED, ()), t
    return token, t


def _next_cut(machine: Any, token: Token, t: int) -> int:
    """The first instant after `t` at which a clock of the token enters another region."""
    location, anchors = token
    cuts = zip(machine.cuts(location), anchors, strict=True) if anchors else ()
    return min((anchor + c for own, anchor in cuts for c in own if anchor + c > t), default=NEVER)
