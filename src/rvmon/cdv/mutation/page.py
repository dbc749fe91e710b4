"""The page of mutants: scores, what kills, and survivors as questions."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

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
from rvmon.report.coverage_summary import counted
from rvmon.report.markup import Child, e, page, scroll, with_code

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
    hidden = "" if report.shows_held_out else f"Those {HELD_OUT} are counted, and not shown."
    body: list[Child] = [
        e(
            "header",
            None,
            e("h1", None, f"Mutants: {report.campaign}"),
            e("p", {"class": "soft"}, f"{report.robot}; {report.seconds:.1f} s"),
            e("p", {"class": "soft"}, ABOUT + hidden),
        )
    ]
    if any(suite.tried for suite in report.suites.values()):
        body.append(_section("The code", _table(HEAD, score_rows(report), texts=2)))
    if any(suite.spec_tried for suite in report.suites.values()):
        table = _table(SPEC_HEAD, spec_score_rows(report), texts=2)
        body.append(_section("The requirements", table))
    body.extend(_suite(report, name) for name in report.suites)
    title = f"Mutants: {report.campaign}"
    return page(
        title, body, styles=["base.css", "report.css", "coverage.css", "mutation.css"], scripts=[]
    )


def _suite(report: MutationReport, name: str) -> ET.Element:
    suite = report.suites[name]
    parts: list[Child] = [e("p", {"class": "soft"}, counted(suite.tests, "test"))]
    for kind, survivors in report.survivors(name).items():
        lines = [_survivor(one, report) for one in survivors]
        parts += _listed(TITLES[kind], lines)
    lines = [
        e(
            "li",
            None,
            e("code", None, one.mutant.identity),
            _change(one.mutant.before, one.mutant.after),
        )
        for one in report.spec_survivors(name)
    ]
    if lines:
        parts += _listed(SPEC_TITLE, lines)
    killed = [one for one in report.shown(name) if one.killed]
    if killed:
        parts += [e("h3", None, "What kills"), _killers(killed)]
    if kills := report.kills(name):
        table = _table(KILLS_HEAD, kills, texts=3)
        summary = e("summary", None, f"{counted(len(kills), 'mutant')} killed")
        parts.append(e("details", None, summary, table))
    equivalent = [one for one in report.shown(name) if one.mutant.identity in report.equivalent]
    if equivalent:
        rows = (
            (one.mutant.identity, one.mutant.brief, report.equivalent[one.mutant.identity])
            for one in equivalent
        )
        table = _table(("mutant", "change", "argument"), rows, texts=3)
        summary = e("summary", None, f"{len(equivalent)} declared equivalent")
        parts.append(e("details", None, summary, table))
    return _section(name, *parts)


def _survivor(one: Tried, report: MutationReport) -> ET.Element:
    mutant = one.mutant
    place = e("span", {"class": "soft"}, f" {mutant.path.name}, line {mutant.line}")
    asked = e("p", None, *with_code(question(one, report.reading)))
    name = e("code", None, mutant.identity)
    return e("li", None, name, place, _change(mutant.before, mutant.after), asked)


def _killers(killed: Sequence[Tried]) -> ET.Element:
    """By each requirement, and each other way, how many mutants it kills first."""
    counts: Counter[str] = Counter()
    tests: dict[str, Counter[str]] = {}
    for one in killed:
        best = min(one.findings, key=lambda found: tuple(How).index(found.how))
        for what in best.what if best.how is How.REQUIREMENT else (best.how.value,):
            counts[what] += 1
            tests.setdefault(what, Counter())[best.test] += 1
    rows = [
        (what, ", ".join(f"{test or 'unknown'} {own}" for test, own in tests[what].most_common()))
        for what, _ in counts.most_common()
    ]
    lines = [(*row, str(counts[row[0]])) for row in rows]
    return _table(("requirement", "in the tests", "mutants"), lines, texts=2)


def _change(before: str, after: str) -> ET.Element:
    lines = [e("del", None, f"- {line}\n") for line in before.splitlines()]
    lines += [e("ins", None, f"+ {line}\n") for line in after.splitlines()]
    return e("pre", {"class": "change"}, *lines)


def _listed(title: str, lines: Sequence[ET.Element]) -> list[Child]:
    head = e("h3", None, title, " ", e("small", None, str(len(lines))))
    return [head, e("ul", {"class": "lines"}, *lines)]


def _section(title: str, *parts: Child) -> ET.Element:
    return e("section", None, e("h2", None, title), *parts)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], *, texts: int) -> ET.Element:
    """A table whose first columns are texts, the others numbers."""
    titles = e("tr", None, *_cells(head, texts, tag="th"))
    lines = [e("tr", None, *_cells(row, texts)) for row in rows]
    grid = e("table", None, e("thead", None, titles), e("tbody", None, *lines))
    return scroll(grid)


def _cells(row: Sequence[str], texts: int, *, tag: str = "td") -> Iterator[ET.Element]:
    for place, cell in enumerate(row):
        yield e(tag, {"class": "text" if place < texts else None}, cell)
