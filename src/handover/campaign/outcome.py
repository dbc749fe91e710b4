"""What a campaign keeps of each test, and of all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from handover.campaign.plan import Job, Plan
from rvmon.verdict.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Outcome:
    """One judged test.

    Attributes:
        job: what was played.
        verdicts: by requirement; empty if nothing was judged.
        states: of the robot, in the order in which it entered them.
        lines: of the robot's code that ran.
        stepped_s: simulated seconds for which the physics was stepped.
        simulated_s: simulated seconds in all.
        error: the exception of the robot's code, if it crashed.
        connected: whether the human's signals reached the robot.
    """

    job: Job
    verdicts: Mapping[str, Verdict]
    states: tuple[str, ...]
    lines: frozenset[int]
    stepped_s: float
    simulated_s: float
    error: str | None
    connected: bool


@dataclass(frozen=True, slots=True)
class Results:
    """What came out of a campaign.

    Attributes:
        plan: what was to be played.
        outcomes: in the order of the plan, whichever worker was first.
        unfitted: the same without the fitted loss of signals, only for tests that suffered it.
        seconds: wall time.
        cut_short: why not all tests were played; empty if they were.
    """

    plan: Plan
    outcomes: tuple[Outcome, ...]
    unfitted: tuple[Outcome, ...]
    seconds: float
    cut_short: str = ""
