"""The trace matrix: which requirement, of which source, is shown by what; a table and a page."""

from __future__ import annotations

import csv
import io
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from rvmon.evidence.about import About
from rvmon.report.markup import Child, e, page, scroll
from rvmon.report.style import MARKS
from rvmon.report.table_csv import plain
from rvmon.report.table_html import legend
from rvmon.report.wrapped import in_short
from rvmon.results.write import csv_table
from rvmon.spec.checked.specification import CheckedSpec, Requirement
from rvmon.verdict.verdict import Verdict, fold

LISTED = 100
"""Recordings, or tests, of one verdict that the page names; the table names all."""

ILLEGAL = ("illegal", "What coverpoints and crosses must not see")
"""Stands for a requirement where something of that was hit."""

Row = Mapping[str, str]
"""A row of the verdicts, by column."""


class Traced(NamedTuple):
    """What one recording, or test, says of one requirement.

    Attributes:
        robot: of a campaign.
        requirement: its id.
        text: of it.
        source: the clause that it comes from.
        severity: of it.
        by: the recording; of a campaign robot and test; empty if nothing judges it.
        verdict: its letter; empty if there is none.
        passed: how many attempts did.
        failed: likewise.
        inconclusive: likewise.
        reason: of the first failure.
        planted_fault: that the robot had; the verdict is on the fault.
        error: what was wrong with the recording or the test.
    """

    robot: str
    requirement: str
    text: str
    source: str
    severity: str
    by: str
    verdict: str
    passed: int
    failed: int
    inconclusive: int
    reason: str
    planted_fault: str
    error: str


def rows_by_item(verdicts: bytes) -> dict[str, list[Row]]:
    """The rows of verdicts as CSV, by recording; of a campaign by robot and test.

    Raises:
        ValueError, KeyError, csv.Error: they are none.
    """
    rows = csv.DictReader(io.StringIO(verdicts.decode("utf-8"), newline=""))
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row["recording"], []).append(row)
    return found


def trace_matrix(
    specs: Mapping[str, CheckedSpec], items: Mapping[str, Sequence[Row]], about: About
) -> list[Traced]:
    """What shows each requirement, in the order of the specification.

    Args:
        specs: by robot, as in `about`.
        items: what `rows_by_item` gives.
        about: the evidence.
    """
    matrix: list[Traced] = []
    for robot, spec in specs.items():
        own = {
            item: rows
            for item, rows in items.items()
            if not robot or item.partition("/")[0] == robot
        }
        for requirement in spec.requirements.values():
            matrix += _traced(requirement, robot, own, about)
        illegal = (*(robot, *ILLEGAL), "", "")
        for item, rows in own.items():
            reasons = [row["reason"] for row in rows if row["verdict"] and not row["requirement"]]
            planted = about.planted.get(item, "")
            matrix += [Traced(*illegal, item, "F", 0, 0, 0, one, planted, "") for one in reasons]
    return matrix


def _traced(
    requirement: Requirement, robot: str, items: Mapping[str, Sequence[Row]], about: About
) -> Iterator[Traced]:
    name = requirement.id
    told = (robot, name, requirement.text, requirement.source, requirement.severity)
    is_shown = False
    for item, rows in items.items():
        is_broken = any(not row["requirement"] and not row["verdict"] for row in rows)
        own = [row for row in rows if row["requirement"] == name]
        if not own and not is_broken:
            continue
        is_shown = True
        verdicts = [Verdict(row["verdict"]) for row in own]
        counts = [
            sum(row["verdict"] == letter and bool(row["attempt"]) for row in own)
            for letter in "PFI"
        ]
        verdict = "" if is_broken else fold(verdicts).value
        reason = next((row["reason"] for row in own if row["verdict"] == "F"), "")
        planted = about.planted.get(item, "")
        yield Traced(*told, item, verdict, *counts, reason, planted, rows[0]["error"])
    if not is_shown:
        yield Traced(*told, "", "", 0, 0, 0, "", "", "")


