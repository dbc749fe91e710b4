"""What the law says of a case."""

from __future__ import annotations

from rvmon.testing.case import Case
from rvmon.testing.law.sample_words import word_of
from rvmon.testing.law.word import Word
from rvmon.testing.oracle import evaluate
from rvmon.verdict.report import Report


def judge(case: Case) -> Report:
    """The oracle's report on a case."""
    return evaluate(
        case.spec,
        case.samples,
        end=case.end,
        advances=case.advances,
        names=case.names,
        outages=case.outages,
    )


def word(case: Case) -> Word:
    """The trace of a case, position by position."""
    return word_of(
        case.spec,
        case.samples,
        end=case.end,
        advances=case.advances,
        names=case.names,
        outages=case.outages,
    )
