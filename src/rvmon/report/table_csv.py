"""Tables of verdicts as CSV: one row per table, group of runs and requirement."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

from rvmon.diagnostics.shown import shown_line
from rvmon.report.proportion import interval
from rvmon.report.table import VerdictTable
from rvmon.verdict.verdict import Verdict

_FORMULA = ("=", "+", "-", "@")


def tables_csv(tables: Mapping[str, VerdictTable], *, key: str = "table") -> str:
    """Several tables as one CSV text; a name that would be a formula begins with an apostrophe.

    The bounds of intervals are shares from 0 to 1; a table that shows none leaves them empty.

    Args:
        tables: by what the first column calls them.
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
    """A name that no spreadsheet takes for a formula: before such a one stands an apostrophe."""
    # Written out, a TAB or an end of line is neither the start of a formula nor the end of a row.
    text = shown_line(name)
    return f"'{text}" if text.startswith(_FORMULA) else text
