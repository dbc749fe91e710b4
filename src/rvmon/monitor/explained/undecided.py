"""An undecided attempt as plain data, and what is said of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from rvmon.automaton.location import FAILED, Token
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.explained.explanation import Explanation
from rvmon.monitor.reasons.doubt import Doubt, Outage
from rvmon.spec.checked.specification import EndPolicy
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Undecided:
    """An attempt as it stands by now.

    Attributes:
        compiled: the requirement, or what judges its attempts in doubt.
        triggered: the instant of its trigger, ticks.
        worse: where the run stands that takes the unknown for the worse.
        better: the same for the better.
        doubt: when and why the two runs parted, or it is not known whether there was a trigger.
        unborn: which of what it reads has had no value so far.
        sure: whether its trigger was TRUE.
        void: whether it cannot pass, since its episode was over before all was born.
        cut: whether it is not known any more which values it captured.
    """

    compiled: CompiledRequirement
    triggered: int
    worse: Token
    better: Token
    doubt: Doubt | None
    unborn: tuple[Outage, ...]
    sure: bool
    void: bool
    cut: bool


class Judged(Protocol):
    """What judged an attempt, as it stands at a stamp."""

    def why_open(self, attempt: Undecided, now: int, end: int | None) -> Explanation:
        """What an undecided attempt waits for, or why it can wait no more; see `why_open`."""

    def forecast(self, attempt: Undecided, now: int) -> Verdict | None:
        """What every continuation brings an open attempt to, where that is known."""


def why_open(judged: Judged, attempt: Undecided, now: int, end: int | None = None) -> Explanation:
    """What an undecided attempt waits for; one in doubt waits for nothing but to be met.

    Args:
        judged: what judges it.
        attempt: undecided.
        now: twice the instant that time has come to, one more if its letter is known.
        end: the last instant of the trace, if it has ended.
    """
    if attempt.sure:
        why = judged.why_open(attempt, now, end)
        # What is owed of signals without a value does not fail, and time gives them none.
        is_unborn = attempt.void and not attempt.cut
        return replace(why, deadline=None) if is_unborn else why
    if attempt.worse[0] == FAILED:
        cause = f"; {attempt.doubt}" if attempt.doubt else ""
        return Explanation(f"it is not known whether there was a trigger{cause}")
    alone = replace(attempt, better=attempt.worse, void=False)
    return replace(judged.why_open(alone, now, end), deadline=None)


def forecast_of(judged: Judged, attempt: Undecided, now: int) -> Verdict | None:
    """What every continuation brings an open attempt to, where that is known; `now` as above.

    Source: SEMANTICS 2, Truth after a prefix.
    """
    return judged.forecast(attempt, now) if attempt.sure and not attempt.void else None


def why_settled(decision: Decision, policy: EndPolicy) -> str:
    """How the end of the trace settled an attempt."""
    if decision is Decision.HELD_TO_END:
        return "held to the end of the trace"
    return f"settled by `at end: {policy}`"


def why_nothing(*, cut: bool) -> Explanation:
    """Why an attempt stays undecided, whatever comes, though it is over."""
    if cut:
        return Explanation("it is not known which values it captured")
    return Explanation("it was over before all that it speaks of had a value")
