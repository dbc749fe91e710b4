"""Tables of verdicts of many runs: their data, as CSV, LaTeX and text."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from rvmon.confidence import interval, interval_text
from rvmon.report.wording import MARKS
from rvmon.texts import shown_line
from rvmon.verdicts import Verdict

Counts = Mapping[Verdict, int]
"""By verdict, the number of runs."""


@dataclass(frozen=True, slots=True)
class RunGroup:
    """Runs that are counted together, such as those of one test generation strategy."""

    name: str
    runs: int
    counts: Mapping[str, Counts]


@dataclass(frozen=True, slots=True)
class VerdictTable:
    """Requirements down, groups of runs across, each with its counts of P, F, NT and I.

    Attributes:
        title: one line.
        requirements: id → text, in the order of the rows.
        groups: in the order of the columns.
        checked: by requirement, the result of model checking, `None` if it cannot be expressed;
            empty if nothing was checked.
        notes: remarks below the table.
        shows_intervals: whether each count comes with the confidence interval of its share;
            meaningful only if runs are drawn at random.
    """

    title: str
    requirements: Mapping[str, str]
    groups: tuple[RunGroup, ...]
    checked: Mapping[str, bool | None] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    shows_intervals: bool = False


def checked_text(holds: bool | None) -> str:
    """A result of model checking in the paper's letters: T, F, or – if not expressible."""
    return {True: "T", False: "F", None: "–"}[holds]


_FORMULA = ("=", "+", "-", "@")


