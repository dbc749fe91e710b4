"""An automaton of one clock at most as arrays, and which of them can be driven by arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.automaton.ages import NEVER
from rvmon.automaton.automaton import Automaton
from rvmon.automaton.letter_classes import LetterDiagram
from rvmon.automaton.location import NOW, PASSED

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_ROWS = 64
"""Of locations and regions: for each one the letters are looked through."""


@dataclass(frozen=True, slots=True, eq=False)
class Moves:
    """The tables of an automaton; see `rvmon.automaton.automaton.Automaton`.

    Attributes:
        initial: the location before the position of the trigger.
        clocked: per location, whether it has a clock.
        class_of: per letter.
        bases: per location, its first row; regions follow.
        owner: per row, its location.
        cuts: per location and region the age at which it ends; `NEVER` if none does.
        targets: per row and class; a location no run comes from leads to `PASSED`.
        restarts: per row and class, whether the clock is started anew.
        leads_on: per row and class, whether it leads elsewhere, or starts the clock.
        time_values: per row.
    """

    initial: int
    clocked: tuple[bool, ...]
    class_of: NDArray[np.int64]
    bases: NDArray[np.int64]
    owner: NDArray[np.int64]
    cuts: NDArray[np.int64]
    targets: NDArray[np.int64]
    restarts: NDArray[np.bool_]
    leads_on: NDArray[np.bool_]
    time_values: NDArray[np.int64]


def moves_of(automaton: Automaton, gap: int | None) -> Moves | None:
    """The automaton as arrays; `None` if attempts in it have to be driven one by one.

    Args:
        automaton: any.
        gap: ticks between two positions; a clock that moves along while nothing changes is
            followed only where every tick is one.
    """
    if automaton.clocks > 1 or isinstance(automaton.class_of, LetterDiagram):
        return None
    rows = len(automaton.edges) // automaton.classes
    if rows > _MOST_ROWS:
        return None
    places = automaton.locations
    owner = np.zeros(rows, np.int64)
    cuts = np.full(
        (len(places), 1 + max(_regions(automaton, i) for i in range(len(places)))), NEVER
    )
    for number, place in enumerate(places):
        regions = _regions(automaton, number)
        if regions > 1 and automaton.strides[number] != (1,):
            return None
        owner[automaton.bases[number] : automaton.bases[number] + regions] = number
        if place.cuts:
            cuts[number, : regions - 1] = place.cuts[0]
    edges = np.array(automaton.edges, np.int64).reshape(rows, automaton.classes)
    targets = np.where(edges < 0, PASSED, np.array(automaton.targets)[edges])
    anew = np.array([sources == (NOW,) for sources in automaton.sources])
    restarts = (edges >= 0) & anew[edges]
    loops = targets == owner[:, None]
    if gap != 1 and bool((loops & restarts).any()):
        return None
    return Moves(
        automaton.initial,
        tuple(bool(place.cuts) for place in places),
        np.array(automaton.class_of, np.int64),
        np.array(automaton.bases, np.int64),
        owner,
        cuts,
        targets,
        restarts,
        ~loops | restarts,
        np.array(list(automaton.time_values), np.int64),
    )


def joint_moves(moves: Moves, one: NDArray[Any], other: NDArray[Any]) -> Moves:
    """The moves under two letters at a time, as long as both lead to the same.

    Args:
        moves: of an automaton.
        one: int[k], classes of letters; the joint letter `i` is `one[i]` with `other[i]`.
        other: int[k].

    Returns:
        Tables by joint letter, that lead to `PASSED` where the two lead apart.
    """
    targets, restarts = moves.targets[:, one], moves.restarts[:, one]
    apart = (targets != moves.targets[:, other]) | (restarts != moves.restarts[:, other])
    targets = np.where(apart, PASSED, targets)
    restarts = restarts & ~apart
    return replace(
        moves,
        class_of=np.arange(len(one)),
        targets=targets,
        restarts=restarts,
        leads_on=(targets != moves.owner[:, None]) | restarts,
    )


def _regions(automaton: Automaton, location: int) -> int:
    cuts = automaton.locations[location].cuts
    return len(cuts[0]) + 1 if cuts else 1
