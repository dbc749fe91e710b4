"""The list of judged recordings: what is wrong first, to be searched and filtered."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from rvmon.report.markup import Child, e, page, scroll
from rvmon.report.style import MARKS
from rvmon.report.table_html import legend
from rvmon.report.wrapped import in_short
from rvmon.results.known import KnownFailures
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

_BROKEN = "cannot be evaluated"
_KNOWN = "fail as is known"
_GROUPS = {
    _BROKEN: _BROKEN,
    "F": "fail",
    "I": "inconclusive",
    _KNOWN: _KNOWN,
    "NT": "not triggered",
    "P": "pass",
}
"""What a recording counts as, by what is worst about it; in the order in which they are listed."""


@dataclass(frozen=True, slots=True)
class Listed:
    """A recording in the list.

    Attributes:
        name: for people.
        page: its address; empty if it has none.
        report: the verdicts; `None` if it cannot be judged.
        error: why not.
    """

    name: str
    page: str
    report: Report | None
    error: str = ""


def run_index(spec: CheckedSpec, recordings: Sequence[Listed], known: KnownFailures) -> str:
    """Write the list; without scripts it is whole, but cannot be filtered."""
    places = list(_GROUPS)
    rows = [(_group(one, known), one) for one in recordings]
    rows.sort(key=lambda row: places.index(row[0]))
    counts = Counter(group for group, _ in rows)
    told = [f"{counts[group]:,} {words}" for group, words in _GROUPS.items() if counts[group]]
    ids = next((list(one.report.verdicts) for one in recordings if one.report is not None), [])
    head = e("tr", None, e("th", None, "recording"), *(e("th", None, name) for name in ids))
    body = e("tbody", None, *(_row(group, one, ids, known) for group, one in rows))
    table = e("table", {"class": "verdicts"}, e("thead", None, head), body)
    requirements: list[Child] = []
    for name in [name for name in ids if spec.requirements[name].text]:
        requirements += [e("dt", None, name), e("dd", None, spec.requirements[name].text)]
    title = f"{len(recordings):,} recordings, checked against {spec.name}"
    return page(
        title,
        [
            e(
                "header",
                None,
                e("h1", None, title),
                e("p", None, ", ".join(told)),
                e("dl", {"class": "facts"}, *requirements),
            ),
            e(
                "section",
                None,
                _filters(counts),
                scroll(table),
            ),
            e("footer", None, legend("Verdicts")),
        ],
        styles=["base.css", "report.css"],
        scripts=["index.js"],
    )


def _group(one: Listed, known: KnownFailures) -> str:
    """What a recording counts as."""
    if one.report is None:
        return _BROKEN
    if known.failures(one.report) or one.report.illegal:
        return "F"
    verdicts = set(one.report.verdicts.values())
    if Verdict.FAIL in verdicts:
        return _KNOWN
    order = (Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED)
    return next((one.value for one in order if one in verdicts), "P")


def _filters(counts: Counter[str]) -> ET.Element:
    """What a script makes use of; it is hidden where there is none."""
    boxes = [
        e(
            "label",
            None,
            e("input", {"type": "checkbox", "value": group, "checked": "checked"}),
            f" {words} ({counts[group]:,})",
        )
        for group, words in _GROUPS.items()
        if counts[group]
    ]
    search = e("input", {"type": "search", "placeholder": "part of a name", "aria-label": "name"})
    count = e("output", {"aria-live": "polite"})
    return e("form", {"class": "filters", "hidden": "hidden"}, search, *boxes, count)


def _row(group: str, one: Listed, ids: Sequence[str], known: KnownFailures) -> ET.Element:
    name: Child = e("a", {"href": one.page}, one.name) if one.page else one.name
    attributes = {"data-group": group, "data-name": one.name.lower()}
    first = e("th", {"scope": "row"}, name)
    if one.report is None:
        width = str(max(1, len(ids)))
        told = in_short(one.error.removeprefix(f"{one.name}: "))
        place = {"class": "text", "colspan": width, "title": one.error}
        why = e("td", place, f"{_BROKEN}: {told}")
        return e("tr", attributes, first, why)
    failures = known.failures(one.report)
    expected = known.expected(one.report)
    cells = [
        _cell(one, name, expected.get(name, "") if name not in failures else "") for name in ids
    ]
    return e("tr", attributes, first, *cells)


def _cell(one: Listed, requirement: str, known: str) -> ET.Element:
    assert one.report is not None  # noqa: S101 - as only these have cells
    verdict = one.report.verdicts[requirement]
    text = f"{verdict.value} {MARKS[verdict].sign}"
    attributes = {"data-verdict": verdict.value}
    if verdict is not Verdict.FAIL:
        return e("td", attributes, text)
    first = next(one.report.of(requirement, verdict), None)
    reason = (known and f"known: {known}") or (first.reason if first is not None else "")
    link = e("a", {"href": f"{one.page}#{requirement}", "title": reason}, text)
    return e("td", attributes, link, " known" if known else None)