def tables_csv(tables: Mapping[str, VerdictTable], *, key: str = "table") -> str:
    """Several tables as one CSV text; names are escaped by `plain`.

    Bounds of intervals are shares from 0 to 1, empty for a table that shows none.

    Args:
        tables: by their names in the first column.
        key: heading of the first column.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    bounds = []
    if any(table.shows_intervals for table in tables.values()):
        bounds = [f"{verdict.value} {end}" for verdict in Verdict for end in ("low", "high")]
    letters = [verdict.value for verdict in Verdict]
    writer.writerow([key, "strategy", "requirement", "tests", *letters, *bounds])
    for name, table in tables.items():
        for group in table.groups:
            for requirement, counts in group.counts.items():
                figures = [counts.get(verdict, 0) for verdict in Verdict]
                names = map(plain, (name, group.name, requirement))
                shares = (
                    _bounds(figures, group.runs) if table.shows_intervals else [""] * len(bounds)
                )
                writer.writerow([*names, group.runs, *figures, *shares])
    return text.getvalue()


def _bounds(counts: Sequence[int], runs: int) -> list[str]:
    if not runs:
        return [""] * 2 * len(counts)
    return [f"{bound:.4f}" for count in counts for bound in interval(count, runs)]


def plain(name: str) -> str:
    """A name that no spreadsheet takes for a formula: an apostrophe is put before such a one."""
    # `shown_line` escapes tabs and line ends, which could also start a formula or end a row.
    text = shown_line(name)
    return f"'{text}" if text.startswith(_FORMULA) else text


ZERO = "·"
"""The sign for a count of 0, so that other counts stand out."""

WIDTH = 4
"""The least width of a column of counts, in characters."""

WIDE = 7
"""The same with intervals."""

ABREAST = 14
"""The characters per verdict that the groups side by side may take within 80 columns."""


def table_text(table: VerdictTable, *, further: Mapping[str, VerdictTable] | None = None) -> Group:
    """A table as a renderable of rich.

    Args:
        table: the counts.
        further: by label, tables whose counts stand in further lines of each row; matched by
            requirement and by name of the group.
    """
    further = further or {}
    width = _width(table, *further.values())
    abreast = max(1, ABREAST // width)
    grids = [
        _grid(table, further, table.groups[first : first + abreast], width, with_checked=not first)
        for first in range(0, len(table.groups), abreast)
    ]
    notes = (Text(note, style="dim") for note in table.notes)
    return Group(Text(table.title, style="bold"), *grids, *notes)


def _width(table: VerdictTable, *others: VerdictTable) -> int:
    """The width of a column of counts: two more than the longest count."""
    counts = (
        count
        for verdict_table in (table, *others)
        for group in verdict_table.groups
        for by_verdict in group.counts.values()
        for count in by_verdict.values()
    )
    longest = len(str(max(counts, default=0)))
    return max(WIDE if table.shows_intervals else WIDTH, longest + 2)


def _grid(
    table: VerdictTable,
    further: Mapping[str, VerdictTable],
    groups: Sequence[RunGroup],
    width: int,
    *,
    with_checked: bool,
) -> Table:
    shown = {group.name for group in groups}
    others = {
        f"  {label}": verdict_table
        for label, verdict_table in further.items()
        if shown & {group.name for group in verdict_table.groups}
    }
    grid = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 2, 0, 0))
    grid.add_column("", no_wrap=True)
    # Only further the first groups, as it does not depend on the group.
    has_checked = with_checked and any(
        verdict_table.checked for verdict_table in (table, *others.values())
    )
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
    shown = checked_text(table.checked[name]) if name in table.checked else ""
    return Text(shown, style="dim" if dim else "")


def _counts_cell(table: VerdictTable, group: str, name: str, width: int, *, dim: bool) -> Text:
    """The counts of a group, and below them the intervals of their shares."""
    cell = Text()
    counts, runs = next(
        (
            (run_group.counts.get(name), run_group.runs)
            for run_group in table.groups
            if run_group.name == group
        ),
        (None, 0),
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


_SPECIAL = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "[": "{[}",  # after `\\`, these two would be read as its options
    "*": "{*}",
    "–": "--",
    "·": r"\textperiodcentered{}",
}


def table_latex(table: VerdictTable) -> str:
    r"""A table as a float with caption; the preamble needs `\usepackage{booktabs}`."""
    lead = 2 if table.checked else 1
    letters = len(Verdict)
    columns = "l" + "c" * (lead - 1) + "".join(" " + "r" * letters for _ in table.groups)
    spans = [
        rf"\multicolumn{{{letters}}}{{c}}{{{escape(group.name)} ({group.runs})}}"
        for group in table.groups
    ]
    rules = [
        rf"\cmidrule(lr){{{first}-{first + letters - 1}}}"
        for first in range(lead + 1, lead + 1 + letters * len(table.groups), letters)
    ]
    checking = ["Model"] if table.checked else []
    below = ["checking"] if table.checked else []
    heads = [verdict.value for verdict in Verdict] * len(table.groups)
    lines = [
        r"\begin{table}",
        rf"\caption{{{escape(table.title)}}}",
        r"\centering",
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        _row(["", *checking, *spans]),
        "".join(rules),
        _row(["", *below, *heads]),
        r"\midrule",
        *(row for name in table.requirements for row in _rows(table, name)),
        r"\bottomrule",
        r"\end{tabular}",
        *(rf"\par\smallskip {{\footnotesize {escape(note)}}}" for note in table.notes),
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def escape(text: str) -> str:
    r"""Text with all characters special to LaTeX escaped.

    >>> escape("50 % of hand_distance")
    '50 \\% of hand\\_distance'
    """
    return "".join(_SPECIAL.get(character, character) for character in shown_line(text))


def _rows(table: VerdictTable, name: str) -> list[str]:
    rows = [_row(_cells(table, name))]
    if table.shows_intervals:
        cells = [""] * (2 if table.checked else 1)
        for group in table.groups:
            counts = group.counts.get(name)
            shares = (
                "" if counts is None else interval_text(counts.get(verdict, 0), group.runs)
                for verdict in Verdict
            )
            cells.extend(rf"\scriptsize {escape(share)}" if share else "" for share in shares)
        rows.append(_row(cells))
    return rows


def _cells(table: VerdictTable, name: str) -> list[str]:
    cells = [escape(name)]
    if table.checked:
        cells.append(escape(checked_text(table.checked[name])) if name in table.checked else "")
    for group in table.groups:
        counts = group.counts.get(name)
        cells.extend("" if counts is None else str(counts.get(verdict, 0)) for verdict in Verdict)
    return cells


def _row(cells: list[str]) -> str:
    return " & ".join(cells) + r" \\"
