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

NOWHERE = -FAR
"""No place: those of instants may be negative."""

_ROUNDS = 2
"""So many failures of an episode are followed one by one."""

_MOST_GUESSES = 1 << 12
"""So many attempts of an episode are tried together, if each begins as long after the last."""


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
                failure; of what shows that something is not born.

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
        behind = piece.following(*parts[0])
        places = behind[behind != NOWHERE]
        if self.failed_at is not None:
            waiting = piece.going_on(np.array([self.failed_at]), np.array([piece.stop_of_old]))
            places = np.append(waiting[waiting != NOWHERE], places)
            if waiting[0] != NOWHERE or piece.stop_of_old < FAR:
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
    """The episodes in one piece."""

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
        return self.judged(self._make(places, self._stops[self._episode(places)]))

    def _episode(self, places: Numbers) -> Numbers:
        found: Numbers = np.searchsorted(self._begins, places, "right") - 1
        return found

    def going_on(self, failed_at: Numbers, stop: Numbers) -> Numbers:
        """Where episodes that are over at `stop` go on after failures, or `NOWHERE`."""
        end = self._axis.stop
        places = first_in(self._again, self._axis.first_from(failed_at + 1), end)
        return np.where(places < np.minimum(stop, end), places, NOWHERE)

    def following(self, attempts: Attempts, outcome: Outcome) -> Numbers:
        """For each attempt the place of the one that follows it; `NOWHERE` if none does."""
        behind = np.full(len(attempts), NOWHERE)
        failed = np.flatnonzero((outcome.decided < FAR) & ~outcome.passed)
        if len(failed):
            behind[failed] = self.going_on(outcome.decided[failed], attempts.stop[failed])
        return behind

    def follow(self, places: Numbers) -> list[Judged]:
        """The attempts that start at places in episodes, those that follow them, and so on."""
        parts: list[Judged] = []
        steps = places
        while len(places) and len(parts) < _ROUNDS:
            parts.append(self.starting(places))
            behind = self.following(*parts[-1])
            own = behind != NOWHERE
            places, steps = behind[own], (behind - places)[own]
        if not len(places):
            return parts
        entries = _Chains(self, in_at_least(2, [self._may, self._again])[0::2])
        count = 1
        while len(places):
            linked = entries.has(places)
            found = [entries.chained(places[linked])]
            if not linked.all():
                guesses = self._guesses(places[~linked], steps[~linked], count)
                tried = _Chains(self, guesses).chained(places[~linked])
                regular = np.array_equal(tried[2], steps[~linked])
                all_right = regular and len(tried[0][0]) == len(guesses)
                count = min(2 * count, _MOST_GUESSES) if all_right else 1
                found.append(tried)
            parts += [part for part, _, _ in found]
            places = np.concatenate([behind for _, behind, _ in found])
            steps = np.concatenate([own for _, _, own in found])
        return parts

    def _guesses(self, places: Numbers, steps: Numbers, count: int) -> Numbers:
        """Where attempts begin if each follows as far behind another as that did."""
        stops = np.minimum(self._stops[self._episode(places)], self._axis.stop)
        grid = places[:, None] + steps[:, None] * np.arange(count)
        return np.sort(grid[grid < stops[:, None]])


class _Chains:
    """What follows what, worked out for many places at once at which episodes may go on.

    Where an attempt begins decides what becomes of it, whatever was before.
    """

    def __init__(self, piece: _Piece, starts: Numbers) -> None:
        self._starts = starts
        self._judged = piece.starting(starts)
        self._behind = piece.following(*self._judged)
        link = np.searchsorted(starts, self._behind)
        self._link = np.where(self.has(self._behind), link, -1).tolist()

    def has(self, places: Numbers) -> NDArray[np.bool_]:
        """Which places are among those."""
        made: NDArray[np.bool_] = (
            np.append(self._starts, FAR)[np.searchsorted(self._starts, places)] == places
        )
        return made

    def chained(self, places: Numbers) -> tuple[Judged, Numbers, Numbers]:
        """The attempts from some of the places on, as long as they follow each other.

        Returns:
            They, the places at which others follow the last ones, and how far behind them.
        """
        chain, ends = [], []
        for index in np.searchsorted(self._starts, places).tolist():
            while index >= 0:
                chain.append(index)
                index = self._link[index]
            ends.append(chain[-1])
        own, last = np.array(chain, np.int64), np.array(ends, np.int64)
        last = last[self._behind[last] != NOWHERE]
        behind = self._behind[last]
        attempts, outcome = self._judged
        return (attempts.pick(own), outcome.pick(own)), behind, behind - self._starts[last]