def matrix_csv(matrix: Sequence[Traced]) -> bytes:
    """The matrix as CSV, a row per requirement and recording or test."""
    rows = ([plain(cell) if isinstance(cell, str) else cell for cell in row] for row in matrix)
    return csv_table(Traced._fields, rows)


def matrix_page(matrix: Sequence[Traced], about: About) -> bytes:
    """The matrix as a page that needs nothing but itself."""
    is_campaign = about.judging is None
    what = "test" if is_campaign else "recording"
    names = {one.by for one in matrix if one.by}
    title = f"{about.name}: {len(names):,} {what}{'s' * (len(names) != 1)}"
    facts = {
        "judged by": f"rvmon {about.rvmon}, law {about.law}, Python {about.python}",
        "program": ", ".join(f"{name} {one.sha256[:16]}…" for name, one in about.programs.items()),
        "specification": ", ".join(about.specs.values()),
        "command": " ".join(about.command),
    }
    told = [e("dt", None, name) for name in facts]
    terms: list[Child] = []
    for term, (name, fact) in zip(told, facts.items(), strict=True):
        terms += [term, e("dd", None, fact)] if facts[name] else []
    sections: list[Child] = []
    for robot, rows in groupby(matrix, key=lambda one: one.robot):
        heading = e("h2", None, robot) if robot else None
        sections.append(e("section", None, heading, scroll(_table(list(rows), what))))
    return page(
        title,
        [
            e("header", None, e("h1", None, title), e("dl", {"class": "facts"}, *terms)),
            *sections,
            e("footer", None, legend(f"Number of {what}s")),
        ],
        styles=["base.css", "report.css"],
        scripts=[],
    ).encode("utf-8")


def _table(matrix: Sequence[Traced], what: str) -> ET.Element:
    words = ("requirement", "source", *(verdict.value for verdict in Verdict), f"by {what}")
    body = [_row(list(rows), what) for _, rows in groupby(matrix, key=lambda one: one.requirement)]
    head = e("thead", None, e("tr", None, *(e("th", {"scope": "col"}, word) for word in words)))
    return e("table", {"class": "verdicts"}, head, e("tbody", None, *body))


def _row(rows: Sequence[Traced], what: str) -> ET.Element:
    first = rows[0]
    own = [one for one in rows if one.by and not one.planted_fault]
    planted = [one for one in rows if one.planted_fault]
    lists: list[Child] = []
    counts: list[Child] = []
    for verdict in Verdict:
        found = [one for one in own if one.verdict == verdict.value]
        counts.append(
            e("td", {"data-verdict": verdict.value if found else None}, f"{len(found):,}")
        )
        lists.append(_list(f"{verdict.value} {MARKS[verdict].sign}", found))
    lists.append(_list("not judged", [one for one in own if not one.verdict]))
    lists.append(_list("with a planted fault", planted))
    is_bad = any(one.verdict != Verdict.PASS.value for one in own)
    details: Child = f"no {what} judges it"
    if own or planted:
        summary = e("summary", None, f"{len(own) + len(planted):,} {what}s")
        details = e("details", {"open": is_bad}, summary, *lists)
    return e(
        "tr",
        None,
        e("th", {"scope": "row", "class": "text"}, first.requirement, e("p", None, first.text)),
        e("td", {"class": "text"}, first.source or "none is named"),
        *counts,
        e("td", {"class": "text"}, details),
    )


def _list(heading: str, found: Sequence[Traced]) -> ET.Element | None:
    if not found:
        return None
    lines = [e("li", None, _line(one)) for one in found[:LISTED]]
    if len(found) > LISTED:
        lines.append(e("li", None, f"and {len(found) - LISTED:,} more in matrix.csv"))
    return e("div", None, e("b", None, f"{heading}:"), e("ul", None, *lines))


def _line(one: Traced) -> str:
    parts = [one.by, one.planted_fault, one.planted_fault and one.verdict]
    return ": ".join(part for part in (*parts, in_short(one.reason or one.error)) if part)
