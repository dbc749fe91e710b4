"""Which attempts of a run its page shows, and on which it opens."""

from __future__ import annotations

from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

SHOWN = {Verdict.FAIL: 4, Verdict.INCONCLUSIVE: 2, Verdict.PASS: 2}
"""Attempts per requirement and verdict that are shown, the first ones; the rest is counted."""


def shown_attempts(report: Report) -> dict[str, list[Attempt]]:
    """By requirement, the attempts that get a timeline, in order of trigger."""
    shown: dict[str, list[Attempt]] = {name: [] for name in report.verdicts}
    room = {(name, verdict): most for name in shown for verdict, most in SHOWN.items()}
    for attempt in report.attempts:
        place = attempt.requirement, attempt.verdict
        if room[place]:
            room[place] -= 1
            shown[attempt.requirement].append(attempt)
    return {name: sorted(some, key=lambda one: one.number) for name, some in shown.items()}


def opening(report: Report) -> tuple[str, Attempt | None]:
    """The requirement and attempt that a page opens on: the first F, else I, else any."""
    for verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS):
        for attempt in report.attempts:
            if attempt.verdict is verdict:
                return attempt.requirement, attempt
    return next(iter(report.verdicts)), None
