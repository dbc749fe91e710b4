"""A campaign's figures for the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from rvmon.cdv.summary import NOTHING, BlockCoverage, CampaignSummary, RobotSummary
from rvmon.cdv.tables import INTERVALS, LEGEND, RobotTables
from rvmon.report.percent import percent_text
from rvmon.report.table import table_text
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

_WIDE = 12
"""Characters beyond which a strategy's name goes to two lines, if it has a hyphen."""


def print_summary(
    summary: CampaignSummary,
    tables: Mapping[str, RobotTables],
    console: Console,
    foremost: Sequence[str] = (),
) -> None:
    """Print requirements, the tables of all robots, the coverage of their code, known answers.

    Args:
        summary: the campaign's figures.
        tables: its verdicts, by robot.
        console: where it is printed.
        foremost: requirements that are shown, and in short; default: all, with all that there is.
    """
    for name, text in next(iter(summary.robots.values())).requirements.items():
        if not foremost or name in foremost:
            console.print(_named(name, text))
    console.print()
    if foremost:
        for robot, figures in reversed([*summary.robots.items()]):
            _print_in_short(figures, tables[robot], foremost, console)
        console.print(LEGEND, style="dim")
        console.print()
        return
    for robot, figures in summary.robots.items():
        if figures.requirements and figures.strategies:
            _print_verdicts(tables[robot], console)
            console.print(LEGEND, style="dim")
            console.print(INTERVALS, style="dim")
            console.print()
        measured = {
            "statements of its code that ran": [
                one.statements for one in figures.strategies.values()
            ],
            "branches of its code that were taken": [
                one.branches for one in figures.strategies.values()
            ],
        }
        for what, columns in measured.items():
            if any(columns):
                console.print(f"{figures.title}: {what}", style="bold")
                console.print(_shares(summary.kind, list(figures.strategies), columns))
                console.print()
    for figures in summary.robots.values():
        for line in _known(figures):
            console.print(line)


def _print_in_short(
    figures: RobotSummary, tables: RobotTables, foremost: Sequence[str], console: Console
) -> None:
    for line in _known(figures):
        console.print(line)
    whole = [sum(one.statements.values(), NOTHING) for one in figures.strategies.values()]
    if any(one.statements for one in whole):
        shares = zip(figures.strategies, map(_share, whole), strict=True)
        told = ", ".join(f"{name} {share}" for name, share in shares)
        console.print(f"{figures.title}: statements of its code that ran: {told}")
    if not (figures.requirements and figures.strategies):
        return
    counts = _together(figures)
    rest = {
        name: verdicts
        for name, verdicts in counts.items()
        if name not in foremost and not (verdicts[Verdict.FAIL] or verdicts[Verdict.INCONCLUSIVE])
    }
    own = replace(
        tables.own,
        requirements={name: "" for name in counts if name not in rest},
        notes=(),
        shows_intervals=False,
    )
    control = tables.control and replace(tables.control, shows_intervals=False)
    _print_verdicts(replace(tables, own=own, control=control), console)
    if rest:
        passed = sum(bool(verdicts[Verdict.PASS]) for verdicts in rest.values())
        console.print(
            f"{len(rest)} further requirements: {passed} passed wherever they were triggered, "
            f"{len(rest) - passed} never were; with --out all of them are in table.txt.\n"
        )


def _together(figures: RobotSummary) -> dict[str, Counter[Verdict]]:
    """Verdicts by requirement, under all strategies, but those that their tests know."""
    found: dict[str, Counter[Verdict]] = {name: Counter() for name in figures.requirements}
    for strategy in figures.strategies.values():
        for name, verdicts in strategy.counts.items():
            found[name].update(verdicts)
    for one in figures.known:
        if one.mutation is None:
            for name, verdict in one.expected.items():
                if one.verdicts[name] == verdict:
                    found[name][one.verdicts[name]] -= 1
    return found


def _named(name: str, text: str) -> Text:
    from rich.text import Text

    return Text.assemble((name, "bold"), "  ", text)


def _print_verdicts(tables: RobotTables, console: Console) -> None:
    beside = dict(tables.beside)
    if tables.control is not None and tables.control_label:
        beside = {tables.control_label: tables.control, **beside}
    console.print(table_text(tables.own, beside=beside))
    if tables.remark:
        console.print(tables.remark, style="dim")


def _shares(
    kind: str, strategies: Sequence[str], columns: Sequence[Mapping[str, BlockCoverage]]
) -> Table:
    """How much of each block ran under each strategy."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    table.add_column(kind, no_wrap=True)
    table.add_column("all", justify="right")
    for name in strategies:
        words = [name] if len(name) <= _WIDE else name.rsplit("-", 1)
        table.add_column(" ".join(words), justify="right", min_width=max(map(len, words)))
    for block, first in columns[0].items():
        table.add_row(block, str(first.statements), *(_share(one[block]) for one in columns))
    table.add_section()
    totals = [sum(one.values(), NOTHING) for one in columns]
    table.add_row("all", str(totals[0].statements), *map(_share, totals), style="bold")
    return table


def _share(block: BlockCoverage) -> str:
    return percent_text(block.covered, block.statements)


def _known(figures: RobotSummary) -> Iterator[str]:
    if not figures.known:
        return
    right = sum(one.as_expected for one in figures.known)
    planted = sum(one.mutation is not None for one in figures.known)
    yield (
        f"{figures.title}: {right} of {len(figures.known)} directed tests ended as they should, "
        f"{planted} of them with a fault planted into the robot."
    )
    for one in figures.known:
        if not one.as_expected:
            yield f"  {one.test}: {', '.join(one.wrong)}"
