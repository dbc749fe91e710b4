"""The trace matrix: which requirement, of which source, is shown by what; a table and a page."""

from __future__ import annotations

import csv
import io
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from rvmon.report.markup import Child, e, page, scroll, with_code
from rvmon.report.style import MARKS
from rvmon.report.table import plain
from rvmon.report.table_html import count_cell, legend
from rvmon.report.terminal import in_short
from rvmon.results.write import csv_table
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.rows import VerdictRow
from rvmon.verdict.verdict import Verdict, fold

LISTED = 100
"""Recordings, or tests, of one verdict that the page names; the table names all."""

Row = Mapping[str, str]
"""A row of the verdicts, by column."""


class Traced(NamedTuple):
    """What one recording, or test, says of one requirement.

    Attributes:
        robot: of a campaign.
        requirement: its id; `illegal` for what coverpoints must not see.
        text: of it.
        source: the clause that it comes from.
        by: the recording, or robot and test; empty if nothing judges it.
        verdict: its letter; empty if there is none.
        reason: of the first failure, or what was wrong with the recording or the test.
        planted_fault: that the robot had; the verdict is on the fault.
    """

    robot: str
    requirement: str
    text: str
    source: str
    by: str = ""
    verdict: str = ""
    reason: str = ""
    planted_fault: str = ""


def rows_by_item(verdicts: bytes) -> dict[str, list[Row]]:
    """The rows of verdicts as CSV, by recording; of a campaign by robot and test.

    Raises:
        ValueError, csv.Error: they are none.
    """
    rows = csv.reader(io.StringIO(verdicts.decode("utf-8"), newline=""), strict=True)
    if tuple(next(rows, ())) != VerdictRow._fields:
        raise ValueError("the columns of the verdicts are others")
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row[0], []).append(dict(zip(VerdictRow._fields, row, strict=True)))
    return found


def trace_matrix(
    specs: Mapping[str, CheckedSpec],
    items: Mapping[str, Sequence[Row]],
    planted: Mapping[str, str],
) -> list[Traced]:
    """What shows each requirement, in the order of the specification.

    Args:
        specs: by robot; of recordings by an empty name.
        items: what `rows_by_item` gives.
        planted: the faults of tests on a robot that had one, by robot and test.

    Raises:
        ValueError: a verdict is none.
    """
    matrix: list[Traced] = []
    for robot, spec in specs.items():
        own = [item for item in items if not robot or item.partition("/")[0] == robot]
        by_requirement: dict[str, dict[str, list[Row]]] = {}
        for item in own:
            for row in items[item]:
                by_requirement.setdefault(row["requirement"], {}).setdefault(item, []).append(row)
        # Without a requirement a row says that there are no verdicts, or what was hit and must not.
        other = by_requirement.get("", {})
        broken = {item for item, rows in other.items() if not all(row["verdict"] for row in rows)}
        for name, requirement in spec.requirements.items():
            heading = (robot, name, requirement.text, requirement.source)
            shown = by_requirement.get(name, {})
            traced = [
                Traced(
                    *heading, item, *_folded(shown.get(item, ()), item in broken, items[item][0])
                )
                for item in own
                if item in broken or item in shown
            ]
            matrix += traced or [Traced(*heading)]
        for item, rows in other.items():
            hits = [row["reason"] for row in rows if row["verdict"]]
            matrix += [Traced(robot, "illegal", "", "", item, "F", hit) for hit in hits]
    return [one._replace(planted_fault=planted.get(one.by, "")) for one in matrix]


def _folded(rows: Sequence[Row], is_broken: bool, first: Row) -> tuple[str, str]:
    """The verdict, and why it is none or a failure."""
    verdict = "" if is_broken else fold(Verdict(row["verdict"]) for row in rows).value
    failed = next((row["reason"] for row in rows if row["verdict"] == "F"), "")
    return verdict, failed or first["error"]


def matrix_csv(matrix: Sequence[Traced]) -> bytes:
    """The matrix as CSV, a row per requirement and recording or test."""
    return csv_table(Traced._fields, (list(map(plain, row)) for row in matrix))


def matrix_page(title: str, facts: Mapping[str, str], matrix: Sequence[Traced]) -> bytes:
    """The matrix as a page that needs nothing but itself.

    Args:
        title: of the page.
        facts: that it says first; one that is empty is left out.
        matrix: what it shows.
    """
    listed: list[Child] = []
    for name, fact in facts.items():
        listed += [e("dt", None, name), e("dd", None, fact)] if fact else []
    sections: list[Child] = []
    words = ("requirement", *(verdict.value for verdict in Verdict), "shown by")
    for robot, own in groupby(matrix, key=lambda one: one.robot):
        head = e("tr", None, *(e("th", {"scope": "col"}, word) for word in words))
        rows = [_row(list(several)) for _, several in groupby(own, key=lambda one: one.requirement)]
        table = e(
            "table", {"class": "verdicts folds"}, e("thead", None, head), e("tbody", None, *rows)
        )
        sections.append(e("section", None, e("h2", None, robot) if robot else None, scroll(table)))
    header = e("header", None, e("h1", None, title), e("dl", {"class": "facts"}, *listed))
    footer = e("footer", None, legend("Recordings, or tests, without a planted fault"))
    styles = ["base.css", "report.css"]
    return page(title, [header, *sections, footer], styles=styles, scripts=[]).encode("utf-8")


def _row(rows: Sequence[Traced]) -> ET.Element:
    """A requirement, and all that speaks of it; failures are unfolded."""
    source = rows[0].source
    cells: list[Child] = []
    lists: list[Child] = [e("div", None, rows[0].text)]
    lists += [e("div", {"class": "soft"}, f"source: {source}")] if source else []
    own = [one for one in rows if one.by and not one.planted_fault]
    for verdict, mark in MARKS.items():
        found = [one for one in own if one.verdict == verdict]
        cells.append(count_cell(verdict, len(found)))
        lists += _list(f"{mark.sign} {mark.word}", found, is_open=verdict is Verdict.FAIL)
    lists += _list("not evaluated", [one for one in own if not one.verdict], is_open=True)
    lists += _list("with a planted fault", [one for one in rows if one.planted_fault])
    if not any(one.by for one in rows):
        lists.append("nothing checks it")
    first = e("th", {"scope": "row"}, rows[0].requirement)
    return e("tr", None, first, *cells, e("td", {"class": "text purpose"}, *lists))


def _list(heading: str, found: Sequence[Traced], *, is_open: bool = False) -> Iterator[ET.Element]:
    if not found:
        return
    lines = [e("li", None, *with_code(_line(one))) for one in found[:LISTED]]
    if len(found) > LISTED:
        lines.append(e("li", None, f"and {len(found) - LISTED:,} more: see matrix.csv"))
    summary = e("summary", None, f"{len(found):,} {heading}")
    yield e("details", {"open": is_open}, summary, e("ul", None, *lines))


def _line(one: Traced) -> str:
    fault = f"{one.planted_fault}, {one.verdict}" if one.planted_fault else ""
    name = one.by.removeprefix(f"{one.robot}/") if one.robot else one.by
    return ": ".join(part for part in (name, fault, in_short(one.reason)) if part)
