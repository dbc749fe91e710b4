"""The sentences and details of a record that the run of an automaton decided, or has open."""

from __future__ import annotations

from dataclasses import dataclass

from rvmon.automaton.location import FAILED, PASSED, Token
from rvmon.formula.progress import after
from rvmon.monitor.explained.explanation import (
    Explanation,
    earlier,
    longer,
    still_owed,
    unborn,
)
from rvmon.monitor.explained.findings import Reasons, Residuals
from rvmon.monitor.explained.undecided import Undecided
from rvmon.monitor.reasons.obligation_words import settled_alone
from rvmon.monitor.reasons.sentence import Standing, rendered
from rvmon.verdict.verdict import Verdict


def explained(
    reasons: Reasons,
    before: Token,
    letter: int,
    verdict: bool,
    t: int,
    triggered: int,
    flow: Standing,
) -> Explanation:
    """Why an attempt was decided.

    Args:
        reasons: of the requirement.
        before: where the run stood at the last position before that.
        letter: at the decision.
        verdict: the decision.
        t: its instant.
        triggered: that of the trigger.
        flow: how the propositions stood.
    """
    finding = reasons.of(before, letter, verdict, t)
    cause = finding.cause
    start = finding.start(before[1], t, triggered)
    return Explanation(
        rendered(finding.sentence, t, start, triggered, flow),
        deadline=None if cause is None else reasons.deadline(before),
        blame=None if verdict or cause is None else reasons.words.blame(cause, t, start, flow),
    )


@dataclass(frozen=True, slots=True)
class MachineRuns:
    """Runs of an automaton, as `rvmon.monitor.explained.undecided.Judged`.

    Attributes:
        machine: says what is owed in its locations.
        position: the last one that the runs were stepped at; letters stay behind it.
        gap: ticks between two positions; `None` if only samples are positions.
    """

    machine: Residuals
    position: int
    gap: int | None

    def why_open(self, attempt: Undecided, now: int, end: int | None) -> Explanation:
        """See `Judged`."""
        token = attempt.worse if attempt.worse[0] != FAILED else attempt.better
        if token[0] <= PASSED:
            return Explanation(f"left open by the input: {attempt.doubt}")
        location, anchors = token
        ages = [now // 2 - anchor for anchor in anchors]
        compiled = attempt.compiled
        owed = compiled.words.owed(after(self.machine.residual(location), ages), anchors)
        doubt = f"; {attempt.doubt}" if attempt.doubt else ""
        lasting = longer(compiled.obligation.owed, attempt.triggered, end)
        reason = f"{still_owed(owed, end)}{lasting}{doubt}{unborn(attempt.unborn, end)}"
        alone = (self._alone(attempt.worse), self._alone(attempt.better))
        return Explanation(reason, owed, deadline=earlier(*alone, void=attempt.void))

    def _alone(self, token: Token) -> tuple[int, bool] | None:
        """What time alone makes of a run, and the last instant before that."""
        if token[0] <= PASSED:
            return None
        return settled_alone(self.machine.residual(token[0]), token[1])

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """`P` or `F` if every continuation brings an attempt to it; never folded into its verdict.

        What was unknown stays so: `P` if the run that takes it for the worse passes anyway, `F` if
        the one that takes it for the better fails.
        """
        known = (now - 1) // 2
        if self._value(attempt, attempt.worse, known) is True:
            return Verdict.PASS
        return Verdict.FAIL if self._value(attempt, attempt.better, known) is False else None

    def _value(self, attempt: Undecided, token: Token, known: int) -> bool | None:
        location, anchors = token
        if location <= PASSED:
            return location != FAILED
        # Positions that change nothing are not visited.
        gap = self.gap or 1
        at = self.position + max(known - self.position, 0) // gap * gap
        ages = [at - anchor for anchor in anchors]
        residual = self.machine.residual(location)
        return attempt.compiled.forecaster.of(residual, ages, self.gap)
