"""Coverage as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.coverage import Group, Item
from rvmon.coverage.analysis import Comparison
from rvmon.language.checked.properties import BinKind
from rvmon.report.coverage_summary import Summary, cell_look, is_grid, name_of, not_fine
from rvmon.report.printer import Cell, Piece, Printer
from rvmon.report.verdict_table import print_table
from rvmon.report.wording import first_of, wrapped
from rvmon.texts import counted, percent_text, share_text
from rvmon.verdicts import Verdict

_FEW = 3
SHOWN = 10  # the most entries of a list that are printed

BAR, WIDE = 20, 64
"""Columns of a bar, and the least width of a terminal with room for one."""


def print_overview(summary: Summary, printer: Printer) -> None:
    """Print the groups, the total, the verdicts, illegal hits and failed tests."""
    printer.line((summary.name, "bold"), f"  {summary.tests_text()}")
    _print_groups(summary, printer)
    table = summary.verdicts()
    if table.requirements:
        print_table(table, printer)
    for heading, places in (
        ("illegal hits:", summary.illegal),
        ("hit, but declared unreachable:", summary.contradicted),
    ):
        hits = [f"{summary.item_name(place)}  {summary.hit_text(place)}" for place in places]
        _print_list(printer, heading, hits, style="bold red")
    faults = [
        f"{fault}  {counted(len(places), 'test')}: "
        + first_of([summary.record(place).name for place in places], _FEW)
        for fault, places in summary.faults.items()
    ]
    _print_list(printer, "problems:", faults, style="bold red")
    if summary.comparison is not None:
        _print_comparison(summary, summary.comparison, printer)


def print_holes(summary: Summary, printer: Printer) -> None:
    """Print the holes and the unreachable items, with reasons if known."""
    holes = counted(len(summary.holes), "hole")
    printer.line((f"{holes}:" if summary.holes else "no holes", "bold"))
    for place in summary.holes:
        item = summary.coverage.items[place]
        count, goal = int(summary.totals.counts[place]), int(summary.goals.goal[place])
        line = f"{name_of(item)}  {count:,} of {counted(goal, 'hit')}"
        why = "; ".join(summary.coverage.reasons.get(item, ()))
        printer.line(wrapped(f"{line}: {why}" if why else line, printer.width))
        printer.line((wrapped(f"  {summary.hole_texts[place]}", printer.width), "dim"))
    if summary.unreachable:
        printer.line(("excluded because they cannot be hit:", "bold"))
    for reason, places in summary.unreachable.items():
        names = ", ".join(map(summary.item_name, places))
        printer.line(wrapped(f"{reason}: {names}", printer.width))


def print_bins(summary: Summary, groups: Sequence[Group], printer: Printer) -> None:
    """Print the items of groups: the hits of each, and the first test that hit it."""
    for group in groups:
        score = summary.scores[group.name]
        heading = f"  {group.subject.value}, {score.covered:,} of {score.items:,} covered"
        printer.line((group.name, "bold"), heading)
        heads, rows = _grid(summary, group) if is_grid(group) else ([], [])
        if heads and printer.fits([heads, *rows]):
            axes = len(group.axes) - 1 or 1
            printer.table(heads, rows, range(axes, len(heads)))
            printer.line((_key(group), "dim"))
        else:
            _print_items(summary, group, printer)


def print_tests(summary: Summary, printer: Printer) -> None:
    """Print the tests, the items each added, and the shortest known order."""
    wide = printer.width >= WIDE
    with_strategy = wide and any(summary.strategies)
    heads = ["test", *(["strategy"] if with_strategy else []), *(["ended"] if wide else [])]
    left = len(heads)
    rows: list[list[Cell]] = []
    steps = zip(summary.coverage.entries, summary.steps, summary.unique, strict=True)
    for entry, step, only in steps:
        record, wrong = entry.record, not_fine(entry.record)
        row: list[Cell] = [record.name, *([record.strategy] if with_strategy else [])]
        row += [(wrong or record.ending.value, "bold red" if wrong else "")] if wide else []
        row += [f"{len(only):,}" if only else "", share_text(step.share) if step.added else ""]
        rows.append([*row, first_of([summary.item_name(place) for place in step.added], _FEW)])
    heads += ["alone", "share", "added"]
    printer.table(heads, rows, (left, left + 1), wraps=(*range(left), left + 2))
    printer.line(("alone: items that no other test covers", "dim"))
    names = [summary.record(step.entry).name for step in summary.ranking]
    printer.sentences(f"{summary.ranking_text()}: {first_of(names, SHOWN)}")


def _print_groups(summary: Summary, printer: Printer) -> None:
    wide = printer.width >= WIDE

    def row(name: str, what: str, covered: str, share: str, bar: list[Piece]) -> list[Cell]:
        return [name, what, covered, share, bar] if wide else [name, covered, share]

    rows = []
    for group in summary.coverage.model.groups.values():
        score = summary.scores[group.name]
        if not score.items:
            continue  # nothing in it is a goal
        name = group.name if group.weight else f"{group.name} (not in the total)"
        covered = f"{score.covered:,} of {score.items:,}"
        share, bar = percent_text(score.covered, score.items), _bar(score.covered / score.items)
        rows.append(row(name, group.subject.value, covered, share, bar))
    total = "–" if summary.is_empty else share_text(summary.share)
    printer.table(
        row("", "what", "covered", "share", []),
        rows,
        right=(2, 3) if wide else (1, 2),
        foot=row("total", "", "", total, [] if summary.is_empty else _bar(summary.share)),
        wraps=(0,),
    )


def _bar(share: float) -> list[Piece]:
    """A share as a bar: full only at 1, empty only at 0."""
    filled = round(share * BAR)
    # 99.9 % must not look like all, nor one hit of many like none.
    if 0 < share < 1:
        filled = min(max(filled, 1), BAR - 1)
    return [("█" * filled, "green"), ("░" * (BAR - filled), "dim")]


def _grid(summary: Summary, group: Group) -> tuple[list[Cell], list[list[Cell]]]:
    """The heads and rows of a cross."""
    grid = summary.grid(group)
    heads: list[Cell] = [*(grid.down or [grid.across]), *grid.columns]
    rows: list[list[Cell]] = []
    last: Sequence[str] = ()
    for bins, items in grid.rows:
        # A bin of an outer axis is printed once, in the first of its rows.
        row: list[Cell] = [
            "" if last[: i + 1] == bins[: i + 1] else name for i, name in enumerate(bins[:-1])
        ]
        row += bins[-1:] or [""]
        rows.append([*row, *("" if one is None else _cell(summary, *one) for one in items)])
        last = bins
    return heads, rows


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


def _cell(summary: Summary, place: int, item: Item) -> Piece:
    kind, count = summary.kind(place, item), int(summary.totals.counts[place])
    look, text = cell_look(kind, item.goal, count)
    return text, _STYLES[look]


def _print_items(summary: Summary, group: Group, printer: Printer) -> None:
    rows: list[list[Cell]] = []
    for place, item in summary.places(group):
        tests = int(summary.totals.tests[place])
        name = f"{item.name}{summary.kind_text(place, item)}"
        counts = [_cell(summary, place, item), f"{tests:,}" if tests else ""]
        rows.append([name, *counts, summary.first_text(place)])
    printer.table(["", "hits", "tests", "first"], rows, (1, 2), wraps=(0, 3))


def _print_comparison(summary: Summary, comparison: Comparison, printer: Printer) -> None:
    change = f": {share_text(comparison.before)} → {share_text(comparison.after)}"
    printer.line("since ", (summary.earlier_name, "bold"), change)
    for heading, items, verdict in summary.changes():
        title, style = f"{heading[0].lower()}{heading[1:]}:", _CHANGED[verdict]
        _print_list(printer, title, [*map(name_of, items)], style=style)
    changes = [
        f"{change.test}  {change.requirement}  {_letter(change.before)} → {_letter(change.after)}"
        for change in comparison.verdicts
    ]
    _print_list(printer, "verdicts that changed:", changes, style="bold")


_CHANGED = {
    Verdict.PASS: "bold green", Verdict.FAIL: "bold red", Verdict.NOT_TRIGGERED: "dim",
    Verdict.INCONCLUSIVE: "bold yellow",
}  # fmt: skip


def _print_list(printer: Printer, heading: str, lines: Sequence[str], *, style: str) -> None:
    if not lines:
        return
    printer.line((heading, style))
    for line in lines[:SHOWN]:
        printer.line(wrapped(line, printer.width))
    if len(lines) > SHOWN:
        printer.line((f"  … and {len(lines) - SHOWN:,} more: --format json has all", "dim"))


def _letter(verdict: Verdict | None) -> str:
    return "–" if verdict is None else verdict.value
