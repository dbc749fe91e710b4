"""Tables of verdicts of many runs: their data, and their output as CSV, LaTeX and text."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

from msgspec import Struct, field

from rvmon.confidence import interval, interval_text
from rvmon.report.printer import Cell, Line, Piece, Printer
from rvmon.report.wording import MARKS
from rvmon.texts import escaped_line
from rvmon.verdicts import Verdict

Counts = Mapping[Verdict, int]  # by verdict, the number of runs


class RunGroup(Struct, frozen=True):
    """Runs that are counted together, such as those of one test generation strategy."""

    name: str
    runs: int
    counts: Mapping[str, Counts]


class VerdictTable(Struct, frozen=True):
    """Requirements down, groups of runs across, each with its counts of P, F, NT and I."""

    title: str  # one line
    requirements: Mapping[str, str]  # id → text, in the order of the rows
    groups: tuple[RunGroup, ...]  # in the order of the columns
    # by requirement, the result of model checking, `None` if it cannot be expressed; empty if
    # nothing was checked
    checked: Mapping[str, bool | None] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  # remarks below the table
    # whether each count comes with the confidence interval of its share; meaningful only if runs
    # are drawn at random
    shows_intervals: bool = False

    def counts(self, group: str, requirement: str) -> Counts | None:
        """The counts of a requirement in a group; `None` if it has none there."""
        found = (one.counts.get(requirement) for one in self.groups if one.name == group)
        return next(found, None)


def checked_text(holds: bool | None) -> str:
    """A result of model checking in the paper's letters: T, F, or – if not expressible."""
    return {True: "T", False: "F", None: "–"}[holds]


_FORMULA = ("=", "+", "-", "@")


def tables_csv(tables: Mapping[str, VerdictTable]) -> str:
    """Several tables as one CSV text, with their names in the first column.

    Bounds of intervals are shares from 0 to 1; they are empty for a table without intervals.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    bounds = []
    if any(table.shows_intervals for table in tables.values()):
        bounds = [f"{verdict.value} {end}" for verdict in Verdict for end in ("low", "high")]
    letters = [verdict.value for verdict in Verdict]
    writer.writerow(["robot", "strategy", "requirement", "tests", *letters, *bounds])
    for name, table in tables.items():
        for group in table.groups:
            for requirement, counts in group.counts.items():
                figures = [counts.get(verdict, 0) for verdict in Verdict]
                names = map(plain, (name, group.name, requirement))
                shows = table.shows_intervals
                shares = _bounds(figures, group.runs) if shows else [""] * len(bounds)
                writer.writerow([*names, group.runs, *figures, *shares])
    return text.getvalue()


def _bounds(counts: Sequence[int], runs: int) -> list[str]:
    if not runs:
        return [""] * 2 * len(counts)
    return [f"{bound:.4f}" for count in counts for bound in interval(count, runs)]


def plain(name: str) -> str:
    """A name that no spreadsheet takes for a formula; an apostrophe is added where needed."""
    # `escaped_line` escapes tabs and line ends, which could also start a formula or end a row.
    text = escaped_line(name)
    return f"'{text}" if text.startswith(_FORMULA) else text


ZERO = "·"  # the sign for a count of 0, so that other counts stand out
WIDTH = 4  # the least width of a column of counts, in characters
WIDE = 7  # the least width of a column of counts with intervals
ABREAST = 14  # the characters per verdict that the groups side by side may take within 80 columns


def print_table(
    table: VerdictTable, printer: Printer, *, further: Mapping[str, VerdictTable] | None = None
) -> None:
    """Print a table of verdicts, as many groups side by side as fit.

    `further` are tables by label; their counts are printed in further lines of each row.
    """
    further = further or {}
    width = _width(table, *further.values())
    abreast = max(1, ABREAST // width)
    widths = (width - 1, *[width] * (len(Verdict) - 1))  # the gap is part of the first column
    if table.title:
        printer.sentences(table.title, "bold")
    for first in range(0, len(table.groups), abreast):
        groups = table.groups[first : first + abreast]
        _print_groups(table, further, groups, widths, printer, with_checked=not first)
    for note in table.notes:
        printer.sentences(note, "dim")


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


def _print_groups(
    table: VerdictTable,
    further: Mapping[str, VerdictTable],
    groups: Sequence[RunGroup],
    widths: Sequence[int],
    printer: Printer,
    *,
    with_checked: bool,
) -> None:
    shown = {group.name for group in groups}
    others = {
        f"  {label}": verdict_table
        for label, verdict_table in further.items()
        if shown & {group.name for group in verdict_table.groups}
    }
    # Only beside the first groups, as model checking does not depend on the group.
    tables = (table, *others.values())
    has_checked = with_checked and any(one.checked for one in tables)
    letters = _in_columns(Verdict, widths)
    titles = (f"{group.name} ({group.runs})" for group in groups)
    over = ["", *(["model"] if has_checked else []), *(f"{one:^{len(letters)}}" for one in titles)]
    heads = ["", *(["checking"] if has_checked else []), *(letters for _ in groups)]
    rows: list[list[Cell]] = []
    for name in table.requirements:
        for heading, source in {name: table, **others}.items():
            dim = "" if source is table else "dim"
            checked: list[Cell] = []
            if has_checked:
                holds = checked_text(source.checked[name]) if name in source.checked else ""
                checked = [(f"{holds:^{len('checking')}}", dim)]
            lines = [_count_lines(source, group, name, widths, dim) for group in groups]
            rows.append([(heading, dim or "bold"), *checked, *(counts for counts, _ in lines)])
            if any(shares for _, shares in lines):
                rows.append(["", *([""] if has_checked else []), *(shares for _, shares in lines)])
    printer.table(heads, rows, over=over, wraps=())


def _count_lines(
    table: VerdictTable, group: RunGroup, name: str, widths: Sequence[int], dim: str
) -> tuple[Line, Piece]:
    """The counts of a group, and the line below with the intervals of their shares."""
    counts = table.counts(group.name, name)
    if counts is None:
        return [], ""
    line: Line = []
    for verdict, width in zip(Verdict, widths, strict=True):
        count = counts.get(verdict, 0)
        style = dim or (MARKS[verdict].terminal if count else "dim")
        line.append((f"{count or ZERO:>{width}}", style))
    if not table.shows_intervals:
        return line, ""
    shares = (interval_text(counts.get(verdict, 0), group.runs) for verdict in Verdict)
    return line, (_in_columns(shares, widths), "dim")


def _in_columns(texts: Iterable[str], widths: Sequence[int]) -> str:
    return "".join(f"{text:>{width}}" for text, width in zip(texts, widths, strict=True))


_SPECIAL = {
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
    "\\": r"\textbackslash{}",
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
    return "".join(_SPECIAL.get(character, character) for character in escaped_line(text))


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
