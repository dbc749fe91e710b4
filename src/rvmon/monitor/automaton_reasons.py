"""Explains attempts judged by an automaton: the reason and the details of their records."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from functools import cache

from msgspec import Struct

from rvmon.logic.automaton import FAILED, PASSED, Token, location_of
from rvmon.logic.progress import after, value
from rvmon.logic.residual import NO_CLOCK, Residual
from rvmon.logic.state_formula import UNKNOWN
from rvmon.monitor.cause import (
    AT_DECISION,
    Cause,
    CauseFinder,
    Moment,
    TruthValues,
    without_cause,
)
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.explanation import Alone, Explanation, Undecided
from rvmon.monitor.obligation_words import deadline, settled_alone
from rvmon.verdicts import Verdict


class Reasons:
    """Explains the decisions of one requirement.

    A cause depends only on the location, the age regions of its clocks, the letter and the verdict,
    so it is cached by them.
    """

    def __init__(self, compiled: CompiledRequirement) -> None:
        self.words = compiled.words
        self._alphabet = compiled.alphabet
        residuals = self._residuals = compiled.shaped_residuals
        self._cuts = cache(lambda location: location_of(residuals[location]).cuts)
        self._after_start = cache(lambda location: deadline(residuals[location], (0,)))
        self._causes: dict[tuple[int, ...], Cause | None] = {}

    def of(self, before: Token, letter: int, verdict: bool, t: int) -> Cause | None:
        """The cause of a decision at `t`, taken in state `before` with `letter`.

        `None` if no other decision was possible.
        """
        location, anchors = before
        ages = zip(self._cuts(location), anchors, strict=True)
        # Within one region no window opens or ends, so all its ages have the same cause.
        key = (location, letter, verdict, *[bisect_right(cuts, t - at) for cuts, at in ages])
        if key not in self._causes:
            self._causes[key] = self._find(before, letter, verdict, t)
        return self._causes[key]

    def _find(self, before: Token, letter: int, verdict: bool, t: int) -> Cause | None:
        residual = self._residuals[before[0]]
        ages = [t - anchor for anchor in before[1]]
        by_time = value(after(residual, ages)) != UNKNOWN
        valuation = self._alphabet.valuation(letter)
        return CauseFinder(valuation, ages, verdict=verdict, by_time=by_time).of(residual)

    def deadline(self, before: Token) -> int | None:
        """The last instant before time alone decides the residual; see `Attempt.deadline`."""
        location, anchors = before
        if len(anchors) != 1:
            return deadline(self._residuals[location], anchors)
        after_start = self._after_start(location)
        return None if after_start is None else anchors[0] + after_start


def explained(
    reasons: Reasons,
    before: Token,
    letter: int,
    verdict: bool,
    t: int,
    triggered: int,
    flow: TruthValues,
) -> Explanation:
    """Explain a decision at `t` (ticks); `before` and the letter are those of the deciding run."""
    cause = reasons.of(before, letter, verdict, t)
    if cause is None:
        return Explanation(without_cause(verdict))
    start = triggered
    if cause.start != NO_CLOCK:
        start = t if cause.start == AT_DECISION else before[1][cause.start]
    moment = Moment(t, start, triggered, flow)
    return Explanation(
        reasons.words.sentence(cause, verdict, moment),
        deadline=reasons.deadline(before),
        blame=None if verdict else reasons.words.blame(cause, moment),
    )


class MachineRuns(Struct, frozen=True):
    """The two runs of an automaton for one attempt, as `rvmon.monitor.explanation.Judged`."""

    residuals: Sequence[Residual]  # the residual of each location
    position: int  # the last position at which the runs were stepped
    gap: int | None  # ticks between two positions; `None` if only samples are positions

    def required(self, attempt: Undecided, now: int, *, optimistic: bool) -> str | None:
        """See `Judged`."""
        location, anchors = attempt.better if optimistic else attempt.worse
        if location <= PASSED:
            return None
        residual = after(self.residuals[location], [now // 2 - anchor for anchor in anchors])
        return attempt.compiled.words.required(residual, anchors, attempt.origin)

    def alone(self, attempt: Undecided) -> tuple[Alone, Alone]:
        """See `Judged`."""
        worse = self._alone(attempt.worse)
        return worse, worse if attempt.better == attempt.worse else self._alone(attempt.better)

    def _alone(self, token: Token) -> Alone:
        location, anchors = token
        return None if location <= PASSED else settled_alone(self.residuals[location], anchors)

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """See `Judged`; never folded into the verdict.

        `P` if the pessimistic run passes on every continuation, `F` if the optimistic one fails on
        every continuation.
        """
        known = (now - 1) // 2
        if self._value(attempt, attempt.worse, known) is True:
            return Verdict.PASS
        return Verdict.FAIL if self._value(attempt, attempt.better, known) is False else None

    def _value(self, attempt: Undecided, token: Token, known: int) -> bool | None:
        location, anchors = token
        if location <= PASSED:
            return location != FAILED
        # The core skips positions that change nothing: advance to the last one known.
        gap = self.gap or 1
        at = self.position + max(known - self.position, 0) // gap * gap
        ages = [at - anchor for anchor in anchors]
        residual = self.residuals[location]
        return attempt.compiled.forecaster.of(residual, ages, self.gap)
