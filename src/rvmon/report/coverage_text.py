"""Coverage as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rvmon.coverage import Group, combination
from rvmon.coverage.questions import Comparison
from rvmon.language.checked.properties import BinKind
from rvmon.report.coverage_summary import Summary, cell_look, is_grid, name_of, not_fine
from rvmon.report.table import table_text
from rvmon.report.wording import first_of, wrapped
from rvmon.texts import counted, percent_text, share_text
from rvmon.verdicts import Verdict

_FEW = 3
SHOWN = 10
"""The most entries of a list that are printed."""

BAR, WIDE = 20, 64
"""Columns of a bar, and the least width of a terminal with room for one."""


def print_overview(summary: Summary, console: Console) -> None:
    """Print the groups, the total, the verdicts, illegal hits and failed tests."""
    first = Text.assemble((summary.name, "bold"), f"  {summary.tests_text()}")
    console.print(first, soft_wrap=True)
    console.print(_groups(summary, console))
    table = summary.verdicts()
    if table.requirements:
        console.print(table_text(table))
        console.print()
    for heading, places in (
        ("illegal hits:", summary.illegal),
        ("hit, and said to be unreachable:", summary.contradicted),
    ):
        hits = [f"{summary.item_name(place)}  {summary.hit_text(place)}" for place in places]
        _print_list(console, heading, hits, style="bold red")
    faults = [
        f"{fault}  {counted(len(places), 'test')}: "
        + first_of([summary.record(place).name for place in places], _FEW)
        for fault, places in summary.faults.items()
    ]
    _print_list(console, "not fine:", faults, style="bold red")
    if summary.comparison is not None:
        _print_comparison(summary.comparison, summary.earlier_name, console)


def print_holes(summary: Summary, console: Console) -> None:
    """Print the holes and the unreachable items, with reasons if known."""
    holes = counted(len(summary.holes), "hole")
    console.print(f"{holes}:" if summary.holes else "no holes", style="bold")
    for place in summary.holes:
        item = summary.coverage.items[place]
        count, goal = int(summary.totals.counts[place]), int(summary.goals.goal[place])
        line = f"{name_of(item)}  {count:,} of {counted(goal, 'hit')}"
        why = "; ".join(summary.coverage.reasons.get(item, ()))
        console.print(wrapped(f"{line}: {why}" if why else line, console.width))
        console.print(wrapped(f"  {summary.hole_texts[place]}", console.width), style="dim")
    if summary.unreachable:
        console.print("excluded, as they cannot be hit:", style="bold")
    for reason, places in summary.unreachable.items():
        names = ", ".join(map(summary.item_name, places))
        console.print(wrapped(f"{reason}: {names}", console.width))


def print_bins(summary: Summary, groups: Sequence[Group], console: Console) -> None:
    """Print the items of groups: the hits of each, and the first test that hit it."""
    for group in groups:
        score = summary.scores[group.name]
        heading = f"  {group.subject.value}, {score.covered:,} of {score.items:,} covered"
        console.print(Text.assemble((group.name, "bold"), heading))
        grid = _grid(summary, group) if is_grid(group) else None
        if grid is not None and _fits(grid, console):
            console.print(grid)
            console.print(_key(group), style="dim")
        else:
            console.print(_bins(summary, group))


def print_tests(summary: Summary, console: Console) -> None:
    """Print the tests, the items each added, and the shortest known order."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    wide = console.width >= WIDE
    with_strategy = wide and any(summary.strategies)
    table.add_column("test", overflow="fold")
    if with_strategy:
        table.add_column("strategy", overflow="fold")
    if wide:
        table.add_column("ended", overflow="fold")
    table.add_column("alone", justify="right", no_wrap=True)
    table.add_column("share", justify="right", no_wrap=True)
    table.add_column("added", ratio=1, overflow="fold")
    steps = zip(summary.coverage.entries, summary.steps, summary.unique, strict=True)
    for entry, step, only in steps:
        record, wrong = entry.record, not_fine(entry.record)
        ended = Text(wrong or record.ending.value, style="bold red" if wrong else "")
        table.add_row(
            record.name,
            *((record.strategy,) if with_strategy else ()),
            *((ended,) if wide else ()),
            f"{len(only):,}" if only else "",
            share_text(step.share) if step.added else "",
            first_of([summary.item_name(place) for place in step.added], _FEW),
        )
    console.print(table)
    console.print("alone: items that no other test covers", style="dim")
    names = [summary.record(step.entry).name for step in summary.ranking]
    console.print(f"{summary.ranking_text()}: {first_of(names, SHOWN)}")


