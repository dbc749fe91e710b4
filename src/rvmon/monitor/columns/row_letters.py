"""The letters that a requirement reads along a piece of a trace."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rvmon.automaton.moves import Moves
from rvmon.formula.alphabet import Alphabet
from rvmon.monitor.columns.axis import Axis
from rvmon.monitor.columns.leaves import Truth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


def letters_along(
    alphabet: Alphabet, truths: Sequence[Truth], axis: Axis
) -> tuple[Numbers, tuple[Numbers, Numbers]]:
    """The stretches of one letter.

    Returns:
        The first place of each stretch, and its letter with the unknown taken for the worse and for
        the better: the same object where all is known.
    """
    known = all(truth.known for truth in truths)
    edges, worse, better = [np.array([axis.start])], [np.zeros(1, np.int64)], []
    for truth, low, high in zip(truths, alphabet.pessimistic, alphabet.optimistic, strict=True):
        worse[0] = worse[0] + low[0]
        parts = ((truth.must, 0, 2),) if truth.known else ((truth.may, 0, 1), (truth.must, 1, 2))
        for toggles, before, behind in parts:
            edges.append(toggles)
            worse.append(_turns(len(toggles), low[behind] - low[before]))
            better.append(_turns(len(toggles), high[behind] - high[before]))
    first = np.zeros(1, np.int64) + sum(high[0] for high in alphabet.optimistic)
    places = np.concatenate(edges)
    order = np.argsort(places, kind="stable")
    places = places[order]
    # Of several changes at one place the last one has counted all; those at the end are over.
    own = np.append(places[1:] != places[:-1], True) & (places < max(axis.stop, axis.start + 1))
    made = np.cumsum(np.concatenate(worse)[order])[own]
    if known:
        return places[own], (made, made)
    other = np.cumsum(np.concatenate([first, *better])[order])[own]
    return places[own], (made, other)


def _turns(length: int, step: int) -> Numbers:
    """By so much a letter grows where a stretch starts, and shrinks where it stops."""
    made = np.full(length, step)
    made[1::2] = -step
    return made


class Letters:
    """The letters of a piece in one reading.

    Args:
        moves: read them.
        starts: the first place of each stretch of one letter.
        letters: of the stretches.
        stop: behind the last place.
    """

    def __init__(self, moves: Moves, starts: Numbers, letters: Numbers, stop: int) -> None:
        self.moves = moves
        self.starts = starts
        self.classes = moves.class_of[letters]
        self._begins = np.append(starts, stop)
        self._next: dict[tuple[int, bool], Numbers] = {}

    def next_leading(self, row: Numbers, following: Numbers, *, sliding: bool = False) -> Any:
        """For each attempt the next place that leads it on, and the stretch that it is in.

        Args:
            row: of the automaton.
            following: the first place that counts.
            sliding: whether going on with a clock that moves along counts as staying.
        """
        stretch = np.searchsorted(self.starts, following, "right") - 1
        present = np.flatnonzero(np.bincount(row)).tolist()
        if len(present) == 1:
            found = self._table(present[0], sliding)[stretch]
        else:
            found = np.empty(len(row), np.int64)
            for one in present:
                own = row == one
                found[own] = self._table(one, sliding)[stretch[own]]
        return np.where(found == stretch, following, self._begins[found]), found

    def next_for_one(self, row: int, following: int, *, sliding: bool = False) -> tuple[int, int]:
        """As `next_leading`, for one attempt."""
        stretch = int(np.searchsorted(self.starts, following, "right")) - 1
        found = self._table(row, sliding).item(stretch)
        return following if found == stretch else self._begins.item(found), found

    def _table(self, row: int, sliding: bool) -> Numbers:
        """For each stretch the first from it on that leads on; their number, if none does."""
        found = self._next.get((row, sliding))
        if found is None:
            moves, count = self.moves, len(self.starts)
            leads = moves.leads_on[row]
            if sliding:
                leads = ~moves.restarts[row] | (moves.targets[row] != moves.owner[row])
            ahead = np.where(leads[self.classes], np.arange(count), count)
            found = np.minimum.accumulate(ahead[::-1])[::-1]
            self._next[row, sliding] = found
        return found
