"""Tables of verdicts as HTML."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping

from rvmon.report.markup import Child, e, scroll
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
    witnesses: Mapping[str, str] | None = None,
) -> ET.Element:
    """A table with a thin bar per row and group that shows the shares of the verdicts.

    Args:
        table: the counts.
        beside: by label, tables whose counts stand in further lines of each row.
        link: where a count leads to.
        witnesses: by requirement, the address of a run that shows what model checking says.
    """
    others = beside or {}
    has_checked = any(one.checked for one in (table, *others.values()))
    body: list[Child] = []
    for name, text in table.requirements.items():
        heading = e("th", {"scope": "row", "title": text}, name)
        rows = [_row(table, name, heading, link, has_checked=has_checked)]
        if name in table.checked and name in (witnesses or {}):
            _lead(rows[0][1], (witnesses or {})[name], f"the witness of {name}, played")
        for label, other in others.items():
            heading = e("th", {"scope": "row"}, label)
            rows.append(_row(other, name, heading, None, has_checked=has_checked, like=table))
        for row in rows[1:]:
            row.set("class", "beside")
        body.append(e("tbody", None, *rows))
    grid = e("table", {"class": "counts"}, _head(table, has_checked=has_checked), *body)
    return scroll(grid)


def _lead(cell: ET.Element, address: str, title: str) -> None:
    """Make a link of what a cell says."""
    text, cell.text = cell.text, None
    cell.append(e("a", {"href": address, "title": title}, text))


def legend(of: str = "Number of tests") -> ET.Element:
    """What the letters stand for.

    Args:
        of: what they are written beside.
    """
    words = {
        Verdict.PASS: "passed",
        Verdict.FAIL: "failed",
        Verdict.NOT_TRIGGERED: "not triggered",
        Verdict.INCONCLUSIVE: "inconclusive",
    }
    parts: list[Child] = []
    for verdict, word in words.items():
        parts += [e("b", {"data-verdict": verdict.value}, verdict.value), f" {word}   "]
    return e("p", {"class": "soft"}, f"{of}: ", *parts)


def count_cell(verdict: Verdict, count: int) -> ET.Element:
    """How many have a verdict; none is no reason for colour."""
    attributes = {"data-verdict": verdict.value, "class": None if count else "zero"}
    return e("td", attributes, f"{count:,}")


def _head(table: VerdictTable, *, has_checked: bool) -> ET.Element:
    letters = len(Verdict)
    top: list[Child] = [e("th")]
    below: list[Child] = [e("th")]
    if has_checked:
        top.append(e("th", {"rowspan": 2, "class": "checked"}, "model checking"))
    for group in table.groups:
        tests = e("small", None, f" {group.runs}")
        top.append(e("th", {"colspan": letters, "scope": "colgroup"}, group.name, tests))
        below.extend(
            e("th", {"scope": "col", "data-verdict": verdict.value}, verdict.value)
            for verdict in Verdict
        )
    return e("thead", None, e("tr", None, *top), e("tr", None, *below))


def _row(
    table: VerdictTable,
    name: str,
    heading: ET.Element,
    link: Link | None,
    *,
    has_checked: bool,
    like: VerdictTable | None = None,
) -> ET.Element:
    """One line of counts; `like` gives the groups to be shown, by name."""
    cells: list[Child] = [heading]
    if has_checked:
        shown = checked_text(table.checked[name]) if name in table.checked else ""
        cells.append(e("td", {"class": "checked"}, shown))
    for group in (like or table).groups:
        counts = next(
            (one.counts.get(name) for one in table.groups if one.name == group.name), None
        )
        runs = group.runs if table.shows_intervals else 0
        cells.extend(_cells(counts, runs, group.name, name, link))
    return e("tr", None, *cells)


def _cells(
    counts: Counts | None, runs: int, group: str, name: str, link: Link | None
) -> list[ET.Element]:
    """The counts of a group, each with its interval, unless `runs` is 0."""
    if counts is None:
        return [e("td", {"colspan": len(Verdict), "class": "none"}, "–")]
    cells = []
    for verdict in Verdict:
        count = counts.get(verdict, 0)
        address = link(group, name, verdict) if link is not None and count else None
        shown: Child = str(count)
        if address is not None:
            title = f"an example of {name} {verdict.value}"
            shown = e("a", {"href": address, "title": title}, str(count))
        kind = None if count else "zero"
        share = e("small", None, interval_text(count, runs)) if runs else None
        cells.append(e("td", {"data-verdict": verdict.value, "class": kind}, shown, share))
    return cells
