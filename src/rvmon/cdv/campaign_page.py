"""The page of a campaign: the tables of all robots, coverage of their code, directed tests."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

from rvmon.cdv.coverage import CoverageFigures
from rvmon.cdv.examples import Cell
from rvmon.cdv.presentation import Presentation
from rvmon.cdv.summary import BlockCoverage, CampaignSummary, KnownAnswer, RobotSummary
from rvmon.cdv.tables import INTERVALS, RobotTables
from rvmon.report.coverage_summary import counted, share_text
from rvmon.report.markup import Child, e, page, scroll
from rvmon.report.percent import percent_text
from rvmon.report.style import MARKS
from rvmon.report.table import VerdictTable
from rvmon.report.table_html import Link, legend, table_html
from rvmon.verdict.verdict import Verdict


def campaign_page(
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    presentation: Presentation,
    *,
    command: str,
    examples: Mapping[Cell, str],
    tests: Mapping[tuple[str, str], str],
    coverage: Mapping[str, CoverageFigures],
    further: Sequence[ET.Element] = (),
) -> str:
    """Write the page.

    Args:
        summary: the campaign's figures.
        tables: its verdicts, by robot.
        presentation: what is shown of them.
        command: runs the campaign again.
        examples: addresses of pages, by the counts that they are examples of.
        tests: addresses of pages, by robot and test.
        coverage: by robot, what was covered.
        further: sections of the campaign's own.
    """
    body: list[Child] = [_header(summary, presentation)]
    body.extend(
        _verdicts(robot, figures, tables[robot], examples, tests)
        for robot, figures in summary.robots.items()
        if figures.requirements and figures.strategies
    )
    body.append(_covered(summary, coverage))
    body.extend(
        _coverage(figures, presentation, summary.kind)
        for figures in summary.robots.values()
        if any(one.statements or one.states for one in figures.strategies.values())
    )
    body.extend(
        _known(robot, figures, tests) for robot, figures in summary.robots.items() if figures.known
    )
    body.extend(further)
    body.append(
        e(
            "footer",
            None,
            e("p", None, "Run it again: ", e("code", None, command)),
            legend(),
            e("p", {"class": "soft"}, INTERVALS),
        )
    )
    title = presentation.title or summary.name
    return page(title, body, styles=["base.css", "report.css"], scripts=[])


def _header(summary: CampaignSummary, presentation: Presentation) -> ET.Element:
    robots = " and ".join(robot.title.lower() for robot in summary.robots.values())
    partial = None
    if summary.cut_short:
        partial = e(
            "p",
            {"class": "partial", "role": "alert"},
            f"Partial: {summary.cut_short} after {summary.finished} of {summary.planned} tests.",
        )
    robots_of: dict[tuple[str, str], list[str]] = {}
    for robot in summary.robots.values():
        for requirement in robot.requirements.items():
            robots_of.setdefault(requirement, []).append(robot.title.lower())
    common = [one for one, of in robots_of.items() if len(of) == len(summary.robots)]
    others = [one for one in robots_of if one not in common]
    more = None
    if others:
        whose = " and ".join(dict.fromkeys(of for one in others for of in robots_of[one]))
        more = e(
            "details", None, e("summary", None, f"{len(others)} more of {whose}"), _list(others)
        )
    return e(
        "header",
        None,
        e(
            "h1",
            None,
            f"{summary.finished} {presentation.tests}, {len(robots_of)} requirements",
        ),
        e(
            "p",
            {"class": "soft"},
            f"{robots}; seed {summary.seed}; {presentation.page_work(summary)} "
            f"in {summary.seconds:.1f} s",
        ),
        partial,
        _list(common),
        more,
    )


def _list(requirements: Sequence[tuple[str, str]]) -> ET.Element:
    listed: list[Child] = []
    for name, text in requirements:
        listed += [e("dt", None, name), e("dd", None, text)]
    return e("dl", {"class": "facts"}, *listed)


def _verdicts(
    robot: str,
    figures: RobotSummary,
    tables: RobotTables,
    examples: Mapping[Cell, str],
    tests: Mapping[tuple[str, str], str],
) -> ET.Element:
    def link(strategy: str, requirement: str, verdict: Verdict) -> str | None:
        return examples.get((robot, strategy, requirement, verdict))

    witnesses = {
        name: tests[robot, test]
        for name, test in tables.witnesses.items()
        if (robot, test) in tests
    }
    parts: list[Child] = [
        e("h2", None, figures.title),
        e("p", {"class": "soft"}, "checked against ", e("code", None, figures.spec)),
        table_html(tables.own, beside=tables.beside, link=link, witnesses=witnesses),
    ]
    if silent := [name for name in figures.requirements if _is_silent(name, tables.own)]:
        parts.append(_silent(silent, tables.own, link))
    remarks = (*tables.own.notes, *tables.sources, tables.remark)
    parts.extend(e("p", {"class": "soft"}, remark) for remark in remarks if remark)
    if tables.control is not None and tables.control_label:
        summary_line = e("summary", None, tables.control_title)
        table = table_html(tables.control, beside=tables.beside)
        parts.append(e("details", None, summary_line, table))
    return e("section", None, *parts)


def _is_silent(requirement: str, table: VerdictTable) -> bool:
    """Whether no test triggered a requirement."""
    counts = [group.counts[requirement] for group in table.groups if requirement in group.counts]
    tests = sum(sum(one.values()) for one in counts)
    return tests > 0 and sum(one.get(Verdict.NOT_TRIGGERED, 0) for one in counts) == tests


def _silent(requirements: Sequence[str], table: VerdictTable, link: Link) -> ET.Element:
    """Requirements that nothing was found out about, each with a run that says what it lacked."""
    parts: list[Child] = []
    for name in requirements:
        found = (link(group.name, name, Verdict.NOT_TRIGGERED) for group in table.groups)
        address = next((one for one in found if one is not None), None)
        title = f"what the trigger of {name} lacked"
        shown: Child = name if address is None else e("a", {"href": address, "title": title}, name)
        parts += [", " if parts else "", shown]
    count = counted(len(requirements), "requirement")
    return e("p", {"class": "partial"}, f"{count} triggered by no test, and so untested: ", *parts)


def _covered(summary: CampaignSummary, coverage: Mapping[str, CoverageFigures]) -> ET.Element:
    """What of the coverage models was seen, each with the way to its page."""
    lines = []
    for robot, found in coverage.items():
        link = e("a", {"href": found.page}, f"{share_text(found.share)} covered")
        rest: list[Child] = [f", {counted(found.holes, 'hole')}"]
        if found.illegal:
            hits = f", {counted(len(found.illegal), 'illegal item')} hit"
            rest.append(e("b", {"data-verdict": "F"}, hits))
        lines.append(e("li", None, f"{summary.robots[robot].title}: ", link, *rest))
    return e("section", None, e("h2", None, "Coverage"), e("ul", None, *lines))


def _coverage(figures: RobotSummary, presentation: Presentation, kind: str) -> ET.Element:
    charts = [
        e(
            "figure",
            None,
            e(
                "figcaption",
                None,
                e("b", None, name),
                f" {strategy.tests} tests",
                _share_of_statements(strategy.total) if kind else None,
            ),
            presentation.chart(strategy),
        )
        for name, strategy in figures.strategies.items()
    ]
    return e(
        "section",
        None,
        e("h2", None, f"{figures.title}: {f'statement coverage by {kind}' if kind else 'states'}"),
        e("p", {"class": "soft"}, presentation.chart_legend),
        e("div", {"class": "charts"}, *charts),
    )


def _share_of_statements(total: BlockCoverage) -> str:
    """The share that ran; a line does not end before its sign."""
    share = percent_text(total.covered, total.statements).replace(" ", "\N{NO-BREAK SPACE}")
    return f", {share} of {total.statements} statements"


def _known(robot: str, figures: RobotSummary, tests: Mapping[tuple[str, str], str]) -> ET.Element:
    ids = list(figures.requirements)
    faults = any(one.mutation for one in figures.known)
    titles = ["test", "purpose", *(["planted fault"] if faults else []), *ids]
    head = e("tr", None, *(e("th", None, title) for title in titles))
    rows = [_known_row(robot, one, ids, tests, faults=faults) for one in figures.known]
    right = sum(one.as_expected for one in figures.known)
    grid = e("table", {"class": "verdicts"}, e("thead", None, head), e("tbody", None, *rows))
    return e(
        "section",
        None,
        e("h2", None, f"{figures.title}: directed tests"),
        e("p", {"class": "soft"}, f"{right} of {len(figures.known)} ended as they should."),
        scroll(grid),
    )


def _known_row(
    robot: str,
    one: KnownAnswer,
    ids: list[str],
    tests: Mapping[tuple[str, str], str],
    *,
    faults: bool,
) -> ET.Element:
    address = tests.get((robot, one.test))
    name: Child = one.test if address is None else e("a", {"href": address}, one.test)
    cells = [_verdict_cell(one, requirement, address) for requirement in ids]
    purpose = e("td", {"class": "text purpose"}, one.text, *(f" – {what}" for what in one.missed))
    fault = e("td", {"class": "text"}, one.mutation or "") if faults else None
    return e("tr", None, e("th", {"scope": "row"}, name), purpose, fault, *cells)


def _verdict_cell(one: KnownAnswer, requirement: str, address: str | None) -> ET.Element:
    verdict = one.verdicts[requirement]
    expected = one.expected.get(requirement)
    text = f"{verdict.value} {MARKS[verdict].sign}"
    if expected is not None and expected != verdict:
        text += f" ≠ {expected}"
    shown: Child = text
    if address is not None and verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE):
        shown = e("a", {"href": f"{address}#{requirement}"}, text)
    return e("td", {"data-verdict": verdict.value}, shown)