def _groups(summary: Summary, console: Console) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_footer=True)
    table.add_column("", "total", overflow="fold")
    wide = console.width >= WIDE
    if wide:
        table.add_column("what")
    table.add_column("covered", justify="right")
    total = "–" if summary.is_empty else share_text(summary.share)
    table.add_column("share", total, justify="right", no_wrap=True)
    if wide:
        table.add_column("", "" if summary.is_empty else _bar(summary.share, console), no_wrap=True)
    for group in summary.coverage.model.groups.values():
        score = summary.scores[group.name]
        if not score.items:
            continue  # nothing in it is a goal
        name = group.name if group.weight else f"{group.name} (not in the total)"
        cells: list[str | Text] = [name]
        cells += [group.subject.value] if wide else []
        cells += [f"{score.covered:,} of {score.items:,}", percent_text(score.covered, score.items)]
        cells += [_bar(score.covered / score.items, console)] if wide else []
        table.add_row(*cells)
    return table


def _bar(share: float, console: Console) -> Text:
    """A share as a bar: full only at 1, empty only at 0."""
    filled = round(share * BAR)
    # 99.9 % must not look like all, nor one hit of many like none.
    if 0 < share < 1:
        filled = min(max(filled, 1), BAR - 1)
    full, empty = ("#", ".") if console.options.ascii_only else ("█", "░")
    return Text.assemble((full * filled, "green"), (empty * (BAR - filled), "dim"))


def _fits(table: Table, console: Console) -> bool:
    """Whether no cell would be cut; rich caps a measured width at the console's, so widen that."""
    endless = console.options.update(max_width=1_000_000)
    return console.measure(table, options=endless).minimum <= console.width


def _grid(summary: Summary, group: Group) -> Table:
    """A cross: the bins of the last axis from left to right, of the others downwards."""
    *down, (across, columns) = group.axes.items()
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for axis, _ in down:
        table.add_column(axis, no_wrap=True)
    if not down:
        table.add_column(across)
    for name in columns:
        table.add_column(name, justify="right", no_wrap=True)
    places = {item.name: place for place, item in summary.places(group)}
    last: Sequence[str] = ()
    for bins in product(*(names for _, names in down)):
        # A bin of an outer axis is printed once, in the first of its rows.
        heads = ["" if last[: i + 1] == bins[: i + 1] else name for i, name in enumerate(bins[:-1])]
        row: list[str | Text] = [*heads, *bins[-1:]] if down else [""]
        for name in columns:
            place = places.get(combination([*bins, name]))
            row.append("" if place is None else _cell(summary, group, place))
        table.add_row(*row)
        last = bins
    return table


def _key(group: Group) -> str:
    """The legend of the signs that may occur in a grid."""
    kinds = {item.kind for item in group.items.values()}
    parts = ["0 hole"]
    if any(item.goal > 1 for item in group.items.values()):
        parts.append("1/3 one hit of three")
    parts += ["! illegal"] if BinKind.ILLEGAL in kinds else []
    parts += ["– ignored"] if BinKind.IGNORE in kinds else []
    return "  " + "   ".join(parts)


_STYLES = {
    **dict.fromkeys(("ignored", "illegal"), "dim"),
    "illegal hit": "bold red",
    "hole": "bold yellow",
    "covered": "green",
}


def _cell(summary: Summary, group: Group, place: int) -> Text:
    item = group.items[summary.coverage.items[place][1]]
    kind, count = summary.kind(place, item), int(summary.totals.counts[place])
    look, text = cell_look(kind, item.goal, count)
    return Text(text, style=_STYLES[look])


def _bins(summary: Summary, group: Group) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    table.add_column("hits", justify="right", no_wrap=True)
    table.add_column("tests", justify="right", no_wrap=True)
    table.add_column("first")
    for place, item in summary.places(group):
        tests = int(summary.totals.tests[place])
        table.add_row(
            Text(f"{item.name}{summary.kind_text(place, item)}"),
            _cell(summary, group, place),
            f"{tests:,}" if tests else "",
            summary.first_text(place),
        )
    return table


def _print_comparison(comparison: Comparison, name: str, console: Console) -> None:
    change = f": {share_text(comparison.before)} → {share_text(comparison.after)}"
    console.print(Text.assemble("since ", (name, "bold"), change), soft_wrap=True)
    for heading, items, style in (
        ("new illegal hits:", comparison.illegal, "bold red"),
        ("lost:", comparison.lost, "bold yellow"),
        ("newly covered:", comparison.gained, "bold green"),
        ("no longer in the model:", comparison.dropped, "dim"),
    ):
        _print_list(console, heading, [name_of(item) for item in items], style=style)
    changes = [
        f"{change.test}  {change.requirement}  {_letter(change.before)} → {_letter(change.after)}"
        for change in comparison.verdicts
    ]
    _print_list(console, "verdicts that changed:", changes, style="bold")


def _print_list(console: Console, heading: str, lines: Sequence[str], *, style: str) -> None:
    if not lines:
        return
    console.print(heading, style=style)
    for line in lines[:SHOWN]:
        console.print(wrapped(line, console.width))
    if len(lines) > SHOWN:
        console.print(f"  … and {len(lines) - SHOWN:,} more: --format json has all", style="dim")


def _letter(verdict: Verdict | None) -> str:
    return "–" if verdict is None else verdict.value
