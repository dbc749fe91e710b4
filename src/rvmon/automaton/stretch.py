"""Driving a token through time: stretches of positions with one letter, gaps without positions."""

from __future__ import annotations

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import INFINITY, Machine, Token
from rvmon.formula.state import UNKNOWN


def next_cut(machine: Machine, token: Token, t: int) -> int:
    """The first instant after `t` at which a clock of the token enters another region."""
    location, anchors = token
    found = INFINITY
    for cuts, anchor in zip(machine.cuts(location), anchors, strict=True):
        for cut in cuts:
            if anchor + cut > t:
                found = min(found, anchor + cut)
                break
    return found


def settle(machine: Machine, token: Token, t: int, until: int) -> tuple[Token, int]:
    """Let time pass without a position.

    Args:
        machine: the engine.
        token: as it stood at `t`, undecided.
        t: an instant up to which nothing is to be settled.
        until: the instant that time comes to.

    Returns:
        The token, decided if time alone decided it, and the instant of that, or else the next
        instant after `until` at which it might.
    """
    cut = next_cut(machine, token, t)
    while cut <= until:
        truth = machine.time_value(token, cut)
        if truth != UNKNOWN:
            return (PASSED if truth else FAILED, ()), cut
        cut = next_cut(machine, token, cut)
    return token, cut


def run(
    machine: Machine, token: Token, letter: int, first: int, last: int, period: int
) -> tuple[Token, int]:
    """Step a token through equal letters, jumping where it only loops.

    A loop is: the same location again, each clock either kept or moved by exactly one period. It
    goes on until a kept clock enters another region (AUTOMATA 3).

    Args:
        machine: the engine.
        token: undecided; the last position before was `first - period`.
        letter: at all these positions.
        first: the first position, ticks.
        last: the instant that time comes to, at least `first`; the positions are `first`, then
            each `period` ticks up to it.
        period: between two positions, ticks.

    Returns:
        The token, and: if it is decided, the instant of that; else the first instant after `last`
        at which, the letter being the same, it will not just loop on.
    """
    position = first
    while True:
        if period > 1:
            token, cut = settle(machine, token, position - period, min(position - 1, last))
            if token[0] <= PASSED:
                return token, cut
        if position > last:
            return token, position if period == 1 else min(position, cut)
        moved = machine.step(token, position, letter)
        if moved[0] <= PASSED:
            return moved, position
        kept = _kept(token, moved, period)
        token = moved
        if kept is not None:
            cut = _next_cut_of(machine, token, kept, position)
            ahead = min(cut - 1 - position, last - position) // period * period
            if ahead > 0:
                token = _slide(token, kept, ahead)
                position += ahead
            if cut > last:
                return token, cut
        position += period


def _kept(before: Token, behind: Token, period: int) -> list[bool] | None:
    """For each clock whether it was kept (else it was moved by a period); `None`: no loop."""
    if before[0] != behind[0]:
        return None
    kept = []
    for old, new in zip(before[1], behind[1], strict=True):
        if new != old and new != old + period:
            return None
        kept.append(new == old)
    return kept


def _next_cut_of(machine: Machine, token: Token, kept: list[bool], t: int) -> int:
    location, anchors = token
    found = INFINITY
    for cuts, anchor, stays in zip(machine.cuts(location), anchors, kept, strict=True):
        if stays:
            for cut in cuts:
                if anchor + cut > t:
                    found = min(found, anchor + cut)
                    break
    return found


def _slide(token: Token, kept: list[bool], ticks: int) -> Token:
    location, anchors = token
    if all(kept):
        return token
    moved = (a if stays else a + ticks for a, stays in zip(anchors, kept, strict=True))
    return location, tuple(moved)
