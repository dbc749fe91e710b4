"""What came of closing a campaign, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rvmon.cdv.close.outcome import Added, Closed, Trade
from rvmon.coverage.holes import Goal
from rvmon.report.coverage_summary import name_of
from rvmon.report.percent import counted, percent_text, share_text
from rvmon.report.terminal import wrapped

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

SHOWN = 3
"""Goals that are named of those that a test met."""


def print_closed(closed: Closed, console: Console) -> None:
    """Print what each test added, what is open and why, and how small the suite is."""
    useful = [one for one in closed.tests if one.goals]
    if useful:
        console.print(_table(useful, closed))
    if idle := len(closed.tests) - len(useful):
        console.print(f"{counted(idle, 'further test')} added nothing.\n")
    _print_reasons("cannot be met: the model proves it:", _by_text(closed.proved), console)
    _print_reasons("cannot be met, by the campaign's argument:", _by_text(closed.argued), console)
    if closed.wrong:
        console.print("declared unreachable, and met all the same:", style="bold red")
        for goal, test in closed.wrong.items():
            console.print(wrapped(f"{name_of(goal)}, by {test}", console.width))
    if closed.open:
        console.print(f"{counted(len(closed.open), 'open goal')}:", style="bold")
        for goal, hole in closed.open.items():
            console.print(wrapped(name_of(goal), console.width))
            console.print(wrapped(f"  {hole}", console.width), style="dim")
    style = "bold red" if closed.wrong else "yellow" if closed.open else "bold green"
    left = f"; {closed.ended}" if closed.ended else ""
    console.print(
        f"{share_text(closed.share)} covered: {closed.met} of {closed.goals} goals met by "
        f"{len(closed.tests)} tests in {closed.seconds:.1f} s{left}.",
        style=style,
    )
    console.print(_suite_text(closed))
    if closed.trade is not None:
        console.print(_trade(closed.trade))


def _suite_text(closed: Closed) -> str:
    fewest = "no fewer would do"
    if closed.fewest < closed.needed:
        fewest = f"no smaller choice was found; at least {closed.fewest} are needed"
    *fewer, margin = closed.sizes
    text = f"The suite: {closed.needed} of them cover the same"
    if fewer:
        text += f", each goal by {margin} tests where so many were found"
    text += f", {fewest}"
    for one in fewer:
        text += f"; {closed.sizes[one]} would do with {counted(one, 'test')} for each"
    if kept := len(closed.suite) - closed.needed:
        why = "what went wrong" if closed.trade is None else "what went wrong, or kills a mutant"
        text += f"; {kept} more are kept for {why}"
    return f"{text}."


def _trade(trade: Trade) -> Table:
    from rich.table import Table

    title = f"Of {trade.mutants + trade.held_out} mutants of the code are killed"
    table = Table(box=None, pad_edge=False, title=title, title_justify="left", title_style="bold")
    table.add_column("by")
    chosen, held_out = f"of {trade.mutants} that choose", f"of {trade.held_out} held out"
    for heading in ("tests", chosen, held_out):
        table.add_column(heading, justify="right", no_wrap=True)
    for one in trade.choices:
        figures = (one.tests, one.killed, one.held_out)
        table.add_row(_choice_text(one.times), *map(str, figures))
    return table


def _choice_text(times: int | None) -> str:
    if times is None:
        return "the suite, with what kills more"
    return f"each goal by {counted(times, 'test')}" if times else "all that were played"


def _table(useful: Sequence[Added], closed: Closed) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    table.add_column("test", no_wrap=True)
    for title in ("new", "share"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("made from, and what it added")
    for one in useful:
        shown = ", ".join(map(name_of, one.goals[:SHOWN]))
        more = f", … and {len(one.goals) - SHOWN} more" if len(one.goals) > SHOWN else ""
        share = percent_text(one.met, closed.goals)
        name = one.played.job.test.name
        table.add_row(name, str(len(one.goals)), share, f"{one.origin}\n{shown}{more}")
    return table


def _by_text(reasons: Mapping[Goal, str]) -> dict[str, list[Goal]]:
    found: dict[str, list[Goal]] = {}
    for goal, text in reasons.items():
        found.setdefault(text, []).append(goal)
    return found


def _print_reasons(heading: str, reasons: Mapping[str, Sequence[Goal]], console: Console) -> None:
    if not reasons:
        return
    console.print(heading, style="bold")
    for text, goals in reasons.items():
        console.print(wrapped(f"{text}: {', '.join(map(name_of, goals))}", console.width))
    console.print()
