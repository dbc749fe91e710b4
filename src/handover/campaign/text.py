"""A campaign's figures for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.markup import escape

from handover.campaign.summary import CampaignSummary, KnownAnswer, RobotSummary
from handover.campaign.tables import ROBOTS, comparable, fitted_note, unfitted_table, verdict_table
from rvmon.report.percent import percent_text
from rvmon.report.table_text import table_text

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

LEGEND = "Number of tests: P passed, F failed, NT not triggered, I inconclusive."


def print_summary(summary: CampaignSummary, console: Console) -> None:
    """Print requirements, the tables of all robots, the coverage of their code, known answers."""
    for name, text in next(iter(summary.robots.values())).requirements.items():
        console.print(f"[bold]{name}[/]  {escape(text)}")
    console.print()
    for robot, figures in summary.robots.items():
        if figures.requirements and figures.strategies:
            _print_verdicts(summary, robot, console)
        if figures.strategies:
            console.print(f"{ROBOTS[robot]}: statements of its code that ran", style="bold")
            console.print(_statements(figures))
            console.print()
    for robot, figures in summary.robots.items():
        for line in _known(robot, figures):
            console.print(line)


def _print_verdicts(summary: CampaignSummary, robot: str, console: Console) -> None:
    table = verdict_table(summary, robot)
    unfitted = unfitted_table(summary, robot)
    paper = comparable(robot)
    beside = {}
    if paper is not None:
        beside = {"no fit": unfitted} if unfitted is not None else {}
        beside["paper"] = paper
    console.print(table_text(table, beside=beside))
    if paper is not None and unfitted is not None:
        console.print(fitted_note(table, unfitted), style="dim")
    console.print(LEGEND, style="dim")
    console.print()


def _statements(figures: RobotSummary) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    table.add_column("state", no_wrap=True)
    table.add_column("all", justify="right")
    for name in figures.strategies:
        # A policy goes to a line of its own where there is little room.
        words = name.replace("model-based-", "model-based ").split()
        table.add_column(" ".join(words), justify="right", min_width=max(map(len, words)))
    columns = list(figures.strategies.values())
    for state, block in columns[0].statements.items():
        shares = (one.statements[state] for one in columns)
        cells = [percent_text(one.covered, one.statements) for one in shares]
        table.add_row(state, str(block.statements), *cells)
    table.add_section()
    totals = [percent_text(one.total.covered, one.total.statements) for one in columns]
    table.add_row("all", str(columns[0].total.statements), *totals, style="bold")
    return table


def _known(robot: str, figures: RobotSummary) -> Iterator[str]:
    if not figures.known:
        return
    right = sum(one.as_expected for one in figures.known)
    planted = sum(one.mutation is not None for one in figures.known)
    yield (
        f"{ROBOTS[robot]}: {right} of {len(figures.known)} directed tests ended as they should, "
        f"{planted} of them with a fault planted into the robot."
    )
    for one in figures.known:
        if not one.as_expected:
            yield f"  {one.test}: {_wrong(one)}"


def _wrong(one: KnownAnswer) -> str:
    return ", ".join(
        f"{name} is {one.verdicts.get(name)}, not {verdict}"
        for name, verdict in one.expected.items()
        if one.verdicts.get(name) != verdict
    )
