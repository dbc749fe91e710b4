"""The page of a campaign: both robots' tables beside the paper's, coverage, directed tests."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping

from handover.campaign.examples import Cell
from handover.campaign.flow_chart import flow_chart
from handover.campaign.paper import SOURCE
from handover.campaign.summary import CampaignSummary, KnownAnswer, RobotSummary
from handover.campaign.tables import ROBOTS, comparable, fitted_note, unfitted_table, verdict_table
from handover.collector.statements import StatementCoverage
from rvmon.report.markup import Child, e, page
from rvmon.report.percent import percent_text
from rvmon.report.style import MARKS
from rvmon.report.table_html import legend, table_html
from rvmon.verdict.verdict import Verdict


def report_page(
    summary: CampaignSummary,
    *,
    command: str,
    examples: Mapping[Cell, str],
    tests: Mapping[tuple[str, str], str],
) -> str:
    """Write the page.

    Args:
        summary: the campaign's figures.
        command: runs the campaign again.
        examples: addresses of pages, by the counts that they are examples of.
        tests: addresses of pages, by robot and test.
    """
    body: list[Child] = [_header(summary)]
    for robot, figures in summary.robots.items():
        if figures.requirements and figures.strategies:
            body.append(_verdicts(summary, robot, examples))
    for robot, figures in summary.robots.items():
        if figures.strategies:
            body.append(_coverage(robot, figures))
    for robot, figures in summary.robots.items():
        if figures.known:
            body.append(_known(robot, figures, tests))
    body.append(
        e("footer", None, e("p", None, "Run it again: ", e("code", None, command)), legend())
    )
    return page("Simulated handovers", body, styles=["base.css", "report.css"], scripts=[])


def _header(summary: CampaignSummary) -> ET.Element:
    robots = " and ".join(ROBOTS[robot].lower() for robot in summary.robots)
    partial = None
    if summary.cut_short:
        partial = e(
            "p",
            {"class": "partial", "role": "alert"},
            f"Partial: {summary.cut_short} after {summary.finished} of {summary.planned} tests.",
        )
    requirements = next(iter(summary.robots.values())).requirements
    listed: list[Child] = []
    for name, text in requirements.items():
        listed += [e("dt", None, name), e("dd", None, text)]
    return e(
        "header",
        None,
        e("h1", None, f"{summary.finished} simulated handovers, {len(requirements)} requirements"),
        e(
            "p",
            {"class": "soft"},
            f"{robots}; seed {summary.seed}; {summary.stepped_s:,.0f} s of physics "
            f"in {summary.seconds:.1f} s",
        ),
        partial,
        e("dl", {"class": "facts"}, *listed),
    )


def _verdicts(summary: CampaignSummary, robot: str, examples: Mapping[Cell, str]) -> ET.Element:
    table = verdict_table(summary, robot)
    paper = comparable(robot)
    unfitted = unfitted_table(summary, robot)
    beside = {} if paper is None else {"paper": paper}

    def link(strategy: str, requirement: str, verdict: Verdict) -> str | None:
        return examples.get((robot, strategy, requirement, verdict))

    parts: list[Child] = [
        e("h2", None, ROBOTS[robot]),
        e("p", {"class": "soft"}, "judged by ", e("code", None, summary.robots[robot].spec)),
        table_html(table, beside=beside, link=link),
    ]
    parts.extend(e("p", {"class": "soft"}, note) for note in table.notes)
    if paper is not None:
        parts.append(e("p", {"class": "soft"}, f"paper: {SOURCE}"))
    if paper is not None and unfitted is not None:
        parts.append(e("p", {"class": "soft"}, fitted_note(table, unfitted)))
        summary_line = e("summary", None, "The same without the fitted loss of signals")
        parts.append(e("details", None, summary_line, table_html(unfitted, beside=beside)))
    return e("section", None, *parts)


def _coverage(robot: str, figures: RobotSummary) -> ET.Element:
    charts = [
        e(
            "figure",
            None,
            e(
                "figcaption",
                None,
                e("b", None, name),
                f" {strategy.tests} tests, {_unbroken(strategy.total)} of "
                f"{strategy.total.statements} statements",
            ),
            flow_chart(strategy),
        )
        for name, strategy in figures.strategies.items()
    ]
    return e(
        "section",
        None,
        e("h2", None, f"{ROBOTS[robot]}: statement coverage by state"),
        e(
            "p",
            {"class": "soft"},
            "Filled by the share of the state's statements that ran; the number beside a line is "
            "how many tests took it, a dashed line was taken by none.",
        ),
        e("div", {"class": "charts"}, *charts),
    )


def _unbroken(total: StatementCoverage) -> str:
    """The share that ran; a line does not end before its sign."""
    return percent_text(total.covered, total.statements).replace(" ", "\N{NO-BREAK SPACE}")


def _known(robot: str, figures: RobotSummary, tests: Mapping[tuple[str, str], str]) -> ET.Element:
    ids = list(figures.requirements)
    faults = any(one.mutation for one in figures.known)
    titles = ["test", *ids, "purpose", *(["planted fault"] if faults else [])]
    head = e("tr", None, *(e("th", None, title) for title in titles))
    rows = [_known_row(robot, one, ids, tests, faults=faults) for one in figures.known]
    right = sum(one.as_expected for one in figures.known)
    grid = e("table", {"class": "verdicts"}, e("thead", None, head), e("tbody", None, *rows))
    return e(
        "section",
        None,
        e("h2", None, f"{ROBOTS[robot]}: directed tests"),
        e("p", {"class": "soft"}, f"{right} of {len(figures.known)} ended as they should."),
        e("div", {"class": "scroll", "tabindex": 0, "role": "group"}, grid),
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
    cells = [_verdict_cell(one, requirement) for requirement in ids]
    purpose = e("td", {"class": "text purpose"}, one.text)
    fault = e("td", {"class": "text"}, one.mutation or "") if faults else None
    return e("tr", None, e("th", {"scope": "row"}, name), *cells, purpose, fault)


def _verdict_cell(one: KnownAnswer, requirement: str) -> ET.Element:
    verdict = one.verdicts[requirement]
    expected = one.expected.get(requirement)
    text = f"{verdict.value} {MARKS[verdict].sign}"
    if expected is not None and expected != verdict:
        text += f" ≠ {expected}"
    return e("td", {"data-verdict": verdict.value}, text)
