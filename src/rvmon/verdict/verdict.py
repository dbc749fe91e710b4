"""The four verdicts and their fold."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

LAW = 2
"""Version of the law by which verdicts are judged; raised when the same run may get another one.

It stands in reports, and in what a page or a command says of itself; the changes are determined in
docs/reference/what-changed-in-the-law.md.
"""


class Verdict(StrEnum):
    """What can be said of a requirement, or of one attempt of it, on one run."""

    PASS = "P"
    FAIL = "F"
    NOT_TRIGGERED = "NT"
    INCONCLUSIVE = "I"


def fold(verdicts: Iterable[Verdict], *, determined: bool = True) -> Verdict:
    """The verdict of a requirement on a run, from the verdicts of its attempts.

    Args:
        verdicts: of its attempts.
        determined: whether its trigger was ever true or false; if not, that there are no attempts
            says nothing.

    Source: SEMANTICS, section 3.

    >>> fold([Verdict.PASS, Verdict.INCONCLUSIVE]).value, fold([]).value
    ('I', 'NT')
    """
    seen = set(verdicts)
    for verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS):
        if verdict in seen:
            return verdict
    return Verdict.NOT_TRIGGERED if determined else Verdict.INCONCLUSIVE
