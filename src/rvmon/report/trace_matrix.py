"""The trace matrix: for each requirement and its source, the recordings or tests that show it."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

from rvmon.language.checked.specification import CheckedSpec
from rvmon.report.html import render
from rvmon.report.verdict_table import plain
from rvmon.report.wording import MARKS, in_short
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.serialise import VerdictRow
from rvmon.verdicts.table_file import csv_table

LISTED = 100  # the most recordings or tests per verdict named on the page; the CSV names all
Row = Mapping[str, str]  # a row of the verdicts, by column


class Traced(NamedTuple):
    """The verdict on one requirement by one recording or test."""

    robot: str  # the robot of a campaign; else ""
    requirement: str  # its id; `illegal` for hits of illegal bins
    text: str  # the text of the requirement
    source: str  # the clause it comes from
    by: str = ""  # the recording, or robot and test; "" if nothing judges the requirement
    verdict: str = ""  # the letter of the verdict; "" if there is none
    reason: str = ""  # the reason of the first failure, or the error of the recording or test
    planted_fault: str = ""  # the fault planted in the robot for this test; else ""


def rows_by_item(verdicts: bytes) -> dict[str, list[Row]]:
    """The rows of a CSV file of verdicts by recording or, for a campaign, by robot and test.

    Raises:
        ValueError, csv.Error: the bytes are not such a file.
    """
    rows = csv.reader(io.StringIO(verdicts.decode("utf-8"), newline=""), strict=True)
    if tuple(next(rows, ())) != VerdictRow._fields:
        raise ValueError("the table of verdicts has other columns")
    by_item: dict[str, list[Row]] = {}
    for row in rows:
        by_item.setdefault(row[0], []).append(dict(zip(VerdictRow._fields, row, strict=True)))
    return by_item


def trace_matrix(
    specs: Mapping[str, CheckedSpec], items: Mapping[str, Sequence[Row]], planted: Mapping[str, str]
) -> list[Traced]:
    """The recordings and tests that show each requirement, in the order of the specification.

    `specs` are by robot; for recordings, the only key is "". `planted` are the planted faults by
    robot and test.

    Raises:
        ValueError: a row has an unknown verdict.
    """
    matrix: list[Traced] = []
    for robot, spec in specs.items():
        items_of_robot = [item for item in items if not robot or item.partition("/")[0] == robot]
        by_requirement: dict[str, dict[str, list[Row]]] = {}
        for item in items_of_robot:
            for row in items[item]:
                by_requirement.setdefault(row["requirement"], {}).setdefault(item, []).append(row)
        # Rows without a requirement are errors of recordings, or illegal hits.
        other = by_requirement.get("", {})
        broken = {item for item, rows in other.items() if not all(row["verdict"] for row in rows)}
        for name, requirement in spec.requirements.items():
            heading = (robot, name, requirement.text, requirement.source)
            shown = by_requirement.get(name, {})
            traced = [
                Traced(
                    *heading, item, *_folded(shown.get(item, ()), item in broken, items[item][0])
                )
                for item in items_of_robot
                if item in broken or item in shown
            ]
            matrix += traced or [Traced(*heading)]
        for item, rows in other.items():
            hits = [row["reason"] for row in rows if row["verdict"]]
            matrix += [Traced(robot, "illegal", "", "", item, "F", hit) for hit in hits]
    return [traced._replace(planted_fault=planted.get(traced.by, "")) for traced in matrix]


def _folded(rows: Sequence[Row], is_broken: bool, first: Row) -> tuple[str, str]:
    """The folded verdict of rows, and the reason of the first failure or the error."""
    verdict = "" if is_broken else fold(Verdict(row["verdict"]) for row in rows).value
    failed = next((row["reason"] for row in rows if row["verdict"] == "F"), "")
    # A broken recording has one row, which carries its error.
    return verdict, failed or first["error"]


def matrix_csv(matrix: Sequence[Traced]) -> bytes:
    """The matrix as CSV, a row per requirement and recording or test."""
    return csv_table(Traced._fields, (list(map(plain, row)) for row in matrix))


def matrix_page(title: str, facts: Mapping[str, str], matrix: Sequence[Traced]) -> bytes:
    """The matrix as a self-contained HTML page; empty facts are left out."""
    sections: dict[str, list[_Row]] = {}
    for (robot, _), rows in groupby(matrix, key=lambda one: (one.robot, one.requirement)):
        sections.setdefault(robot, []).append(_row(list(rows)))
    known = [(name, fact) for name, fact in facts.items() if fact]
    counted = "Recordings, or tests"
    if any(traced.planted_fault for traced in matrix):
        counted += ", without a planted fault"
    page = render("matrix.html", title=title, facts=known, sections=sections, counted=counted)
    return page.encode("utf-8")


class _Lines(NamedTuple):
    """The recordings or tests with one verdict: their number, and the first `LISTED`."""

    heading: str
    size: int
    lines: Sequence[str]
    is_open: bool


class _Row(NamedTuple):
    """A requirement with all recordings or tests that judge it; failures are unfolded."""

    first: Traced
    counts: Sequence[tuple[Verdict, int]]
    lists: Sequence[_Lines]


def _row(rows: Sequence[Traced]) -> _Row:
    unfaulted = [traced for traced in rows if traced.by and not traced.planted_fault]
    by_verdict = {
        verdict: [listed for listed in unfaulted if listed.verdict == verdict] for verdict in MARKS
    }
    lists = [
        _list(f"{mark.sign} {mark.word}", by_verdict[verdict], is_open=verdict is Verdict.FAIL)
        for verdict, mark in MARKS.items()
    ]
    unjudged = [listed for listed in unfaulted if not listed.verdict]
    lists.append(_list("not evaluated", unjudged, is_open=True))
    lists.append(_list("with a planted fault", [traced for traced in rows if traced.planted_fault]))
    counts = [(verdict, len(judged)) for verdict, judged in by_verdict.items()]
    return _Row(rows[0], counts, [listed for listed in lists if listed.size])


def _list(heading: str, rows: Sequence[Traced], *, is_open: bool = False) -> _Lines:
    return _Lines(heading, len(rows), [_line(traced) for traced in rows[:LISTED]], is_open)


def _line(traced: Traced) -> str:
    fault = f"{traced.planted_fault}, {traced.verdict}" if traced.planted_fault else ""
    name = traced.by.removeprefix(f"{traced.robot}/") if traced.robot else traced.by
    return ": ".join(part for part in (name, fault, in_short(traced.reason)) if part)
