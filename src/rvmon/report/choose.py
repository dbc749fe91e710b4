"""Which attempts of a run its page shows, and on which it opens."""

from __future__ import annotations

from itertools import islice

from rvmon.errors import RvmonError
from rvmon.verdict.attempt import Attempt
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

SHOWN = {Verdict.FAIL: 4, Verdict.INCONCLUSIVE: 2, Verdict.PASS: 2}
"""Attempts per requirement and verdict that are shown, the first ones; the rest is counted."""


def shown_attempts(report: Report) -> dict[str, list[Attempt]]:
    """By requirement, the attempts that get a timeline, in order of trigger."""
    shown = {}
    for name in report.verdicts:
        some = [
            attempt
            for verdict, most in SHOWN.items()
            for attempt in islice(report.of(name, verdict), most)
        ]
        shown[name] = sorted(some, key=lambda one: one.number)
    return shown


def opening(report: Report) -> tuple[str, Attempt | None]:
    """The requirement and attempt that a page opens on: the first F, else I, else any.

    Raises:
        RvmonError: there is no requirement.
    """
    if not report.verdicts:
        raise RvmonError("a page shows requirements, and the specification has none: add one")
    for verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS):
        for attempt in report.attempts:
            if attempt.verdict is verdict:
                return attempt.requirement, attempt
    return next(iter(report.verdicts)), None
