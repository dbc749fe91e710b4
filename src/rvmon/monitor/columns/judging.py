"""Attempts judged by both readings of what is unknown, along one piece of a trace."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.moves import Moves, joint_moves
from rvmon.monitor.columns.attempts import Attempts, Tokens
from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.drive import Driver, Outcome
from rvmon.monitor.columns.row_letters import Letters
from rvmon.monitor.columns.timeline import Piece

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


class Judging:
    """Drives attempts of one requirement through a piece.

    Args:
        moves: its automaton.
        leaves: the nodes that it reads of the input.
        piece: of the trace.
        letters: the first place of each stretch of one letter; the letters with the unknown taken
            for the worse and for the better, the same object where all is known.
        limit: the instant that time comes to.
    """

    def __init__(
        self,
        moves: Moves,
        leaves: Sequence[int],
        piece: Piece,
        letters: tuple[Numbers, tuple[Numbers, Numbers]],
        limit: int,
    ) -> None:
        self._moves = moves
        self._leaves = leaves
        self._piece = piece
        self._starts, self._letters = letters
        self._limit = limit
        self._is_known = self._letters[0] is self._letters[1]
        driver = self._driver(moves, self._letters[0])
        self._drivers = driver, driver if self._is_known else self._driver(moves, self._letters[1])

    def _driver(self, moves: Moves, letters: Numbers) -> Driver:
        axis = self._piece.axis
        return Driver(moves, Letters(moves, self._starts, letters, axis.stop), axis, self._limit)

    def judge(self, attempts: Attempts) -> Outcome:
        """Drive attempts to the end of the piece; those that are not decided are moved on."""
        if self._is_known:
            return self._driven(attempts)
        worse, better = attempts.worse, attempts.better
        together = (
            np.arange(len(worse)) if better is None else np.flatnonzero(~worse.differ(better))
        )
        tokens = worse.pick(together)
        outcome = self._driven(attempts)
        still = outcome.decided[together] == FAR
        self._note_parted(attempts, together[still], tokens.pick(still))
        return outcome

    def _note_parted(self, attempts: Attempts, together: Numbers, tokens: Tokens) -> None:
        """Note of open attempts of which the runs parted in the piece where they first did.

        Args:
            attempts: as they are behind the piece.
            together: those whose runs were at one place before it.
            tokens: their place.
        """
        if attempts.better is None:
            return
        parted = attempts.worse.differ(attempts.better)[together]
        if not parted.any():
            return
        tokens = tokens.pick(parted)
        following = tokens.place + 1
        came = self._joint_driver.drive(tokens)
        stretch = np.searchsorted(self._starts, came.place, "right") - 1
        places = np.maximum(self._starts[stretch], following)
        attempts.doubted[together[parted]] = self._piece.axis.instants(places)
        attempts.doubt_seen[together[parted]] = self._piece.seen(self._leaves, places)

    @cached_property
    def _joint_driver(self) -> Driver:
        """Drives to where the readings lead apart."""
        classes, count = self._moves.class_of, self._moves.targets.shape[1]
        worse, better = (classes[own] for own in self._letters)
        pairs, joint = np.unique(worse * count + better, return_inverse=True)
        return self._driver(joint_moves(self._moves, *np.divmod(pairs, count)), joint)

    def _driven(self, attempts: Attempts) -> Outcome:
        """The outcome, of both readings together."""
        if attempts.better is None:
            if self._is_known:
                return self._drivers[0].drive(attempts.worse)
            attempts.better = attempts.worse.copy()
        worse = self._drivers[0].drive(attempts.worse)
        better = self._drivers[1].drive(attempts.better)
        passed = (worse.decided < FAR) & worse.passed
        failed = (better.decided < FAR) & ~better.passed
        # What one reading alone has decided waits for the other.
        attempts.worse.location[(worse.decided < FAR) & ~passed] = FAILED
        attempts.better.location[(better.decided < FAR) & ~failed] = PASSED
        return Outcome(
            np.where(passed, worse.decided, np.where(failed, better.decided, FAR)),
            passed,
            np.where(failed, better.location, worse.location),
            np.where(failed, better.anchor, worse.anchor),
            np.where(failed, better.place, worse.place),
            failed.astype(np.int64),
        )
