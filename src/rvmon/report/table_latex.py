"""Tables of verdicts as LaTeX, in the style of the package booktabs."""

from __future__ import annotations

from rvmon.diagnostics.shown import shown_line
from rvmon.report.proportion import interval_text
from rvmon.report.table import VerdictTable, checked_text
from rvmon.verdict.verdict import Verdict

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
    "[": "{[}",  # behind the end of a row, these two would be its options
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
    r"""Text in which no character means anything to LaTeX.

    >>> escape("50 % of hand_distance")
    '50 \\% of hand\\_distance'
    """
    return "".join(_SPECIAL.get(character, character) for character in shown_line(text))


def _rows(table: VerdictTable, name: str) -> list[str]:
    """The line of a requirement, and below it that of the intervals."""
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
