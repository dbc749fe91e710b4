"""One requirement judged along a trace that is taken in pieces."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rvmon.automaton.location import Token
from rvmon.automaton.moves import Moves, moves_of
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, State
from rvmon.monitor.attempts.attempt_judge import Open
from rvmon.monitor.columns.attempts import Attempts, Tokens, joined_attempts, starting_attempts
from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.decided import DecidedAttempts, Decisions
from rvmon.monitor.columns.drive import Outcome
from rvmon.monitor.columns.episodes import Episodes
from rvmon.monitor.columns.judging import Judging
from rvmon.monitor.columns.leaves import NotByColumnsError, Truth
from rvmon.monitor.columns.row_letters import letters_along
from rvmon.monitor.columns.stretches import counted, first_in, holds_at, holds_at_last
from rvmon.monitor.columns.timeline import Piece, Timeline
from rvmon.monitor.columns.track import UNSEEN, Track
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.reasons.doubt import Doubt
from rvmon.monitor.records.deferred_reasons import DeferredReasons
from rvmon.monitor.records.ledger import Ledger
from rvmon.plan.outages import Outage
from rvmon.plan.plan import Plan
from rvmon.plan.stood import Stood
from rvmon.spec.checked.specification import Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rvmon.monitor.columns.stretches import Toggles

    Numbers = NDArray[np.int64]

OutagesAt = Callable[[int], Mapping[str, Outage]]
"""By name what was not known at an instant."""


class ColumnRule:
    """Starts the attempts of a requirement and drives them, a piece of the trace at a time.

    Attributes:
        id: of the requirement.
        is_determined: whether its trigger was ever true or false.
    """

    def __init__(
        self, compiled: CompiledRequirement, plan: Plan, ledger: Ledger, *, hidden: bool = False
    ) -> None:
        self.id = compiled.requirement.id
        self._compiled = compiled
        self._plan = plan
        self._ledger = ledger
        self._is_hidden = hidden
        self._deferred = DeferredReasons(compiled, plan, ledger)
        obligation, requirement = compiled.obligation, compiled.requirement
        self._trigger = self._node(obligation.trigger)
        self._again = self._node(obligation.again)
        self._unborn = self._node(obligation.unborn)
        self._determined = self._node(obligation.determined)
        self.is_determined = self._determined < 0
        self._episodes = Episodes() if requirement.mode is Mode.WHENEVER else None
        self._starts = Starts(requirement.pulse, hidden or self._episodes is not None)
        self._count, self._doubts = 0, 0
        self._open = _none()
        self._void: list[Attempts] = []
        self._tracks = [Track() for _ in self._deferred.places]
        self._letters = (0, 0)
        """Of the last place, if there are open attempts."""
        self._decided: list[Decisions] = []

    def _node(self, state: State | None) -> int:
        return -1 if state is None else self._plan.graph.index[state]

    @cached_property
    def _moves(self) -> Moves:
        automaton = self._compiled.automaton
        moves = None if automaton is None else moves_of(automaton, self._plan.gap)
        if moves is None:
            raise NotByColumnsError
        return moves

    @property
    def nodes(self) -> frozenset[int]:
        """The nodes of which it needs stretches."""
        asked = (self._trigger, self._again, self._unborn, self._determined, *self._deferred.places)
        return frozenset(place for place in asked if place >= 0)

    def take(self, piece: Piece, limit: int) -> None:
        """Judge a piece.

        Raises:
            NotByColumnsError: there are attempts in doubt that have to be judged one by one.
        """
        axis = piece.axis
        self.is_determined = self.is_determined or len(piece.truths[self._determined].must) > 0
        begun = self._starts.take(piece.truths[self._trigger], axis)
        truths = [piece.truths[place] for place in self._deferred.places]
        for track, truth in zip(self._tracks, truths, strict=True):
            track.take(truth, axis)
        waits = self._episodes is not None and self._episodes.failed_at is not None
        if not len(begun) and not len(self._open) and not waits:
            return
        starts, letters = letters_along(self._compiled.alphabet, truths, axis)
        judging = Judging(self._moves, self._deferred.leaves, piece, (starts, letters), limit)
        attempts, outcome = self._judged(piece, begun, judging)
        self._number(piece, attempts)
        self._note(piece, attempts, outcome, starts, letters)
        if axis.start < axis.stop:
            self._letters = (letters[0].item(-1), letters[1].item(-1))

    def _judged(self, piece: Piece, begun: Numbers, judging: Judging) -> tuple[Attempts, Outcome]:
        """The attempts that are open or start in a piece, and what becomes of them."""
        axis, truths = piece.axis, piece.truths

        def make(places: Numbers, stop: Numbers) -> Attempts:
            seen = piece.seen(self._deferred.leaves, places)
            return starting_attempts(self._moves.initial, places, stop, axis.instants(places), seen)

        if self._episodes is None:
            stop = np.full(len(begun), FAR)
        else:
            stop = _stops(truths[self._trigger].may, begun, axis.stop)
        attempts = make(begun, stop)
        if len(self._open):
            attempts = joined_attempts([self._open, attempts])
        if self._episodes is None:
            return attempts, judging.judge(attempts)
        own = truths[self._trigger], truths[self._again], truths.get(self._unborn)
        return self._episodes.take(attempts, make, judging, axis, own)

    def _number(self, piece: Piece, attempts: Attempts) -> None:
        """Number those that are new, and those of which it is known now that they are sure."""
        start = attempts.start
        if self._is_hidden:
            true_at = np.full(len(start), FAR)
        elif self._episodes is None:
            true_at = start
        else:
            must = piece.truths[self._trigger].must
            true_at = first_in(must, np.maximum(start, piece.axis.start), FAR)
        unsure = attempts.number == 0
        doubtful = np.flatnonzero(unsure & (attempts.doubtful == 0) & (true_at != start))
        attempts.doubtful[doubtful] = self._doubts + 1 + np.arange(len(doubtful))
        self._doubts += len(doubtful)
        sure = np.flatnonzero(unsure & (true_at < attempts.stop))
        attempts.number[sure] = self._count + 1 + np.arange(len(sure))
        self._count += len(sure)

    def _note(
        self,
        piece: Piece,
        attempts: Attempts,
        outcome: Outcome,
        starts: Numbers,
        letters: tuple[Numbers, Numbers],
    ) -> None:
        """Note what was decided, and keep the rest."""
        is_open = outcome.decided == FAR
        recorded = ~is_open & (attempts.number > 0) & ~(attempts.void & outcome.passed)
        void = ~is_open & attempts.void & outcome.passed
        if void.any():
            self._void.append(attempts.pick(void))
        if recorded.any():
            done = attempts.pick(recorded), outcome.pick(recorded)
            self._decided.append(self._decisions(piece, *done, starts, letters))
        if not is_open.all():
            attempts = attempts.pick(is_open)
        better = attempts.better
        if better is not None and not better.differ(attempts.worse).any():
            attempts.better = None
        self._open = attempts

    def _decisions(
        self,
        piece: Piece,
        attempts: Attempts,
        outcome: Outcome,
        starts: Numbers,
        letters: tuple[Numbers, Numbers],
    ) -> Decisions:
        places = outcome.place
        stretch = np.searchsorted(starts, places, "right")
        letter = np.append(self._letters[0], letters[0])[stretch]
        if letters[1] is not letters[0] or self._letters[0] != self._letters[1]:
            other = np.append(self._letters[1], letters[1])[stretch]
            letter = np.where(outcome.reading == 0, letter, other)
        failed = places[~outcome.passed]
        history = np.empty((len(failed), len(self._tracks), 4), np.int64)
        for index, track in enumerate(self._tracks):
            history[:, index] = track.at(failed)
        return Decisions(
            attempts.number,
            attempts.triggered,
            outcome.decided,
            outcome.passed,
            outcome.location,
            outcome.anchor,
            letter,
            attempts.seen,
            piece.seen(self._deferred.leaves, places),
            history,
        )

    def finish(self, timeline: Timeline, end: int, last: int, outages_at: OutagesAt) -> None:
        """Settle what is undecided."""
        if not len(self._open) and not self._void:
            return
        values = {leaf: timeline.value_here(leaf) for leaf in self._deferred.leaves}
        since, until = {}, {}
        for place, track in zip(self._deferred.places, self._tracks, strict=True):
            values[place], since[place], *ends = track.now
            for truth, instant in zip((FALSE, TRUE), ends, strict=True):
                until[3 * place + truth] = None if instant == UNSEEN else instant
            until[3 * place + UNKNOWN] = None
        flow = Stood(self._plan, values, since, until, outages_at(end), last)
        opened = self._opened(self._open, outages_at)
        judge = self._deferred.judge(flow, self._letters, last, opened)
        if opened and self._episodes is not None and self._open.stop[-1] == FAR:
            opened[-1].clouded = self._episodes.is_clouded
            opened[-1].void |= self._episodes.is_unborn
        for attempt in opened:
            self._ledger.ended(judge, attempt, end, end)
        for attempts in self._void:
            for attempt in self._opened(attempts, outages_at):
                self._ledger.say_nothing(judge, attempt)

    def _opened(self, attempts: Attempts, outages_at: OutagesAt) -> list[Open]:
        return [self._opened_one(attempts, index, outages_at) for index in range(len(attempts))]

    def _opened_one(self, attempts: Attempts, index: int, outages_at: OutagesAt) -> Open:
        seen = self._deferred.unpacked(attempts.seen.item(index))
        made = Open(attempts.triggered.item(index), self._token(attempts.worse, index), seen)
        made.number = attempts.number.item(index)
        made.doubtful_number = attempts.doubtful.item(index)
        made.sure = made.number > 0
        made.void = attempts.void.item(index)
        if attempts.better is not None:
            better = self._token(attempts.better, index)
            made.better = None if better == made.token else better
        if self._is_hidden:
            made.doubt = self._doubt(made.triggered, seen, outages_at)
        elif made.better is not None:
            noticed = self._deferred.unpacked(attempts.doubt_seen.item(index))
            made.doubt = self._doubt(attempts.doubted.item(index), noticed, outages_at)
        return made

    def _doubt(self, instant: int, seen: tuple[int, ...], outages_at: OutagesAt) -> Doubt:
        values = dict(zip(self._deferred.leaves, seen, strict=True))
        flow = Stood(self._plan, values, {}, {}, outages_at(instant), instant)
        return self._deferred.judge(flow, (0, 0), instant, []).doubt

    def _token(self, tokens: Tokens, index: int) -> Token:
        location = tokens.location.item(index)
        return location, (tokens.anchor.item(index),) if self._moves.clocked[location] else ()

    def decided(self) -> DecidedAttempts:
        """What was decided before the end, by number."""
        none = np.empty(0, np.int64)
        empty = Decisions(none, none, none, none > 0, none, none, none, none, none, none)
        made = Decisions.joined(self._decided or [empty])
        return DecidedAttempts(self._deferred, self._moves.clocked, made)


def _none() -> Attempts:
    none = np.empty(0, np.int64)
    return starting_attempts(0, none, none, none, none)


def _stops(may: Numbers, begun: Numbers, stop: int) -> Numbers:
    """Where the episodes that begin at places are over; `FAR` if that is behind the piece."""
    ends = may[1::2][np.searchsorted(may[0::2], begun)]
    return np.where(ends == stop, FAR, ends)


class Starts:
    """Follows a trigger from piece to piece; `rvmon.runtime.starts.Starts` for whole stretches.

    Args:
        pulse: whether it starts an attempt at every position where it holds.
        episodic: whether one starts where it is no longer false, and runs until it is again.
    """

    def __init__(self, pulse: bool, episodic: bool) -> None:
        self._pulse = pulse
        self._episodic = episodic
        self._may = False
        """Whether it was not false at the last place so far."""

    def take(self, trigger: Truth, axis: Axis) -> Toggles:
        """The places of a piece at which attempts start."""
        if axis.start == axis.stop:
            return np.empty(0, np.int64)
        before, self._may = self._may, holds_at_last(trigger.may, axis.stop)
        if self._pulse and not self._episodic:
            firsts = trigger.must[0::2]
            return counted(firsts, trigger.must[1::2] - firsts)
        begins: Toggles = trigger.may[0::2]
        if before and len(begins) and begins[0] == axis.start:
            begins = begins[1:]
        if self._episodic or trigger.known:
            return begins
        return begins[holds_at(trigger.must, begins) > 0]
