"""Write the pages of judged recordings, and a list of them."""

from __future__ import annotations

import os.path
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rvmon.report.folder import made
from rvmon.report.markup import Child, e, page, scroll, with_code
from rvmon.report.run_html import run_page
from rvmon.report.run_page import JudgedRun, RunPage
from rvmon.report.style import MARKS
from rvmon.report.table_html import count_cell, legend
from rvmon.report.terminal import in_short
from rvmon.results.known import NONE_KNOWN, KnownFailures
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole

_BROKEN = "cannot be evaluated"
_KNOWN = "fail as is known"
ASKED = "name, failed requirement, severity"
"""What a person may type a part of."""

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
    rows.sort(key=lambda row: (places.index(row[0]), -len(_failed(row[1]))))
    counts = Counter(group for group, _ in rows)
    totals = [f"{counts[group]:,} {words}" for group, words in _GROUPS.items() if counts[group]]
    ids = next((list(one.report.verdicts) for one in recordings if one.report is not None), [])
    folder = _folder([one.name for one in recordings])
    titles = (
        e("th", {"scope": "col", "title": spec.requirements[name].text}, name) for name in ids
    )
    head = e("tr", None, e("th", {"scope": "col"}, "recording"), *titles)
    body = e("tbody", None, *(_row(group, one, ids, spec, known, folder) for group, one in rows))
    table = e("table", {"class": "verdicts"}, e("thead", None, head), body)
    title = f"{len(recordings):,} recordings, checked against {spec.name}"
    where = e("p", {"class": "soft"}, "in ", e("code", None, folder)) if folder else None
    header = e("header", None, e("h1", None, title), e("p", None, ", ".join(totals)), where)
    return page(
        title,
        [
            header,
            e("section", None, e("h2", None, "Requirements"), _totals(spec, recordings, ids)),
            e("section", None, e("h2", None, "Recordings"), _filters(counts), scroll(table)),
            e("footer", None, legend("Verdicts")),
        ],
        styles=["base.css", "report.css"],
        scripts=["index.js"],
    )


def _totals(spec: CheckedSpec, recordings: Sequence[Listed], ids: Sequence[str]) -> ET.Element:
    """Of each requirement, how many recordings have which verdict."""
    reports = [one.report for one in recordings if one.report is not None]
    words = ("requirement", *(verdict.value for verdict in Verdict), "in words")
    rows = []
    for name in ids:
        requirement = spec.requirements[name]
        counts = Counter(report.verdicts[name] for report in reports)
        cells = (count_cell(verdict, counts[verdict]) for verdict in Verdict)
        about = {"severity": requirement.severity, "tags": ", ".join(requirement.tags)}
        more = "; ".join(f"{word}: {value}" for word, value in about.items() if value)
        text = e("td", {"class": "text"}, requirement.text, e("div", {"class": "soft"}, more))
        rows.append(e("tr", None, e("th", {"scope": "row"}, name), *cells, text))
    head = e("tr", None, *(e("th", {"scope": "col"}, word) for word in words))
    body = e("tbody", None, *rows)
    return scroll(e("table", {"class": "verdicts folds"}, e("thead", None, head), body))


def _folder(names: Sequence[str]) -> str:
    """What stands before all names, up to its last slash."""
    shared = os.path.commonprefix(list(names))  # noqa: RUF071 - it is cut at a slash
    return shared[: shared.rfind("/") + 1]


def _failed(one: Listed) -> list[str]:
    verdicts = {} if one.report is None else one.report.verdicts
    return [name for name, verdict in verdicts.items() if verdict is Verdict.FAIL]


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
    search = e("input", {"type": "search", "placeholder": ASKED, "aria-label": ASKED})
    count = e("output", {"aria-live": "polite"})
    return e("form", {"class": "filters", "hidden": "hidden"}, search, *boxes, count)


def _row(
    group: str,
    one: Listed,
    ids: Sequence[str],
    spec: CheckedSpec,
    known: KnownFailures,
    folder: str,
) -> ET.Element:
    shown = one.name.removeprefix(folder)
    name: Child = e("a", {"href": one.page}, shown) if one.page else shown
    failed = _failed(one)
    asked = [one.name, *failed, *dict.fromkeys(spec.requirements[n].severity for n in failed)]
    attributes = {"data-group": group, "data-name": " ".join(asked).strip().lower()}
    first = e("th", {"scope": "row"}, name)
    if one.report is None:
        width = str(max(1, len(ids)))
        message = in_short(one.error.removeprefix(f"{one.name}: "))
        place = {"class": "text", "colspan": width, "title": one.error}
        why = e("td", place, *with_code(f"{_BROKEN}: {message}"))
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
    reason = f"known: {known}" if known else None
    if reason is None and verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE):
        first = next(one.report.of(requirement, verdict), None)
        reason = None if first is None else first.reason
    link = e("a", {"href": f"{one.page}#{requirement}", "title": reason}, text)
    return e("td", attributes, link, " known" if known else None)


COMPARED = 10
"""Recordings at most in which a nearest passing attempt is looked for: they are read again."""

INDEX = "index.html"


def write_run_pages(
    folder: Path,
    spec: CheckedSpec,
    reports: Sequence[Report],
    read: Callable[[str], Sequence[Sample]],
    command: Callable[[str], str],
    *,
    broken: Sequence[tuple[str, str]] = (),
    known: KnownFailures = NONE_KNOWN,
) -> list[Path]:
    """Write a page per recording, and `index.html` if there are several.

    Args:
        folder: made if it does not exist.
        spec: that judged them.
        reports: one per recording, named by `trace`.
        read: the samples of a recording, by its name.
        command: judges a recording again, by its name.
        broken: the other recordings, each with what is wrong with it.
        known: failures that are accepted.

    Returns:
        The files, the index last.

    Raises:
        RvmonError: the folder cannot be written to.
    """
    made(folder)
    passing = [report for report in reports if Verdict.PASS in report.verdicts.values()]
    others = [_judged(report, read) for report in passing[:COMPARED]]
    several = len(reports) + len(broken) > 1
    names = _file_names([report.trace for report in reports])
    written = []
    for report, name in zip(reports, names, strict=True):
        content = RunPage(
            run=_judged(report, read),
            spec=spec,
            command=command(report.trace),
            others=[other for other in others if other.report is not report],
            facts=(
                ("recording", _shown(report.trace)),
                ("specification", f"{spec.name}, law {report.law}"),
            ),
            back=INDEX if several else "",
        )
        path = folder / name
        write_whole(path, run_page(content))
        written.append(path)
    if several:
        path = folder / INDEX
        listed = [
            Listed(_shown(report.trace), name, report)
            for report, name in zip(reports, names, strict=True)
        ]
        listed += [Listed(_shown(trace), "", None, error) for trace, error in broken]
        write_whole(path, run_index(spec, listed, known))
        written.append(path)
    return written


def _judged(report: Report, read: Callable[[str], Sequence[Sample]]) -> JudgedRun:
    return JudgedRun(_shown(report.trace), report, read(report.trace))


def _shown(trace: str) -> str:
    return "standard input" if trace == "-" else trace


def _file_names(traces: Sequence[str]) -> list[str]:
    """A file name per recording, safe on every system and used once."""
    names: list[str] = []
    taken = {INDEX}
    for trace in traces:
        stem = re.sub(r"[^\w.-]+", "-", Path(trace).stem).strip("-.") or "recording"
        name, count = f"{stem}.html", 1
        while name.lower() in taken:
            count += 1
            name = f"{stem}-{count}.html"
        taken.add(name.lower())
        names.append(name)
    return names
