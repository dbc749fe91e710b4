"""The page of a campaign, and the choice of tests that get a page of their own."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from markupsafe import Markup
from msgspec import structs

from rvmon.cdv.campaign_plan import Job, Played
from rvmon.cdv.campaign_summary import CampaignSummary, differences
from rvmon.cdv.coverage import CoverageFigures
from rvmon.cdv.tables import INTERVALS, Presentation, RobotTables
from rvmon.coverage import Ending
from rvmon.report.html import render, table_html
from rvmon.report.verdict_table import VerdictTable
from rvmon.verdicts import Verdict

Cell = tuple[str, str, str, Verdict]
"""A cell of a verdict table, which holds a count: robot, strategy, requirement and verdict."""

COMPARED = 4
"""The number of passing tests, per failed requirement, that are searched for the nearest passing
attempt. For a test with a planted fault it is one, besides the same test without the fault."""


@dataclass(frozen=True, slots=True)
class Examples:
    """The tests that get a page."""

    jobs: tuple[Job, ...]  # without repetition, in the order of the plan
    by_cell: dict[Cell, Job]  # an example test for each count that is not zero


def choose_examples(
    played: Sequence[Played], *, also: Collection[str] = (), every: bool = False
) -> Examples:
    """Choose tests that get a page: a few examples for all counts, and every remarkable test.

    Remarkable are tests with a planted fault, with an error, or with unexpected verdicts. A test
    that hung or was lost has no page, as it cannot be played again in this process. The examples
    are chosen greedily: each is the test that has the most counts without an example.

    Args:
        played: the tests of the campaign.
        also: names of further tests that get a page.
        every: all tests get a page.
    """
    playable = [
        test_run for test_run in played if test_run.outcome.ending not in (Ending.HUNG, Ending.LOST)
    ]
    shown = {
        place
        for place, test_run in enumerate(playable)
        if every
        or test_run.job.test.name in also
        or test_run.job.test.mutation is not None
        or test_run.outcome.error is not None
        or differences(test_run.job.test.expected, test_run.outcome.verdicts)
    }
    cells = [_cells_of(test_run) for test_run in playable]
    # Backwards, so that of several shown tests the first one is the example of a cell.
    backwards = sorted(shown, reverse=True)
    by_cell = {cell: playable[place].job for place in backwards for cell in cells[place]}
    left = set().union(*cells) - by_cell.keys()
    while left:
        place = max(range(len(cells)), key=lambda one: (len(cells[one] & left), -one))
        shown.add(place)
        by_cell |= dict.fromkeys(cells[place] & left, playable[place].job)
        left -= cells[place]
    return Examples(tuple(playable[place].job for place in sorted(shown)), by_cell)


def _cells_of(played: Played) -> set[Cell]:
    """The cells that count a test; none if it has a planted fault."""
    job = played.job
    if job.test.mutation is not None:
        return set()
    return {(job.robot, job.test.strategy, *verdict) for verdict in played.outcome.verdicts.items()}


def comparable_jobs(job: Job, failed: Sequence[str], played: Sequence[Played]) -> list[Job]:
    """Tests to compare a failed test with, on the same robot.

    The first is the test without its planted fault, if it has one; then come tests that pass the
    failed requirements.
    """
    jobs: list[Job] = []
    if job.test.mutation is not None:
        name = f"{job.test.name} on the robot as it is"
        fixed: dict[str, object] = {"name": name, "mutation": None, "expected": {}, "reaches": {}}
        jobs = [replace(job, test=structs.replace(job.test, **fixed))]
    most = 1 if jobs else COMPARED
    for requirement in failed:
        passed = [
            test_run.job
            for test_run in played
            if test_run.job.robot == job.robot
            and test_run.job.test.mutation is None
            and test_run.outcome.verdicts.get(requirement) is Verdict.PASS
        ]
        # Directed tests come first: they show what the robot should do.
        passed.sort(key=lambda one: not one.test.expected)
        jobs.extend(passed[:most])
    return jobs


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
    """The page of a campaign, as HTML.

    `examples` has the address of an example for each cell that has one, and `tests` the addresses
    of the pages of tests, by robot and test.
    """
    robots_of: dict[tuple[str, str], list[str]] = {}
    for robot in summary.robots.values():
        for requirement in robot.requirements.items():
            robots_of.setdefault(requirement, []).append(robot.title.lower())
    common = [
        one
        for one, of in robots_of.items()
        if len(of) == len(summary.robots) and one[0] in (presentation.foremost or (one[0],))
    ]
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
        whose=" and ".join(dict.fromkeys(of for other in others for of in robots_of[other])),
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
            if any(
                strategy.statements or strategy.states for strategy in figures.strategies.values()
            )
        ],
        directed=[item for item in summary.robots.items() if item[1].known],
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
    """The table of a robot, whose counts link to examples, and the table of its controls."""
    table = table_html(
        tables.own,
        further=tables.compared,
        link=lambda *cell: examples.get((robot, *cell)),
        witnesses={
            name: tests[robot, test]
            for name, test in tables.witnesses.items()
            if (robot, test) in tests
        },
    )
    if tables.control is None or not tables.control_label:
        return table, None
    return table, table_html(tables.control, further=tables.compared)


def _silent(
    robot: str, table: VerdictTable, examples: Mapping[Cell, str]
) -> list[tuple[str, str | None]]:
    """The requirements that no test triggered, each with the page of a run that explains it."""
    silent: list[tuple[str, str | None]] = []
    for name in table.requirements:
        groups = [group for group in table.groups if name in group.counts]
        counts = [group.counts[name] for group in groups]
        tests = sum(sum(one.values()) for one in counts)
        if tests and sum(one.get(Verdict.NOT_TRIGGERED, 0) for one in counts) == tests:
            shown = (
                examples.get((robot, group.name, name, Verdict.NOT_TRIGGERED)) for group in groups
            )
            silent.append((name, next((one for one in shown if one is not None), None)))
    return silent
