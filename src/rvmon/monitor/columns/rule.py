"""One requirement judged along a trace that is taken in pieces."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from rvmon.automaton.location import FAILED, PASSED
from rvmon.automaton.machine import Token
from rvmon.codegen.plan import Plan
from rvmon.dataflow.outages import Outage
from rvmon.formula.state import FALSE, TRUE, UNKNOWN
from rvmon.monitor.bench import Open
from rvmon.monitor.columns.axis import FAR
from rvmon.monitor.columns.decided import DecidedAttempts, Decisions
from rvmon.monitor.columns.drive import (
    Driver,
    Outcome,
    Tokens,
    joined_tokens,
    starting,
)
from rvmon.monitor.columns.letters import Letters, letters_along
from rvmon.monitor.columns.moves import Moves, joint_moves
from rvmon.monitor.columns.starts import Starts
from rvmon.monitor.columns.timeline import Piece, Timeline
from rvmon.monitor.columns.track import UNSEEN, Track
from rvmon.monitor.compiled import CompiledRequirement
from rvmon.monitor.ledger import Ledger
from rvmon.monitor.witness import Stood, Witness
from rvmon.spec.checked import Mode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]

OutagesAt = Callable[[int], Mapping[str, Outage]]
"""By name what was not known at an instant."""


class ColumnRule:
    """Starts the attempts of a requirement and drives them, a piece of the trace at a time.

    Args:
        compiled: the requirement.
        plan: that it is part of.
        moves: its automaton.
        ledger: takes the records of what the end settles.
    """

    def __init__(
        self, compiled: CompiledRequirement, plan: Plan, moves: Moves, ledger: Ledger
    ) -> None:
        self.id = compiled.requirement.id
        self._compiled = compiled
        self._plan = plan
        self._moves = moves
        self._ledger = ledger
        self._witness = Witness(compiled, plan, ledger)
        trigger = compiled.obligation.trigger
        self._trigger = -1 if trigger is None else plan.graph.index[trigger]
        requirement = compiled.requirement
        self._starts = Starts(requirement.pulse, requirement.mode is Mode.WHENEVER)
        self._count = 0
        none = np.empty(0, np.int64)
        self._number, self._triggered, self._seen = none, none, none
        self._doubted, self._doubt_seen = none, none
        """Since when unknown input makes a difference, `FAR` if it does not, and what was seen."""
        self._worse = starting(moves, none)
        self._better: Tokens | None = None
        self._tracks = [Track() for _ in self._witness.places]
        self._letters = (0, 0)
        """Of the last place."""
        self._decided: list[Decisions] = []

    @property
    def nodes(self) -> frozenset[int]:
        """The nodes of which it needs stretches."""
        return frozenset((self._trigger, *self._witness.places))

    def take(self, piece: Piece, limit: int) -> None:
        """Judge a piece.

        Args:
            piece: of the trace.
            limit: the instant that time comes to.
        """
        axis = piece.axis
        begun = self._starts.take(piece.truths[self._trigger], axis)
        self._add(begun, axis.instants(begun), piece.seen(self._witness.leaves, begun))
        truths = [piece.truths[place] for place in self._witness.places]
        starts, letters = letters_along(self._compiled.alphabet, truths, axis)
        for track, truth in zip(self._tracks, truths, strict=True):
            track.take(truth, axis)
        known = letters[0] is letters[1]
        if not known:
            self._doubt(piece, starts, letters)
        before = None if known else self._one_run()
        outcome, reading = self._driven(piece, starts, letters, limit)
        if before is not None:
            together, tokens = before
            still = outcome.decided[together] == FAR
            self._note_parted(piece, together[still], tokens.pick(still), starts, letters, limit)
        self._note(piece, outcome, starts, letters, reading)
        if axis.start < axis.stop:
            self._letters = (letters[0].item(-1), letters[1].item(-1))

    def _add(self, begun: Numbers, triggered: Numbers, seen: Numbers) -> None:
        if not len(begun):
            return
        fresh = starting(self._moves, begun)
        numbers = np.arange(self._count + 1, self._count + 1 + len(begun))
        self._count += len(begun)
        self._number = np.concatenate((self._number, numbers))
        self._triggered = np.concatenate((self._triggered, triggered))
        self._seen = np.concatenate((self._seen, seen))
        self._doubted = np.concatenate((self._doubted, np.full(len(begun), FAR)))
        self._doubt_seen = np.concatenate((self._doubt_seen, seen))
        self._worse = joined_tokens(self._worse, fresh)
        if self._better is not None:
            self._better = joined_tokens(self._better, fresh)

    def _doubt(self, piece: Piece, starts: Numbers, letters: tuple[Numbers, Numbers]) -> None:
        """Note where both readings of the letters part for the first time in an attempt."""
        classes = self._moves.class_of
        apart = np.flatnonzero(classes[letters[0]] != classes[letters[1]])
        none = np.flatnonzero(self._doubted == FAR)
        if not len(apart) or not len(none):
            return
        stops = np.append(starts, piece.axis.stop)[apart + 1]
        following = self._worse.place[none] + 1
        found = np.searchsorted(stops, following, "right")
        none, following, found = (one[found < len(apart)] for one in (none, following, found))
        places = np.maximum(starts[apart[found]], following)
        self._doubted[none] = piece.axis.instants(places)
        self._doubt_seen[none] = piece.seen(self._witness.leaves, places)

    def _one_run(self) -> tuple[Numbers, Tokens]:
        """The attempts of which both runs are at one place, and where."""
        worse, better = self._worse, self._better
        together = (
            np.arange(len(worse)) if better is None else np.flatnonzero(~worse.differ(better))
        )
        return together, worse.pick(together)

    def _note_parted(
        self,
        piece: Piece,
        together: Numbers,
        tokens: Tokens,
        starts: Numbers,
        letters: tuple[Numbers, Numbers],
        limit: int,
    ) -> None:
        """Note of open attempts of which the runs parted in the piece where they first did.

        Args:
            piece: of the trace.
            together: the attempts whose runs were at one place before it.
            tokens: their place.
            starts: of the stretches of one letter.
            letters: of the stretches, in both readings.
            limit: the instant that time has come to.
        """
        if self._better is None:
            return
        parted = self._worse.differ(self._better)[together]
        if not parted.any():
            return
        together, tokens = together[parted], tokens.pick(parted)
        following = tokens.place + 1
        classes, count = self._moves.class_of, self._moves.targets.shape[1]
        pairs, joint = np.unique(
            classes[letters[0]] * count + classes[letters[1]], return_inverse=True
        )
        moves = joint_moves(self._moves, *np.divmod(pairs, count))
        made = Letters(moves, starts, joint, piece.axis.stop)
        came = Driver(moves, made, piece.axis, limit).drive(tokens)
        stretch = np.searchsorted(starts, came.place, "right") - 1
        places = np.maximum(starts[stretch], following)
        self._doubted[together] = piece.axis.instants(places)
        self._doubt_seen[together] = piece.seen(self._witness.leaves, places)

    def _driven(
        self, piece: Piece, starts: Numbers, letters: tuple[Numbers, Numbers], limit: int
    ) -> tuple[Outcome, Numbers]:
        """The outcome of all open attempts, and by which reading each one was decided."""
        axis, moves = piece.axis, self._moves

        def driven(reading: int, tokens: Tokens) -> Outcome:
            made = Letters(moves, starts, letters[reading], axis.stop)
            return Driver(moves, made, axis, limit).drive(tokens)

        if self._better is None and letters[0] is letters[1]:
            worse = driven(0, self._worse)
            return worse, np.zeros(len(worse.decided), np.int64)
        if self._better is None:
            self._better = self._worse.copy()
        worse, better = driven(0, self._worse), driven(1, self._better)
        passed = (worse.decided < FAR) & worse.passed
        failed = (better.decided < FAR) & ~better.passed
        # What one reading alone has decided waits for the other.
        self._worse.location[(worse.decided < FAR) & ~passed] = FAILED
        self._better.location[(better.decided < FAR) & ~failed] = PASSED
        made = Outcome(
            np.where(passed, worse.decided, np.where(failed, better.decided, FAR)),
            passed,
            np.where(failed, better.location, worse.location),
            np.where(failed, better.anchor, worse.anchor),
            np.where(failed, better.place, worse.place),
        )
        return made, failed.astype(np.int64)

    def _note(
        self,
        piece: Piece,
        outcome: Outcome,
        starts: Numbers,
        letters: tuple[Numbers, Numbers],
        reading: Numbers,
    ) -> None:
        """Note what was decided, and keep the rest."""
        done = np.flatnonzero(outcome.decided < FAR)
        if not len(done):
            return
        places, passed = outcome.place[done], outcome.passed[done]
        stretch = np.searchsorted(starts, places, "right")
        letter = np.append(self._letters[0], letters[0])[stretch]
        if letters[1] is not letters[0] or self._letters[0] != self._letters[1]:
            other = np.append(self._letters[1], letters[1])[stretch]
            letter = np.where(reading[done] == 0, letter, other)
        failed = places[~passed]
        history = np.empty((len(failed), len(self._tracks), 4), np.int64)
        for index, track in enumerate(self._tracks):
            history[:, index] = track.at(failed)
        self._decided.append(
            Decisions(
                self._number[done],
                self._triggered[done],
                outcome.decided[done],
                passed,
                outcome.location[done],
                outcome.anchor[done],
                letter,
                self._seen[done],
                piece.seen(self._witness.leaves, places),
                history,
            )
        )
        self._keep(outcome.decided == FAR)

    def _keep(self, which: NDArray[np.bool_]) -> None:
        self._number, self._triggered = self._number[which], self._triggered[which]
        self._seen = self._seen[which]
        self._doubted, self._doubt_seen = self._doubted[which], self._doubt_seen[which]
        self._worse = self._worse.pick(which)
        if self._better is not None:
            self._better = self._better.pick(which)
            if not self._better.differ(self._worse).any():
                self._better = None

    def finish(self, timeline: Timeline, end: int, last: int, outages_at: OutagesAt) -> None:
        """Settle what is undecided.

        Args:
            timeline: has come to the end.
            end: the last instant of the trace.
            last: the last position.
            outages_at: gives by name what was not known at an instant.
        """
        values = {leaf: timeline.value_here(leaf) for leaf in self._witness.leaves}
        since, until = {}, {}
        for place, track in zip(self._witness.places, self._tracks, strict=True):
            values[place], since[place], *ends = track.now
            for truth, instant in zip((FALSE, TRUE), ends, strict=True):
                until[3 * place + truth] = None if instant == UNSEEN else instant
            until[3 * place + UNKNOWN] = None
        flow = Stood(self._plan, values, since, until, {})
        flow.origin, flow.position = timeline.origin, last
        opened = [self._opened(index, outages_at) for index in range(len(self._number))]
        judge = self._witness.judge(flow, self._letters, last, opened)
        for attempt in opened:
            self._ledger.ended(judge, attempt, end, end)

    def _opened(self, index: int, outages_at: OutagesAt) -> Open:
        leaves = self._witness.leaves
        seen = self._witness.unpacked(self._seen.item(index))
        made = Open(self._triggered.item(index), self._token(self._worse, index), seen)
        made.number = self._number.item(index)
        if self._better is not None:
            better = self._token(self._better, index)
            made.better = None if better == made.token else better
        instant = self._doubted.item(index)
        if instant < FAR:
            values = dict(
                zip(leaves, self._witness.unpacked(self._doubt_seen.item(index)), strict=True)
            )
            flow = Stood(self._plan, values, {}, {}, outages_at(instant))
            made.doubt = self._witness.judge(flow, (0, 0), instant, [])._doubt()
        return made

    def _token(self, tokens: Tokens, index: int) -> Token:
        location = tokens.location.item(index)
        return location, (tokens.anchor.item(index),) if self._moves.clocked[location] else ()

    def decided(self) -> DecidedAttempts:
        """What was decided before the end, by number."""
        parts = self._decided
        if not parts:
            none = np.empty(0, np.int64)
            made = Decisions(none, none, none, none > 0, none, none, none, none, none, none)
        else:
            made = Decisions(
                *[
                    np.concatenate([getattr(part, one.name) for part in parts])
                    for one in fields(Decisions)
                ]
            )
        return DecidedAttempts(self._witness, self._moves.clocked, made)
