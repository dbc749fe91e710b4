"""The record of one attempt."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from rvmon.trace.sample import Scalar
from rvmon.verdict.verdict import Verdict


class Decision(StrEnum):
    """What settled an attempt."""

    PREFIX = "prefix"
    """The samples so far leave no other value."""

    HELD_TO_END = "held to the end"
    """Only unbounded `always` obligations were open when the trace ended."""

    POLICY = "policy"
    """The requirement's `at end` policy."""

    OPEN = "open"
    """Nothing: undecided when the trace ended, or still running."""


@dataclass(frozen=True, slots=True)
class Blame:
    """The obligation that decided an attempt, and the window it spoke of.

    Attributes:
        subformula: its text as in the spec.
        start: span of the subformula in the spec's text, first character.
        end: behind the last character.
        window: first and last instant of its window in ticks; the last is `None` if unbounded.
        at: the instants of the samples that are to blame, in ticks.
    """

    subformula: str
    start: int
    end: int
    window: tuple[int, int | None]
    at: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Attempt:
    """One obligation that a trigger started.

    Attributes:
        requirement: its id.
        number: from 1, in order of trigger, per requirement.
        triggered: instant of the trigger, ticks.
        decided: the first instant at which the prefix left one value; the end of the trace
            for what the end rule or a policy settled; `None` for `I`.
        verdict: `P`, `F` or `I` (undecided).
        decision: what settled it.
        reason: one sentence for people.
        deadline: the last instant at which what is still owed (or was) can be met, ticks.
        at_trigger: values of the propositions concerned at the trigger, by their text.
        at_decision: the same at the decision.
        owed: what was open at the end, as text of the spec.
        captured: values captured by `let` and `for each`.
        blame: what failed, for `F`.
        forecast: `P` or `F` if no continuation can change that any more, though undecided.
        robustness: how far from the other verdict, in the unit of the comparison.
    """

    requirement: str
    number: int
    triggered: int
    decided: int | None
    verdict: Verdict
    decision: Decision = Decision.PREFIX
    reason: str = ""
    deadline: int | None = None
    at_trigger: Mapping[str, Scalar] = field(default_factory=dict)
    at_decision: Mapping[str, Scalar] = field(default_factory=dict)
    owed: str = ""
    captured: Mapping[str, Scalar] = field(default_factory=dict)
    blame: Blame | None = None
    forecast: Verdict | None = None
    robustness: float | None = None
