"""Attempts driven through a piece of a trace, all at once.

Nothing is looked at where nothing happens: each attempt goes from one place at which the letters
lead it on, or its clock enters another region, to the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rvmon.automaton.ages import NEVER
from rvmon.automaton.location import PASSED
from rvmon.automaton.moves import Moves
from rvmon.formula.state import TRUE, UNKNOWN
from rvmon.monitor.columns.attempts import Tokens
from rvmon.monitor.columns.axis import FAR, Axis
from rvmon.monitor.columns.row_letters import Letters
from rvmon.monitor.columns.tables import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


@dataclass(slots=True, eq=False)
class Outcome(Table):
    """What became of attempts in a piece; all arrays have an entry per attempt.

    Attributes:
        decided: the instant; `FAR` where it is open.
        passed: the verdict.
        location: before the decision.
        anchor: before the decision.
        place: the position, of which the letter was, at or before the decision.
        reading: of the letters, by which it was decided: 0 for the worse, 1 for the better.
    """

    decided: Numbers
    passed: NDArray[np.bool_]
    location: Numbers
    anchor: Numbers
    place: Numbers
    reading: Numbers


_FEW = 12
"""So many attempts are driven faster one by one."""


class Driver:
    """Drives the attempts of one reading through a piece."""

    def __init__(self, moves: Moves, letters: Letters, axis: Axis, limit: int) -> None:
        self._moves = moves
        self._letters = letters
        self._axis = axis
        self._limit = limit

    def drive(self, tokens: Tokens) -> Outcome:
        """Drive attempts to the end of the piece; those that are not decided are moved on.

        Attempts in `FAILED` or `PASSED` stay there.
        """
        count = len(tokens)
        self._outcome = Outcome(
            np.full(count, FAR),
            np.zeros(count, bool),
            tokens.location.copy(),
            tokens.anchor.copy(),
            tokens.place.copy(),
            np.zeros(count, np.int64),
        )
        active = np.flatnonzero(tokens.location > PASSED)
        now = tokens.pick(active)
        while len(active) > _FEW:
            leads, stretch = self._letters.next_leading(
                self._moves.bases[now.location] + now.region, now.place + 1
            )
            cut = self._moves.cuts[now.location, now.region]
            border = np.where(cut == NEVER, FAR, now.anchor + cut)
            crosses = (border <= self._axis.instants(leads)) & (border <= self._limit)
            steps = ~crosses & (leads < self._axis.stop)
            rests = ~(crosses | steps)
            if rests.any():
                now.place[rests] = self._axis.stop - 1
                tokens.put(active[rests], now.pick(rests))
            parts = []
            if crosses.any():
                parts.append(self._cross(active[crosses], now.pick(crosses), border[crosses]))
            if steps.any():
                parts.append(
                    self._step(active[steps], now.pick(steps), leads[steps], stretch[steps])
                )
            if not parts:
                return self._outcome
            active = np.concatenate([numbers for numbers, _ in parts])
            now = parts[0][1] if len(parts) == 1 else Tokens.joined([parts[0][1], parts[1][1]])
        for index, number in enumerate(active.tolist()):
            self._drive_one(number, now, index, tokens)
        return self._outcome

    def _cross(self, numbers: Numbers, now: Tokens, border: Numbers) -> tuple[Numbers, Tokens]:
        """Let clocks enter the next region; where no position is, time alone may decide."""
        at = self._axis.first_from(border)
        now.region += 1
        now.place = at - 1
        truth = self._moves.time_values[self._moves.bases[now.location] + now.region]
        by_time = (truth != UNKNOWN) & (self._axis.instants(at) != border)
        self._decide(numbers[by_time], now.pick(by_time), border[by_time], truth[by_time] == TRUE)
        return numbers[~by_time], now.pick(~by_time)

    def _step(
        self, numbers: Numbers, now: Tokens, leads: Numbers, stretch: Numbers
    ) -> tuple[Numbers, Tokens]:
        """Take a step at the places that lead on."""
        moves = self._moves
        kind = self._letters.classes[stretch]
        row = moves.bases[now.location] + now.region
        target, restarts = moves.targets[row, kind], moves.restarts[row, kind]
        instants = self._axis.instants(leads)
        now.place = leads
        done = target <= PASSED
        self._decide(numbers[done], now.pick(done), instants[done], target[done] == PASSED)
        slides = restarts & (target == now.location)
        now.location = target
        now.anchor = np.where(restarts, instants, now.anchor)
        ages = instants - now.anchor
        now.region = (moves.cuts[target] <= ages[:, None]).sum(1)
        if slides.any():
            self._slide(now, slides)
        return numbers[~done], now.pick(~done)

    def _slide(self, now: Tokens, which: NDArray[np.bool_]) -> None:
        """Move clocks along as far as the letters only start them again at every tick."""
        location = now.location[which]
        row = self._moves.bases[location] + (self._moves.cuts[location] <= 1).sum(1)
        behind, _ = self._letters.next_leading(row, now.place[which] + 1, sliding=True)
        now.place[which] = now.anchor[which] = behind - 1

    def _drive_one(self, number: int, now: Tokens, index: int, tokens: Tokens) -> None:
        """As `drive` does, for one attempt: arrays of a few entries cost more than they save."""
        moves, letters, axis = self._moves, self._letters, self._axis
        location, anchor = int(now.location[index]), int(now.anchor[index])
        region, place = int(now.region[index]), int(now.place[index])
        while True:
            row = moves.bases.item(location) + region
            leads, stretch = letters.next_for_one(row, place + 1)
            cut = moves.cuts.item(location, region)
            border = FAR if cut == NEVER else anchor + cut
            if border <= axis.instant(leads) and border <= self._limit:
                at = axis.place_from(border)
                region, place = region + 1, at - 1
                truth = moves.time_values.item(row + 1)
                if truth == UNKNOWN or axis.instant(at) == border:
                    continue
                instant, passed = border, truth == TRUE
                break
            if leads >= axis.stop:
                tokens.location[number], tokens.anchor[number] = location, anchor
                tokens.region[number], tokens.place[number] = region, axis.stop - 1
                return
            kind = letters.classes.item(stretch)
            target, restarts = moves.targets.item(row, kind), moves.restarts.item(row, kind)
            instant, place = axis.instant(leads), leads
            if target <= PASSED:
                passed = target == PASSED
                break
            slides = restarts and target == location
            location, anchor = target, instant if restarts else anchor
            region = int((moves.cuts[location] <= instant - anchor).sum()) if not restarts else 0
            if slides:
                row = moves.bases.item(location) + int((moves.cuts[location] <= 1).sum())
                place = anchor = letters.next_for_one(row, place + 1, sliding=True)[0] - 1
        outcome = self._outcome
        outcome.decided[number], outcome.passed[number] = instant, passed
        outcome.location[number], outcome.anchor[number] = location, anchor
        outcome.place[number] = place

    def _decide(
        self, numbers: Numbers, now: Tokens, instants: Numbers, passed: NDArray[np.bool_]
    ) -> None:
        outcome = self._outcome
        outcome.decided[numbers] = instants
        outcome.passed[numbers] = passed
        outcome.location[numbers] = now.location
        outcome.anchor[numbers] = now.anchor
        outcome.place[numbers] = now.place
