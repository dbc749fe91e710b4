"""The page of a campaign: the tables of all robots, coverage of their code, directed tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element

from markupsafe import Markup

from rvmon.cdv.coverage import CoverageFigures
from rvmon.cdv.examples import Cell
from rvmon.cdv.presentation import Presentation
from rvmon.cdv.summary import CampaignSummary
from rvmon.cdv.tables import INTERVALS, RobotTables
from rvmon.report.pages import render, table_html
from rvmon.report.table import VerdictTable
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
    further: Sequence[Element | Markup] = (),
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
    robots_of: dict[tuple[str, str], list[str]] = {}
    for robot in summary.robots.values():
        for requirement in robot.requirements.items():
            robots_of.setdefault(requirement, []).append(robot.title.lower())
    common = [one for one, of in robots_of.items() if len(of) == len(summary.robots)]
    others = [one for one in robots_of if one not in common]
    return render(
        "campaign.html",
        title=presentation.title or summary.name,
        summary=summary,
        presentation=presentation,
        count=len(robots_of),
        about=" and ".join(robot.title.lower() for robot in summary.robots.values()),
        common=common,
        others=others,
        whose=" and ".join(dict.fromkeys(of for one in others for of in robots_of[one])),
        robots=[
            (
                figures.title,
                figures.spec,
                tables[robot],
                *_tables(robot, tables[robot], examples, tests),
                _silent(robot, tables[robot].own, examples),
            )
            for robot, figures in summary.robots.items()
            if figures.requirements and figures.strategies
        ],
        coverage=coverage,
        measured=[
            figures
            for figures in summary.robots.values()
            if any(one.statements or one.states for one in figures.strategies.values())
        ],
        directed=[one for one in summary.robots.items() if one[1].known],
        tests=tests,
        further=further,
        command=command,
        intervals=INTERVALS,
    )


def _tables(
    robot: str,
    tables: RobotTables,
    examples: Mapping[Cell, str],
    tests: Mapping[tuple[str, str], str],
) -> tuple[Markup, Markup | None]:
    """The table of a robot, whose counts lead to examples, and that of its control."""
    own = table_html(
        tables.own,
        beside=tables.beside,
        link=lambda *cell: examples.get((robot, *cell)),
        witnesses={
            name: tests[robot, test]
            for name, test in tables.witnesses.items()
            if (robot, test) in tests
        },
    )
    if tables.control is None or not tables.control_label:
        return own, None
    return own, table_html(tables.control, beside=tables.beside)


def _silent(
    robot: str, table: VerdictTable, examples: Mapping[Cell, str]
) -> list[tuple[str, str | None]]:
    """The requirements that no test triggered, each with a run that says what it lacked."""
    found: list[tuple[str, str | None]] = []
    for name in table.requirements:
        groups = [group for group in table.groups if name in group.counts]
        counts = [group.counts[name] for group in groups]
        tests = sum(sum(one.values()) for one in counts)
        if tests and sum(one.get(Verdict.NOT_TRIGGERED, 0) for one in counts) == tests:
            shown = (examples.get((robot, one.name, name, Verdict.NOT_TRIGGERED)) for one in groups)
            found.append((name, next((one for one in shown if one is not None), None)))
    return found
