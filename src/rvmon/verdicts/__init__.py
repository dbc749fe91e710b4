"""The four verdicts and their fold; the modules define attempts, reports and tables of verdicts."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

LAW = 3
"""Version of the semantics ("law"); increased whenever a change can alter the verdict of a run.

Reports store it; pages and commands show it. All changes are listed in
docs/reference/what-changed-in-the-law.md.
"""


class Verdict(StrEnum):
    """The verdict on a requirement, or on one of its attempts, for one run."""

    PASS = "P"
    FAIL = "F"
    NOT_TRIGGERED = "NT"
    INCONCLUSIVE = "I"


def fold(verdicts: Iterable[Verdict], *, complete: bool = True) -> Verdict:
    """The verdict of a requirement on a run, from the verdicts of its attempts.

    Args:
        verdicts: the verdicts of its attempts.
        complete: whether no further attempt can exist. False if its trigger was never TRUE or
            FALSE: then the result is `F` or `I`.

    Source: SEMANTICS, section 3.

    >>> fold([Verdict.PASS, Verdict.INCONCLUSIVE]).value, fold([]).value
    ('I', 'NT')
    """
    seen = set(verdicts)
    if Verdict.FAIL in seen:
        return Verdict.FAIL
    if Verdict.INCONCLUSIVE in seen or not complete:
        return Verdict.INCONCLUSIVE
    return Verdict.PASS if Verdict.PASS in seen else Verdict.NOT_TRIGGERED
