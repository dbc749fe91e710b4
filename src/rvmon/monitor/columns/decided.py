"""Decided attempts of one requirement in columns: an object is made of one when someone looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rvmon.automaton.location import Token
from rvmon.formula.state import UNKNOWN
from rvmon.monitor.columns.tables import Table
from rvmon.monitor.columns.track import UNSEEN
from rvmon.monitor.explained.findings import Finding, Reasons
from rvmon.monitor.records.deferred_reasons import DeferredReasons
from rvmon.verdict.attempt import Attempt, decided_attempt
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Decisions(Table):
    """What was noted of decided attempts of one requirement; all arrays have an entry for each.

    Attributes:
        number: of the attempt.
        triggered: the instant of its trigger, ticks.
        decided: the instant of the decision, ticks.
        passed: the verdict.
        location: of the automaton before the decision.
        anchor: of its clock.
        letter: that decided, or in which time did.
        seen_then: what was read at the trigger, packed.
        seen: what was read at the decision, packed.
        history: for each that failed, in order, and each proposition, its `Track.now`.
    """

    number: NDArray[np.int64]
    triggered: NDArray[np.int64]
    decided: NDArray[np.int64]
    passed: NDArray[np.bool_]
    location: NDArray[np.int64]
    anchor: NDArray[np.int64]
    letter: NDArray[np.int64]
    seen_then: NDArray[np.int64]
    seen: NDArray[np.int64]
    history: NDArray[np.int64]


class DecidedAttempts(Sequence[Attempt]):
    """The decided attempts of one requirement, by number.

    Attributes:
        decisions: what was noted of each.
        id: of the requirement.
    """

    def __init__(
        self, deferred: DeferredReasons, clocked: Sequence[bool], decisions: Decisions
    ) -> None:
        self.decisions = decisions
        self._deferred = deferred
        self._clocked = clocked
        self._failed = np.cumsum(~decisions.passed) - 1
        self.id = deferred.compiled.requirement.id

    @property
    def reasons(self) -> Reasons:
        """Of the requirement's decisions."""
        return self._deferred.reasons

    def __len__(self) -> int:
        return len(self.decisions.number)

    @overload
    def __getitem__(self, index: int) -> Attempt: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Attempt]: ...
    def __getitem__(self, index: int | slice) -> Attempt | Sequence[Attempt]:
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        decisions = self.decisions
        passed = bool(decisions.passed[index])
        return decided_attempt(
            self.id,
            decisions.number.item(index),
            decisions.triggered.item(index),
            decisions.decided.item(index),
            Verdict.PASS if passed else Verdict.FAIL,
            self._deferred.details,
            self._noted(index, passed=passed),
        )

    def finding(self, index: int) -> Finding:
        """What is reported of one of them."""
        decisions = self.decisions
        return self.reasons.of(
            self._before(index),
            decisions.letter.item(index),
            bool(decisions.passed[index]),
            decisions.decided.item(index),
        )

    def _before(self, index: int) -> Token:
        location = self.decisions.location.item(index)
        return location, (self.decisions.anchor.item(index),) if self._clocked[location] else ()

    def _noted(self, index: int, *, passed: bool) -> tuple[Any, ...]:
        """What `DeferredReasons.details` reads."""
        decisions, deferred = self.decisions, self._deferred
        t = decisions.decided.item(index)
        letter = decisions.letter.item(index)
        count = len(deferred.places)
        values, since, until = [UNKNOWN] * count, [t] * count, [None] * (2 * count)
        if not passed:
            rows = decisions.history[self._failed.item(index)].tolist()
            values = [row[0] for row in rows]
            since = [row[1] for row in rows]
            until = [None if t == UNSEEN else t for row in rows for t in row[2:]]
        return (
            decisions.seen_then.item(index),
            t,
            self._before(index),
            letter,
            letter,
            t - 1,
            *deferred.unpacked(decisions.seen.item(index)),
            *values,
            *since,
            *until,
        )
