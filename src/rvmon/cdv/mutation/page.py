"""The page of mutants: scores, what kills, and survivors as questions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import partial

from rvmon.cdv.mutation.mutant import HELD_OUT
from rvmon.cdv.mutation.question import TITLES, question
from rvmon.cdv.mutation.report import MutationReport
from rvmon.cdv.mutation.text import (
    HEAD,
    KILLS_HEAD,
    SPEC_HEAD,
    SPEC_TITLE,
    score_rows,
    spec_score_rows,
)
from rvmon.cdv.mutation.tried import How, Tried
from rvmon.report.pages import render

ABOUT = (
    "A mutant is one small wrong change. It is killed if a test that is fine without it is not "
    "fine with it; one that survives asks what is missing. Which third a mutant is in follows from "
    "a hash of its name. "
)


def mutation_page(report: MutationReport) -> str:
    """Write the page; it needs no script and nothing but itself.

    Args:
        report: what is shown.
    """
    suites = report.suites.values()
    hidden = "" if report.shows_held_out else f"Those {HELD_OUT} are counted, and not shown."
    code = any(one.tried for one in suites)
    requirements = any(one.spec_tried for one in suites)
    scores: list[tuple[str, Sequence[str], Iterable[Sequence[str]]]] = []
    scores += [("The code", HEAD, score_rows(report))] if code else []
    scores += [("The requirements", SPEC_HEAD, spec_score_rows(report))] if requirements else []
    return render(
        "mutation.html",
        title=f"Mutants: {report.campaign}",
        report=report,
        about=ABOUT + hidden,
        scores=scores,
        titles=TITLES,
        spec_title=SPEC_TITLE,
        kills_head=KILLS_HEAD,
        question=partial(question, reading=report.reading),
        killers=_killers,
        shown=partial(_shown, report),
    )


def _shown(report: MutationReport, suite: str) -> tuple[list[Tried], list[Sequence[str]]]:
    """Mutants of a suite that were killed, and a row for each that is declared equivalent."""
    found = report.shown(suite)
    equivalent = [
        (one.mutant.identity, one.mutant.brief, report.equivalent[one.mutant.identity])
        for one in found
        if one.mutant.identity in report.equivalent
    ]
    return [one for one in found if one.killed], [*equivalent]


def _killers(killed: Sequence[Tried]) -> list[Sequence[str]]:
    """By each requirement, and each other way, how many mutants it kills first."""
    counts: Counter[str] = Counter()
    tests: dict[str, Counter[str]] = {}
    for one in killed:
        best = min(one.findings, key=lambda found: tuple(How).index(found.how))
        for what in best.what if best.how is How.REQUIREMENT else (best.how.value,):
            counts[what] += 1
            tests.setdefault(what, Counter())[best.test] += 1
    return [
        (
            what,
            ", ".join(f"{test or 'unknown'} {own}" for test, own in tests[what].most_common()),
            str(count),
        )
        for what, count in counts.most_common()
    ]
