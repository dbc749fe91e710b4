"""A campaign's figures as tables and as `table.json`; a campaign can replace each part."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import msgspec
from markupsafe import Markup

from rvmon.cdv.campaign_summary import (
    NOTHING,
    BlockCoverage,
    CampaignSummary,
    RobotSummary,
    StrategySummary,
)
from rvmon.cdv.sequential_test import ALPHA, BETA, Decision, errors_text
from rvmon.cdv.test import Test
from rvmon.confidence import CONFIDENCE, interval
from rvmon.coverage import Ending
from rvmon.report.html import component
from rvmon.report.verdict_table import Counts, RunGroup, VerdictTable
from rvmon.texts import counted, percent_text

LEGEND = "Number of tests: P passed, F failed, NT not triggered, I inconclusive."

INTERVALS = (
    f"Below each: the {100 * CONFIDENCE:g} % interval of its share in % (Clopper and Pearson), for "
    "tests that are drawn at random; for tests that are chosen it has no meaning."
)


@dataclass(frozen=True, slots=True)
class RobotTables:
    """The tables of the verdicts on one robot.

    Attributes:
        own: the counts of its tests.
        compared: by label, tables that `own` is compared with row by row.
        control: the counts with controls in place of their tests, if there are controls.
        control_label: label of the control's lines in the text; empty: only the files have them.
        control_title: heading of the control's table on the page.
        sources: remarks on the compared tables, for the page.
        remark: text below the tables.
        witnesses: by requirement, a test that follows the witness which model checking found.
    """

    own: VerdictTable
    compared: Mapping[str, VerdictTable] = field(default_factory=dict)
    control: VerdictTable | None = None
    control_label: str = ""
    control_title: str = ""
    sources: tuple[str, ...] = ()
    remark: str = ""
    witnesses: Mapping[str, str] = field(default_factory=dict)


def robot_tables(summary: CampaignSummary) -> dict[str, RobotTables]:
    """The tables of each robot that was judged, by its name."""
    return {
        name: RobotTables(
            own=verdict_table(summary, name),
            control=control_table(summary, name),
            control_label=summary.control,
            control_title=f"The same {summary.control}",
        )
        for name in summary.robots
    }


def verdict_table(summary: CampaignSummary, robot: str) -> VerdictTable:
    """The counts of one robot under each strategy."""
    figures = summary.robots[robot]
    counts = {name: strategy.counts for name, strategy in figures.strategies.items()}
    return VerdictTable(
        title=f"{figures.title}, checked against {figures.spec}",
        requirements=figures.requirements,
        groups=_groups(figures, counts),
        notes=_notes(summary, figures),
        shows_intervals=True,
    )


def control_table(summary: CampaignSummary, robot: str) -> VerdictTable | None:
    """The counts with controls in place of their tests; `None` if there are no controls."""
    figures = summary.robots[robot]
    if not figures.controls:
        return None
    return VerdictTable(
        title=f"{figures.title}, {summary.control}",
        requirements=figures.requirements,
        groups=_groups(figures, figures.controls),
        shows_intervals=True,
    )


def named_tables(tables: Mapping[str, RobotTables], control: str) -> dict[str, VerdictTable]:
    """The tables of all robots by a short name, for files that hold all tables."""
    named: dict[str, VerdictTable] = {}
    for robot, table in tables.items():
        named[robot] = table.own
        if table.control is not None:
            named[f"{robot} {control}"] = table.control
    return named


def _groups(
    figures: RobotSummary, counts: Mapping[str, Mapping[str, Counts]]
) -> tuple[RunGroup, ...]:
    return tuple(
        RunGroup(name, figures.strategies[name].tests, rows) for name, rows in counts.items()
    )


def _notes(summary: CampaignSummary, figures: RobotSummary) -> tuple[str, ...]:
    notes = []
    if summary.cut_short:
        played = f"{summary.finished} of {summary.planned} tests"
        notes.append(f"PARTIAL: {summary.cut_short} after {played}.")
    for strategy, strategy_summary in figures.strategies.items():
        for name, decision in strategy_summary.shares.items():
            errors = "" if decision.holds is None else f", {errors_text(decision)}"
            notes.append(f"{name} {decision.share}: under {strategy} {decision}{errors}.")
    strategies = figures.strategies.values()
    if crashed := sum(len(strategy.errors[Ending.CRASHED]) for strategy in strategies):
        tests = counted(crashed, "test")
        notes.append(f"The robot's code crashed in {tests}, evaluated nevertheless.")
    ends = {Ending.HUNG: "{} hung: {}, and was ended", Ending.LOST: "{} was lost: {}"}
    for ending, text in ends.items():
        ended = (item for strategy in strategies for item in strategy.errors[ending].items())
        notes += [f"{text.format(*item)}; nothing is known of it." for item in ended]
    return tuple(notes)


def table_document(
    summary: CampaignSummary,
    *,
    control_key: str = "control",
    more: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """The content of `table.json`; the seed determines everything but `seconds`.

    `control_key` is the key of the counts with controls in place of their tests.
    """
    robots = {
        name: _robot_document(robot, summary.kind, control_key)
        for name, robot in summary.robots.items()
    }
    document: dict[str, object] = {"seed": summary.seed, "robots": robots, **(more or {})}
    if summary.cut_short:
        document["partial"] = {
            "why": summary.cut_short,
            "planned": summary.planned,
            "finished": summary.finished,
        }
    document["seconds"] = round(summary.seconds, 2)
    return document


def _robot_document(robot: RobotSummary, kind: str, control_key: str) -> dict[str, object]:
    document: dict[str, object] = {
        "spec": robot.spec,
        "strategies": {
            name: _strategy_document(strategy, kind) for name, strategy in robot.strategies.items()
        },
    }
    if robot.controls:
        document[control_key] = {
            "strategies": {
                name: {"tests": robot.strategies[name].tests, "requirements": rows_document(rows)}
                for name, rows in robot.controls.items()
            }
        }
    if robot.known:
        document["known_answers"] = {
            answer.test.name: {
                "mutation": answer.test.mutation,
                "expected": answer.test.expected,
                "verdicts": answer.verdicts,
                "missed": answer.missed,
                "as_expected": answer.as_expected,
            }
            for answer in robot.known
        }
    return document


def rows_document(rows: Mapping[str, Counts]) -> dict[str, dict[str, int]]:
    """The numbers of tests by requirement and verdict."""
    return {
        name: {verdict.value: count for verdict, count in counts.items()}
        for name, counts in rows.items()
    }


def _intervals(counts: Counts) -> dict[str, list[float]]:
    """The confidence interval of the share of each verdict; there is at least one test."""
    runs = sum(counts.values())
    return {
        verdict.value: [round(bound, 4) for bound in interval(count, runs)]
        for verdict, count in counts.items()
    }


def to_json(document: Mapping[str, object]) -> bytes:
    """A document as indented JSON; keys keep their order."""
    return msgspec.json.format(msgspec.json.encode(document), indent=2) + b"\n"


def _strategy_document(figures: StrategySummary, kind: str) -> dict[str, object]:
    document: dict[str, object] = {
        "tests": figures.tests,
        "requirements": rows_document(figures.counts),
        "intervals": {name: _intervals(count) for name, count in figures.counts.items()},
    }
    if figures.statements:
        document["statements"] = {
            "percent": figures.total.percent,
            f"by_{kind}": {
                name: statement.percent for name, statement in figures.statements.items()
            },
        }
    if figures.shares:
        document["shares"] = {
            name: _share_document(share) for name, share in figures.shares.items()
        }
    document["simulated_s"] = round(figures.simulated_s, 3)
    for name, figure in figures.figures.items():
        document.setdefault(name, round(figure, 3))
    for ending, errors in figures.errors.items():
        if errors:
            document["crashes" if ending is Ending.CRASHED else ending.value] = errors
    return document


def _share_document(decision: Decision) -> dict[str, object]:
    return {
        "required": str(decision.share),
        "holds": decision.holds,
        "tests": decision.tests,
        "passed": decision.passed,
        "inconclusive": decision.inconclusive,
        "missing": decision.missing,
        "alpha": ALPHA,
        "beta": BETA,
        "indifference": [round(bound, 6) for bound in decision.indifference],
    }


def work_done(summary: CampaignSummary) -> str:
    """The amount of simulation of a campaign, in words."""
    return f"{summary.simulated_s:,.0f} s simulated"


def block_chart(figures: StrategySummary) -> Markup:
    """Tables of one strategy: coverage of the blocks, and tests per state and per transition."""
    blocks = [
        (name, _share(statement), _share(figures.branches.get(name, NOTHING)))
        for name, statement in figures.statements.items()
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


RobotTest = tuple[str, str]
"""Names of a robot and of a test."""


@dataclass(frozen=True, slots=True)
class Presentation:
    """How the figures of a campaign are presented.

    Attributes:
        title: of the page; default: the campaign's name.
        tests: the word for the tests, in the plural.
        tables: makes the verdict tables of each robot, by its name.
        further: further tables for the files, by name.
        document: makes the content of `table.json`.
        work: says how much was simulated, for the terminal.
        chart: draws the code coverage under one strategy, for the page.
        chart_legend: its legend.
        sections: makes further sections of the page, from the played tests and the addresses of
            their pages.
        foremost: requirements that the terminal always shows. Of the others it then shows only
            those that failed or were inconclusive in some test, and it prints code coverage as one
            line; the page folds the texts of the others. Default: everything is shown.
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
    ] = lambda _tests, _pages: ()
    foremost: Sequence[str] = ()
    write_more: Callable[[Path, frozenset[str]], None] = lambda _folder, _strategies: None
