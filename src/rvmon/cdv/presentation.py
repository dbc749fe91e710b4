"""How the figures of a campaign are shown; each part can be replaced."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

from markupsafe import Markup

from rvmon.cdv.summary import NOTHING, BlockCoverage, CampaignSummary, StrategySummary
from rvmon.cdv.tables import RobotTables, robot_tables, table_document
from rvmon.cdv.test import Test
from rvmon.report.pages import component
from rvmon.report.percent import percent_text
from rvmon.report.table import VerdictTable


def work_done(summary: CampaignSummary) -> str:
    """What a campaign has simulated."""
    return f"{summary.simulated_s:,.0f} s simulated"


def block_chart(figures: StrategySummary) -> Markup:
    """Tables of one strategy: shares of the blocks, tests that entered states, and went on."""
    blocks = [
        (name, _share(one), _share(figures.branches.get(name, NOTHING)))
        for name, one in figures.statements.items()
    ]
    transitions = [
        (f"{source} → {target}", tests) for (source, target), tests in figures.transitions.items()
    ]
    tables = (
        (("", "statements", "branches"), blocks),
        (("state", "tests"), [*figures.states.items()]),
        (("transition", "tests"), transitions),
    )
    return component("headed_tables", tables)


def _share(block: BlockCoverage) -> str:
    return percent_text(block.covered, block.statements) if block.statements else ""


def _nothing_more(folder: Path, strategies: frozenset[str]) -> None:
    """Write no further files."""


RobotTest = tuple[str, str]
"""Names of a robot and of a test."""


def _no_sections(
    _tests: Mapping[RobotTest, Test], _pages: Mapping[RobotTest, str]
) -> list[Element | Markup]:
    """Show nothing more."""
    return []


@dataclass(frozen=True, slots=True)
class Presentation:
    """How figures are shown.

    Attributes:
        title: of the page; default: the campaign's name.
        tests: what the tests are called, in the plural.
        tables: the verdicts on each robot, by its name.
        further: more tables for the files, by name.
        document: the content of `table.json`.
        work: what was simulated, in words, for the terminal.
        chart: the coverage of code under one strategy, for the page.
        chart_legend: how to read it.
        sections: further ones of the page, from the tests that were played and the addresses of
            their pages.
        foremost: requirements that the terminal shows: with others only those that failed or were
            left open somewhere, and shares of code as one line; default: it shows all of all.
        write_more: writes further files to a campaign's folder, given the strategies of its tests.
    """

    title: str = ""
    tests: str = "tests"
    tables: Callable[[CampaignSummary], Mapping[str, RobotTables]] = robot_tables
    further: Mapping[str, VerdictTable] = field(default_factory=dict)
    document: Callable[[CampaignSummary], Mapping[str, object]] = table_document
    work: Callable[[CampaignSummary], str] = work_done
    chart: Callable[[StrategySummary], Element | Markup] = block_chart
    chart_legend: str = (
        "The share of statements that ran and of branches that were taken; how many tests entered "
        "a state, and went from one to another."
    )
    sections: Callable[
        [Mapping[RobotTest, Test], Mapping[RobotTest, str]], Sequence[Element | Markup]
    ] = _no_sections
    foremost: Sequence[str] = ()
    write_more: Callable[[Path, frozenset[str]], None] = _nothing_more
