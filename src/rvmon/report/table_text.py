"""Tables of verdicts for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rvmon.report.proportion import interval_text
from rvmon.report.style import MARKS
from rvmon.report.table import RunGroup, VerdictTable, checked_text
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

ZERO = "·"
"""A count of nothing, so that the others stand out."""

WIDTH = 4
"""Characters of a column of counts, at least: two more than the longest has."""

WIDE = 7
"""The same with intervals."""

ABREAST = 14
"""Characters of a verdict's columns, of all groups that fit into 80."""


def table_text(table: VerdictTable, *, beside: Mapping[str, VerdictTable] | None = None) -> Group:
    """A table as a renderable of rich.

    Args:
        table: the counts.
        beside: by label, tables whose counts stand in further lines of each row; matched by
            requirement and by name of the group.
    """
    from rich.console import Group
    from rich.text import Text

    beside = beside or {}
    width = _width(table, *beside.values())
    abreast = max(1, ABREAST // width)
    grids = [
        _grid(table, beside, table.groups[first : first + abreast], width, with_checked=not first)
        for first in range(0, len(table.groups), abreast)
    ]
    notes = (Text(note, style="dim") for note in table.notes)
    return Group(Text(table.title, style="bold"), *grids, *notes)


def _width(table: VerdictTable, *others: VerdictTable) -> int:
    """Characters of a column of counts: no two counts run together."""
    counts = (
        count
        for one in (table, *others)
        for group in one.groups
        for by_verdict in group.counts.values()
        for count in by_verdict.values()
    )
    longest = len(str(max(counts, default=0)))
    return max(WIDE if table.shows_intervals else WIDTH, longest + 2)


def _grid(
    table: VerdictTable,
    beside: Mapping[str, VerdictTable],
    groups: Sequence[RunGroup],
    width: int,
    *,
    with_checked: bool,
) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    shown = {group.name for group in groups}
    others = {
        f"  {label}": one
        for label, one in beside.items()
        if shown & {group.name for group in one.groups}
    }
    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 2, 0, 0))
    grid.add_column("", no_wrap=True)
    has_checked = with_checked and any(one.checked for one in (table, *others.values()))
    if has_checked:
        grid.add_column(Text("model\nchecking"), justify="center")
    letters = "".join(f"{verdict.value:>{width}}" for verdict in Verdict)
    for group in groups:
        runs = f"{group.name} ({group.runs})"
        grid.add_column(Text(f"{runs:^{len(letters)}}\n{letters}"), no_wrap=True)
    for name in table.requirements:
        for heading, source in {name: table, **others}.items():
            dim = source is not table
            cells = [Text(heading, style="dim" if dim else "bold")]
            if has_checked:
                cells.append(_checked_cell(source, name, dim=dim))
            cells.extend(_counts_cell(source, group.name, name, width, dim=dim) for group in groups)
            grid.add_row(*cells)
    return grid


def _checked_cell(table: VerdictTable, name: str, *, dim: bool) -> Text:
    from rich.text import Text

    shown = checked_text(table.checked[name]) if name in table.checked else ""
    return Text(shown, style="dim" if dim else "")


def _counts_cell(table: VerdictTable, group: str, name: str, width: int, *, dim: bool) -> Text:
    """The counts of a group, and below them the intervals of their shares."""
    from rich.text import Text

    cell = Text()
    counts, runs = next(
        ((one.counts.get(name), one.runs) for one in table.groups if one.name == group), (None, 0)
    )
    for verdict in Verdict:
        count = None if counts is None else counts.get(verdict, 0)
        shown = "" if count is None else str(count) if count else ZERO
        style = "dim" if dim or not count else MARKS[verdict].terminal
        cell.append(f"{shown:>{width}}", style=style)
    if table.shows_intervals and counts is not None:
        shares = (interval_text(counts.get(verdict, 0), runs) for verdict in Verdict)
        cell.append("\n" + "".join(f"{share:>{width}}" for share in shares), style="dim")
    return cell
