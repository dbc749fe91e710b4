"""Explains attempts judged by an automaton: the sentence and the details of their records."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from msgspec import Struct

from rvmon.logic.automaton import FAILED, PASSED, Token, location_of
from rvmon.logic.progress import after, value
from rvmon.logic.residual import NO_CLOCK, Residual
from rvmon.logic.state_formula import UNKNOWN
from rvmon.monitor.cause import Cause, CauseFinder, Sentence, TruthValues, rendered
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.explanation import Alone, Explanation, Undecided
from rvmon.monitor.obligation_words import deadline, settled_alone
from rvmon.verdicts import Verdict


class Finding(Struct, frozen=True):
    """The explanation shared by decisions that differ only in instants.

    `cause` is `None` if no other decision was possible.
    """

    cause: Cause | None
    sentence: Sentence

    def start(self, anchors: Sequence[int], t: int, triggered: int) -> int:
        """The instant at which the deciding obligation was instantiated, ticks."""
        clock = self.cause.start if self.cause else NO_CLOCK
        if clock == NO_CLOCK:
            return triggered
        return anchors[clock] if clock > NO_CLOCK else t


class Reasons:
    """Explains the decisions of one requirement.

    An explanation depends only on the location, the age regions of its clocks, the letter and the
    verdict; it is cached by these.
    """

    def __init__(self, compiled: CompiledRequirement) -> None:
        self.words = compiled.words
        self._alphabet = compiled.alphabet
        self._residuals = compiled.shaped_residuals
        self._cuts: dict[int, tuple[tuple[int, ...], ...]] = {}
        self._found: dict[tuple[int, ...], Finding] = {}
        self._deadlines: dict[int, int | None] = {}

    def cuts(self, location: int) -> tuple[tuple[int, ...], ...]:
        """For each clock of a location, the ages (ticks) at which a window opens or is over."""
        cuts = self._cuts.get(location)
        if cuts is None:
            cuts = self._cuts[location] = location_of(self._residuals[location]).cuts
        return cuts

    def of(self, before: Token, letter: int, verdict: bool, t: int) -> Finding:
        """The finding for a decision at `t`, taken in state `before` with `letter`."""
        location, anchors = before
        ages = zip(self.cuts(location), anchors, strict=True)
        # In one region no window opens or is over, so ages within it have the same cause.
        key = (location, letter, verdict, *[bisect_right(cuts, t - at) for cuts, at in ages])
        finding = self._found.get(key)
        if finding is None:
            finding = self._found[key] = self._find(before, letter, verdict, t)
        return finding

    def _find(self, before: Token, letter: int, verdict: bool, t: int) -> Finding:
        residual = self._residuals[before[0]]
        ages = [t - anchor for anchor in before[1]]
        by_time = value(after(residual, ages)) != UNKNOWN
        valuation = self._alphabet.valuation(letter)
        cause = CauseFinder(valuation, ages, verdict=verdict, by_time=by_time).of(residual)
        if cause is None:
            return Finding(None, ("there was no obligation" if verdict else "it can never hold",))
        return Finding(cause, self.words.sentence(cause, verdict))

    def deadline(self, before: Token) -> int | None:
        """The last instant before time alone decides the residual; see `Attempt.deadline`."""
        location, anchors = before
        if len(anchors) != 1:
            return deadline(self._residuals[location], anchors)
        if location not in self._deadlines:
            self._deadlines[location] = deadline(self._residuals[location], (0,))
        after_start = self._deadlines[location]
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
    finding = reasons.of(before, letter, verdict, t)
    cause = finding.cause
    start = finding.start(before[1], t, triggered)
    return Explanation(
        rendered(finding.sentence, t, start, triggered, flow),
        deadline=None if cause is None else reasons.deadline(before),
        blame=None if verdict or cause is None else reasons.words.blame(cause, t, start, flow),
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

        `P` if the pessimistic run passes on every continuation, `F` if the optimistic one fails.
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
