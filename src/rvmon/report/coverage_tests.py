"""Tests on the page of coverage: a line each, to which all that they did leads."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Sequence

from rvmon.coverage.record import TestRecord
from rvmon.report.coverage_summary import Summary, counted, share_text
from rvmon.report.markup import Child, e, scroll
from rvmon.verdict.verdict import Verdict

MOST = 2_000
"""Lines of tests; of more tests, those have one that something is to be reported of."""

NAMED = 4
"""Items that a test is listed as having added; the rest is counted."""


def letter(verdict: Verdict) -> ET.Element:
    """A verdict in its colour."""
    return e("b", {"data-verdict": verdict.value, "class": "letter"}, verdict.value)


def test_link(summary: Summary, place: int) -> ET.Element:
    """A test's name that leads to its line."""
    return e("a", {"href": f"#t{place}"}, summary.record(place).name)


def listed_tests(summary: Summary) -> Collection[int]:
    """The tests that have a line: all, or those that are spoken of elsewhere on the page."""
    every = range(len(summary.coverage.entries))
    if len(every) <= MOST:
        return every
    wanted = {*summary.not_fine, *(step.entry for step in summary.ranking)}
    wanted.update(step.entry for step in summary.steps if step.added)
    wanted.update(place for place in every if summary.unique[place])
    wanted.update(place for place in summary.totals.first.tolist() if place >= 0)
    for place in summary.illegal:
        wanted.update(summary.hitters[place])
    seen: set[tuple[str, str, Verdict]] = set()
    for place in every:
        record = summary.record(place)
        shown = {(record.strategy, *one) for one in record.verdicts.items()}
        if not shown <= seen:
            seen |= shown
            wanted.add(place)
    return dict.fromkeys(sorted(wanted))


def tests_section(summary: Summary, listed: Collection[int]) -> ET.Element:
    """A table of tests."""
    shown = {
        "campaign": len(summary.campaigns) > 1,
        "strategy": any(summary.strategies),
        "seed": any(summary.record(place).seed is not None for place in listed),
        "recording": any(summary.record(place).recording for place in listed),
    }
    names = ["test", *(name for name, is_shown in shown.items() if is_shown)]
    names += ["ended", "verdicts", "alone", "covered then", "added"]
    head = e("tr", None, *(e("th", None, name) for name in names))
    rows = [_row(summary, place, shown) for place in listed]
    table = e("table", {"class": "tests"}, e("thead", None, head), e("tbody", None, *rows))
    rest = len(summary.coverage.entries) - len(listed)
    note = f" {counted(rest, 'test')} that added nothing and went well not listed." if rest else ""
    return e(
        "section",
        None,
        e("h2", None, "Tests"),
        e("p", {"class": "soft"}, f"Alone: items that no other test covers.{note}"),
        scroll(table),
    )


def _row(summary: Summary, place: int, shown: dict[str, bool]) -> ET.Element:
    record, step = summary.record(place), summary.steps[place]
    only = len(summary.unique[place])
    page = summary.pages.get(record.name)
    name: Child = record.name if page is None else e("a", {"href": page}, record.name)
    values = {
        "campaign": record.campaign,
        "strategy": record.strategy,
        "seed": "" if record.seed is None else str(record.seed),
        "recording": record.recording,
    }
    return e(
        "tr",
        {"id": f"t{place}"},
        e("th", {"scope": "row"}, name),
        *(e("td", {"class": "text"}, values[name]) for name, is_shown in shown.items() if is_shown),
        _ended(record),
        e("td", {"class": "text"}, *_verdicts(record)),
        e("td", None, f"{only:,}" if only else ""),
        e("td", None, share_text(step.share) if step.added else ""),
        e("td", {"class": "text added"}, _added(summary, step.added)),
    )


def _ended(record: TestRecord) -> ET.Element:
    if not record.error and record.ending == "completed":
        return e("td", {"class": "text"}, "completed")
    why = f": {record.error}" if record.error else ""
    return e("td", {"class": "text bad", "data-verdict": "F"}, f"{record.ending}{why}")


def _verdicts(record: TestRecord) -> list[Child]:
    """Who failed, and how many got each of the other verdicts."""
    groups: list[list[Child]] = []
    if record.failed:
        groups.append([letter(Verdict.FAIL), f" {', '.join(record.failed)}"])
    if known := record.failed_as_expected:
        groups.append([letter(Verdict.FAIL), f" {', '.join(known)} as expected"])
    counts = Counter(record.verdicts.values())
    groups += [
        [f"{counts[verdict]:,} ", letter(verdict)]
        for verdict in (Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED, Verdict.PASS)
        if counts[verdict]
    ]
    return [part for group in groups for part in (*group, ", ")][:-1]


def _added(summary: Summary, added: Sequence[int]) -> str:
    names = [summary.item_name(place) for place in added[:NAMED]]
    more = [f"and {len(added) - NAMED:,} more"] if len(added) > NAMED else []
    return ", ".join([*names, *more])
