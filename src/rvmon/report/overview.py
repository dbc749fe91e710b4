"""All requirements over the whole recording: what became of each, and the way to it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from itertools import groupby, islice

from rvmon.report.marks import PLACES
from rvmon.report.markup import Child, e
from rvmon.report.panel import Panel
from rvmon.report.run_page import RunPage
from rvmon.report.style import MARKS
from rvmon.report.timeline import axis_row
from rvmon.report.track_rows import place_of
from rvmon.report.view import View
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

WORST_FIRST = (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS, Verdict.NOT_TRIGGERED)

MOST_DRAWN = 5_000
"""Attempts per requirement and verdict that are drawn: each is explained when it is looked at."""


def overview(content: RunPage, panels: Sequence[Panel], view: View) -> ET.Element:
    """A row per requirement, the worst first, which leads to its worst attempt.

    Args:
        content: of the page.
        panels: that it shows.
        view: the whole run.
    """
    report = content.run.report
    worst: dict[str, Panel] = {}
    for panel in sorted(panels, key=lambda one: WORST_FIRST.index(one.verdict)):
        worst.setdefault(panel.requirement, panel)
    rows: list[Child] = [
        _row(report, name, worst[name].id, view)
        for name in sorted(worst, key=lambda name: WORST_FIRST.index(report.verdicts[name]))
    ]
    marks = (e("div", {"class": "here"}), e("div", {"class": "cursor"}))
    overlay = e("div", {"class": "overlay"}, *marks)
    timeline = e("div", {"class": "timeline"}, *rows, axis_row(view, report.origin), overlay)
    back = e("a", {"class": "back", "href": content.back}, "← all tests") if content.back else None
    cut = [
        name
        for name, counts in report.counts.items()
        if any(count > MOST_DRAWN for count in counts.values())
    ]
    sentence = f"Of {', '.join(cut)} the first {MOST_DRAWN:,} attempts of each verdict are drawn."
    note = e("p", {"class": "soft"}, sentence) if cut else None
    box = e("div", {"class": "all"}, timeline)
    return e("nav", {"aria-label": "requirements"}, back, box, note)


def _row(report: Report, name: str, address: str, view: View) -> ET.Element:
    verdict = report.verdicts[name]
    sign = e("span", {"class": "letter"}, f" {verdict.value} {MARKS[verdict].sign}")
    bars = (
        e("span", {"class": "bar", "data-verdict": shown.value, "style": place_of(left, width)})
        for left, width, shown in _bars(report, name, view)
    )
    return e(
        "a",
        {"class": "row", "href": f"#{address}", "data-verdict": verdict.value},
        e("span", {"class": "name"}, e("b", None, name), sign),
        e("span", {"class": "plot"}, *bars),
    )


def _bars(report: Report, name: str, view: View) -> Iterator[tuple[float, float, Verdict]]:
    """Left edge, width and verdict of where attempts ran; where several did, the worst."""
    places: list[Verdict | None] = [None] * PLACES
    for verdict in (Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.FAIL):
        for attempt in islice(report.of(name, verdict), MOST_DRAWN):
            until = view.end if attempt.decided is None else attempt.decided
            first, last = (
                min(max(int(view.fraction(instant) * PLACES), 0), PLACES - 1)
                for instant in (attempt.triggered, until)
            )
            places[first : last + 1] = [verdict] * (last + 1 - first)
    at = 0
    for shown, group in groupby(places):
        count = len(list(group))
        if shown is not None:
            yield at / PLACES, count / PLACES, shown
        at += count
