"""Tables of verdicts as HTML."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from markupsafe import Markup

from rvmon.report.pages import render
from rvmon.report.proportion import interval_text
from rvmon.report.table import Counts, VerdictTable, checked_text
from rvmon.verdict.verdict import Verdict

Link = Callable[[str, str, Verdict], str | None]
"""The address of an example behind a count, from group, requirement and verdict."""


def table_html(
    table: VerdictTable,
    *,
    beside: Mapping[str, VerdictTable] | None = None,
    link: Link | None = None,
) -> Markup:
    """A table of counts, with a line per requirement.

    Args:
        table: the counts.
        beside: by label, tables whose counts stand in further lines of each row.
        link: where a count leads to.
    """
    others = beside or {}
    text = render(
        "counts.html",
        table=table,
        others=others,
        link=link,
        has_checked=any(one.checked for one in (table, *others.values())),
        checked_text=checked_text,
        interval_text=interval_text,
        counts_in=_counts_in,
    )
    return Markup(text)  # noqa: S704 - a template escapes


def _counts_in(table: VerdictTable, group: str, requirement: str) -> Counts | None:
    return next((one.counts.get(requirement) for one in table.groups if one.name == group), None)
