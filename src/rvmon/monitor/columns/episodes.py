"""The attempts of a `whenever`, one after the other: each failure begins another (SEMANTICS 3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from rvmon.monitor.columns.attempts import Attempts, joined_attempts
from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.drive import Outcome
from rvmon.monitor.columns.judging import Judging
from rvmon.monitor.columns.leaves import Truth
from rvmon.monitor.columns.stretches import (
    first_in,
    holds_at,
    holds_at_last,
    in_at_least,
    unknown_in,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.columns.stretches import Toggles

    Numbers = NDArray[np.int64]

Make = Callable[["Numbers", "Numbers"], Attempts]
"""Makes attempts that start at places, with where their episodes are over."""

Judged = tuple[Attempts, Outcome]

_ROUNDS = 2
"""So many failures of an episode are followed one by one."""


class Episodes:
    """Follows the episodes of a requirement from piece to piece.

    Attributes:
        failed_at: the instant at which the attempt of the episode that runs has failed, and no
            other has begun; `None` if that is not so.
        is_clouded: whether the trigger was unknown in the attempt that runs.
        is_unborn: whether something that is owed speaks of signals that have had no value.
    """

    def __init__(self) -> None:
        self.failed_at: int | None = None
        self.is_clouded = False
        self.is_unborn = False

    def take(
        self,
        attempts: Attempts,
        make: Make,
        judging: Judging,
        axis: Axis,
        truths: tuple[Truth, Truth, Truth | None],
    ) -> Judged:
        """Judge attempts along a piece, and those that follow them.

        Args:
            attempts: open, or starting in the piece, by their starts.
            make: makes those that follow.
            judging: of the piece.
            axis: of the piece.
            truths: of the trigger; of what is false where an episode does not go on after a
                failure; of what tells that something is not born.

        Returns:
            All of them by their starts, with what became of them.
        """
        if axis.start == axis.stop:
            return attempts, judging.judge(attempts)
        trigger, again, unborn = truths
        piece = _Piece(axis, trigger.may, again.may, make, judging)
        running = (attempts.stop == FAR) & (attempts.start < axis.start)
        attempts.stop[running] = piece.stop_of_old
        parts = [piece.judged(attempts)]
        places = piece.following(*parts[0])
        if self.failed_at is not None:
            own = np.array([self.failed_at]), np.array([piece.stop_of_old])
            waiting = piece.going_on(*own)
            places = np.append(waiting, places)
            if len(waiting) or piece.stop_of_old < FAR:
                self.failed_at = None
        parts += piece.follow(places)
        if len(parts) == 1:
            whole = parts[0]
        else:
            joined = joined_attempts([one for one, _ in parts])
            order = np.argsort(joined.start, kind="stable")
            outcome = Outcome.joined([one for _, one in parts])
            whole = joined.pick(order), outcome.pick(order)
        self._look_at_end(*whole, trigger, axis)
        if unborn is not None:
            self._void(whole[0], unborn.must, axis)
        return whole

    def _look_at_end(
        self, attempts: Attempts, outcome: Outcome, trigger: Truth, axis: Axis
    ) -> None:
        """See what has become of the episode that runs at the end of the piece."""
        running = np.flatnonzero(attempts.stop == FAR)
        clouded, self.is_clouded = self.is_clouded, False
        if not len(running):
            return
        last = running.item(-1)
        decided, start = outcome.decided.item(last), attempts.start.item(last)
        if decided < FAR:
            self.failed_at = None if outcome.passed[last] else decided
            return
        unknown = unknown_in(trigger.must, trigger.may, axis.start, axis.stop)
        lost = len(unknown) > 0 and bool(unknown[-1] > start)
        self.is_clouded = lost or (clouded and start < axis.start)

    def _void(self, attempts: Attempts, unborn: Toggles, axis: Axis) -> None:
        self.is_unborn = holds_at_last(unborn, axis.stop)
        if len(unborn):
            over = (axis.start <= attempts.stop) & (attempts.stop < axis.stop)
            attempts.void[over] |= holds_at(unborn, attempts.stop[over]) > 0


class _Piece:
    """The episodes in one piece.

    Args:
        axis: of the piece.
        may: where the trigger is not false.
        again: where an episode goes on after a failure.
        make: makes attempts.
        judging: judges them.
    """

    def __init__(
        self, axis: Axis, may: Toggles, again: Toggles, make: Make, judging: Judging
    ) -> None:
        self._axis = axis
        self._begins = may[0::2]
        self._stops = np.where(may[1::2] == axis.stop, FAR, may[1::2])
        self._may = may
        self._again = again
        self._make = make
        self._judging = judging
        goes_on = len(may) > 0 and may[0] == axis.start
        self.stop_of_old = self._stops.item(0) if goes_on else axis.start

    def judged(self, attempts: Attempts) -> Judged:
        """The same attempts, with what became of them."""
        return attempts, self._judging.judge(attempts)

    def starting(self, places: Numbers) -> Judged:
        """Attempts that start at places in episodes."""
        episode = np.searchsorted(self._begins, places, "right") - 1
        return self.judged(self._make(places, self._stops[episode]))

    def going_on(self, failed_at: Numbers, stop: Numbers) -> Numbers:
        """The places at which episodes that are over at `stop` go on after failures."""
        places = self._next(failed_at)
        return places[places < np.minimum(stop, self._axis.stop)]

    def _next(self, failed_at: Numbers) -> Numbers:
        return first_in(self._again, self._axis.first_from(failed_at + 1), self._axis.stop)

    def following(self, attempts: Attempts, outcome: Outcome) -> Numbers:
        """The places at which episodes go on, of those attempts that have failed."""
        failed = (outcome.decided < FAR) & ~outcome.passed
        if not failed.any():
            return np.empty(0, np.int64)
        return self.going_on(outcome.decided[failed], attempts.stop[failed])

    def follow(self, places: Numbers) -> list[Judged]:
        """The attempts that start at places in episodes, those that follow them, and so on."""
        parts: list[Judged] = []
        while len(places) and len(parts) < _ROUNDS:
            parts.append(self.starting(places))
            places = self.following(*parts[-1])
        if not len(places):
            return parts
        chains = _Chains(self)
        while len(places):
            linked = np.isin(places, chains.starts)
            part, behind = chains.chained(places[linked])
            parts.append(part)
            if not linked.all():
                parts.append(self.starting(places[~linked]))
                behind = np.concatenate((behind, self.following(*parts[-1])))
            places = behind
        return parts

    @property
    def entries(self) -> Numbers:
        """The places at which an episode can go on again after it could not."""
        made: Numbers = in_at_least(2, [self._may, self._again])[0::2]
        return made


class _Chains:
    """What follows what, worked out for all places at which episodes can go on at once.

    Where an attempt begins decides what becomes of it, whatever was before.

    Attributes:
        starts: the places, ascending.
    """

    def __init__(self, piece: _Piece) -> None:
        self.starts = piece.entries
        self._judged = attempts, outcome = piece.starting(self.starts)
        failed = np.flatnonzero((outcome.decided < FAR) & ~outcome.passed)
        following = piece._next(outcome.decided[failed])
        goes_on = following < np.minimum(attempts.stop[failed], piece._axis.stop)
        failed, following = failed[goes_on], following[goes_on]
        self._following = np.full(len(self.starts), -1)
        self._following[failed] = following
        link = np.searchsorted(self.starts, following)
        linked = np.append(self.starts, -1)[link] == following
        self._link = np.full(len(self.starts), -1)
        self._link[failed[linked]] = link[linked]

    def chained(self, places: Numbers) -> tuple[Judged, Numbers]:
        """The attempts from some of the places on, as long as they follow each other.

        Returns:
            They, and the places at which others follow the last ones.
        """
        links = self._link.tolist()
        chain, ends = [], []
        for index in np.searchsorted(self.starts, places).tolist():
            while index >= 0:
                chain.append(index)
                index = links[index]
            ends.append(chain[-1])
        attempts, outcome = self._judged
        own = np.array(chain, np.int64)
        behind = self._following[np.array(ends, np.int64)]
        return (attempts.pick(own), outcome.pick(own)), behind[behind >= 0]
