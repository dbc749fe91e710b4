"""The trace matrix: which requirement, of which source, is shown by what; a table and a page."""

from __future__ import annotations

import csv
import io
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from rvmon.evidence.about import About
from rvmon.report.markup import Child, e, page, scroll, with_code
from rvmon.report.style import MARKS
from rvmon.report.table_csv import plain
from rvmon.report.table_html import legend
from rvmon.report.wrapped import in_short
from rvmon.results.write import csv_table
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.rows import VerdictRow
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
        ValueError, csv.Error: they are none.
    """
    rows = csv.reader(io.StringIO(verdicts.decode("utf-8"), newline=""), strict=True)
    if tuple(next(rows, ())) != VerdictRow._fields:
        raise ValueError("its columns are others")
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row[0], []).append(dict(zip(VerdictRow._fields, row, strict=True)))
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
        own = [item for item in items if not robot or item.partition("/")[0] == robot]
        shown: dict[str, dict[str, list[Row]]] = {}
        for item in own:
            for row in items[item]:
                shown.setdefault(row["requirement"], {}).setdefault(item, []).append(row)
        other = shown.get("", {})
        broken = {item for item, rows in other.items() if not all(row["verdict"] for row in rows)}
        for name, requirement in spec.requirements.items():
            told = (robot, name, requirement.text, requirement.source, requirement.severity)
            by = [item for item in own if item in broken or item in shown.get(name, {})]
            for item in by:
                rows = shown.get(name, {}).get(item, [])
                verdict = "" if item in broken else fold(Verdict(row["verdict"]) for row in rows)
                passed, failed, inconclusive = (
                    sum(row["verdict"] == letter and bool(row["attempt"]) for row in rows)
                    for letter in "PFI"
                )
                reason = next((row["reason"] for row in rows if row["verdict"] == "F"), "")
                after = (reason, about.planted.get(item, ""), items[item][0]["error"])
                matrix.append(Traced(*told, item, verdict, passed, failed, inconclusive, *after))
            if not by:
                matrix.append(Traced(*told, "", "", 0, 0, 0, "", "", ""))
        for item, rows in other.items():
            planted = about.planted.get(item, "")
            matrix += [
                Traced(robot, *ILLEGAL, "", "", item, "F", 0, 0, 0, row["reason"], planted, "")
                for row in rows
                if row["verdict"]
            ]
    return matrix


def matrix_csv(matrix: Sequence[Traced]) -> bytes:
    """The matrix as CSV, a row per requirement and recording or test."""
    rows = ([plain(cell) if isinstance(cell, str) else cell for cell in row] for row in matrix)
    return csv_table(Traced._fields, rows)


def matrix_page(matrix: Sequence[Traced], about: About) -> bytes:
    """The matrix as a page that needs nothing but itself."""
    what = "tests" if about.judging is None else "recordings"
    title = f"{about.name}: what shows its requirements"
    facts = {
        what: f"{len({one.by for one in matrix if one.by}):,}",
        "judged by": f"rvmon {about.rvmon}, law {about.law}, Python {about.python}",
        "sources": ", ".join(f"{name} {one.sha256[:16]}…" for name, one in about.programs.items()),
        "requirements": ", ".join(about.specs.values()),
        "command": " ".join(about.command),
    }
    told: list[Child] = []
    for name, fact in facts.items():
        told += [e("dt", None, name), e("dd", None, fact)] if fact else []
    sections: list[Child] = []
    for robot, several in groupby(matrix, key=lambda one: one.robot):
        rows = {name: list(own) for name, own in groupby(several, key=lambda one: one.requirement)}
        parts = [_part(own) for own in rows.values()]
        heading = e("h2", None, robot) if robot else None
        sections.append(e("section", None, heading, scroll(_table(rows)), *parts))
    header = e("header", None, e("h1", None, title), e("dl", {"class": "facts"}, *told))
    footer = e("footer", None, legend(f"Number of {what}"))
    styles = ["base.css", "report.css"]
    return page(title, [header, *sections, footer], styles=styles, scripts=[]).encode("utf-8")


def _table(rows: Mapping[str, Sequence[Traced]]) -> ET.Element:
    words = ("requirement", "source", *(verdict.value for verdict in Verdict), "in words")
    head = e("thead", None, e("tr", None, *(e("th", {"scope": "col"}, word) for word in words)))
    body = e("tbody", None, *(_row(name, own) for name, own in rows.items()))
    return e("table", {"class": "verdicts"}, head, body)


def _row(name: str, rows: Sequence[Traced]) -> ET.Element:
    link = e("a", {"href": f"#{rows[0].robot}-{name}"}, name)
    cells: list[Child] = [e("td", {"class": "text"}, rows[0].source or "–")]
    for verdict in Verdict:
        count = len(_found(rows, verdict.value))
        cells.append(e("td", {"data-verdict": verdict.value if count else None}, f"{count:,}"))
    cells.append(e("td", {"class": "text purpose"}, rows[0].text))
    return e("tr", None, e("th", {"scope": "row"}, link), *cells)


def _found(rows: Sequence[Traced], verdict: str) -> list[Traced]:
    """What says so, of the robot without a planted fault."""
    return [one for one in rows if one.by and one.verdict == verdict and not one.planted_fault]


def _part(rows: Sequence[Traced]) -> ET.Element:
    """All that speaks of one requirement; what is wrong with it is unfolded."""
    first = rows[0]
    lists: list[Child] = [_list("not judged", _found(rows, ""), is_open=True)]
    for verdict, mark in MARKS.items():
        is_open = verdict is Verdict.FAIL
        lists.append(
            _list(f"{mark.sign} {mark.word}", _found(rows, verdict.value), is_open=is_open)
        )
    planted = [one for one in rows if one.planted_fault]
    lists.append(_list("with a fault that was planted into the robot", planted, is_open=False))
    if not any(one.by for one in rows):
        lists.append(e("p", {"class": "soft"}, "nothing judges it"))
    heading = e("h3", {"id": f"{first.robot}-{first.requirement}"}, first.requirement)
    source = e("p", {"class": "soft"}, f"source: {first.source}") if first.source else None
    return e("div", None, heading, e("p", None, first.text), source, *lists)


def _list(heading: str, found: Sequence[Traced], *, is_open: bool) -> ET.Element | None:
    if not found:
        return None
    lines = [e("li", None, *with_code(_line(one))) for one in found[:LISTED]]
    if len(found) > LISTED:
        lines.append(e("li", None, f"and {len(found) - LISTED:,} more: see matrix.csv"))
    summary = e("summary", None, f"{len(found):,} {heading}")
    return e("details", {"open": is_open}, summary, e("ul", None, *lines))


def _line(one: Traced) -> str:
    name = one.by.removeprefix(f"{one.robot}/") if one.robot else one.by
    fault = f"{one.planted_fault}, {one.verdict}" if one.planted_fault else ""
    return ": ".join(part for part in (name, fault, in_short(one.reason or one.error)) if part)
