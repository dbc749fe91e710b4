"""The four verdicts and their fold; attempts, reports and tables of them are the modules here."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

LAW = 3
"""Version of the law by which verdicts are judged; raised when the same run may get another one.

It stands in reports, and in what a page or a command says of itself; the changes are complete in
docs/reference/what-changed-in-the-law.md.
"""


class Verdict(StrEnum):
    """What can be reported of a requirement, or of one attempt of it, on one run."""

    PASS = "P"
    FAIL = "F"
    NOT_TRIGGERED = "NT"
    INCONCLUSIVE = "I"


def fold(verdicts: Iterable[Verdict], *, complete: bool = True) -> Verdict:
    """The verdict of a requirement on a run, from the verdicts of its attempts.

    Args:
        verdicts: of its attempts.
        complete: whether all attempts that it may have are among these; if not, as when its trigger
            was never true or false, only that one failed says something.

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
