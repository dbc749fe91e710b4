"""Tables of verdicts for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rvmon.report.style import MARKS
from rvmon.report.table import VerdictTable, checked_text
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

ZERO = "·"
"""A count of nothing, so that the others stand out."""

WIDTH = 4
"""Characters of a column of counts."""


def table_text(
    table: VerdictTable, *, beside: VerdictTable | None = None, beside_label: str = ""
) -> Group:
    """A table as a renderable of rich.

    Args:
        table: the counts.
        beside: a published table whose counts stand in a second line of each row; matched by
            requirement and by name of the group.
        beside_label: what that second line is called.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[Text | Table] = [
        Text(table.title, style="bold"),
        _grid(table, beside, beside_label),
    ]
    parts.extend(Text(note, style="dim") for note in table.notes)
    return Group(*parts)


def _grid(table: VerdictTable, beside: VerdictTable | None, label: str) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 2, 0, 0))
    grid.add_column("", no_wrap=True)
    has_checked = bool(table.checked or (beside is not None and beside.checked))
    if has_checked:
        grid.add_column(Text("model\nchecking"), justify="center")
    letters = "".join(f"{verdict.value:>{WIDTH}}" for verdict in Verdict)
    for group in table.groups:
        runs = f"{group.name} ({group.runs})"
        grid.add_column(Text(f"{runs:^{len(letters)}}\n{letters}"), no_wrap=True)
    for name in table.requirements:
        shown: list[tuple[str, VerdictTable, bool]] = [(name, table, False)]
        if beside is not None:
            shown.append((f"  {label}", beside, True))
        for heading, source, dim in shown:
            cells = [Text(heading, style="dim" if dim else "bold")]
            if has_checked:
                cells.append(_checked_cell(source, name, dim=dim))
            cells.extend(_counts_cell(source, group.name, name, dim=dim) for group in table.groups)
            grid.add_row(*cells)
    return grid


def _checked_cell(table: VerdictTable, name: str, *, dim: bool) -> Text:
    from rich.text import Text

    shown = checked_text(table.checked[name]) if name in table.checked else ""
    return Text(shown, style="dim" if dim else "")


def _counts_cell(table: VerdictTable, group: str, name: str, *, dim: bool) -> Text:
    from rich.text import Text

    cell = Text()
    counts = next((one.counts.get(name) for one in table.groups if one.name == group), None)
    for verdict in Verdict:
        count = None if counts is None else counts.get(verdict, 0)
        shown = "" if count is None else str(count) if count else ZERO
        style = "dim" if dim or not count else MARKS[verdict].terminal
        cell.append(f"{shown:>{WIDTH}}", style=style)
    return cell
