"""Write the pages of judged recordings, and a list of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from rvmon.report.folder import made
from rvmon.report.markup import Child, e, page
from rvmon.report.run_html import run_page
from rvmon.report.run_page import JudgedRun, RunPage
from rvmon.report.style import MARKS
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.sample import Sample
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict
from rvmon.writing import write_whole

COMPARED = 10
"""Recordings at most in which a nearest passing attempt is looked for: they are read again."""

INDEX = "index.html"


def write_run_pages(
    folder: Path,
    spec: CheckedSpec,
    reports: Sequence[Report],
    read: Callable[[str], Sequence[Sample]],
    command: Callable[[str], str],
) -> list[Path]:
    """Write a page per recording, and `index.html` if there are several.

    Args:
        folder: made if it does not exist.
        spec: that judged them.
        reports: one per recording, named by `trace`.
        read: the samples of a recording, by its name.
        command: judges a recording again, by its name.

    Returns:
        The files, the index last.

    Raises:
        RvmonError: the folder cannot be written to.
    """
    made(folder)
    passing = [report for report in reports if Verdict.PASS in report.verdicts.values()]
    others = [_judged(report, read) for report in passing[:COMPARED]]
    several = len(reports) > 1
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
                ("judged by", f"{spec.name}, law {report.law}"),
            ),
            back=INDEX if several else "",
        )
        path = folder / name
        write_whole(path, run_page(content))
        written.append(path)
    if several:
        path = folder / INDEX
        write_whole(path, _index(spec, reports, names))
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


def _index(spec: CheckedSpec, reports: Sequence[Report], names: Sequence[str]) -> str:
    ids = list(reports[0].verdicts)
    head = e("tr", None, e("th", None, "recording"), *(e("th", None, name) for name in ids))
    rows = [
        e(
            "tr",
            None,
            e("th", {"scope": "row"}, e("a", {"href": name}, _shown(report.trace))),
            *(_cell(report.verdicts[one]) for one in ids),
        )
        for report, name in zip(reports, names, strict=True)
    ]
    table = e("table", {"class": "verdicts"}, e("thead", None, head), e("tbody", None, *rows))
    title = f"{len(reports)} recordings, judged by {spec.name}"
    requirements: list[Child] = []
    for one in ids:
        requirements += [e("dt", None, one), e("dd", None, spec.requirements[one].text)]
    listed = e("dl", {"class": "facts"}, *requirements)
    scroll = e("div", {"class": "scroll", "tabindex": 0, "role": "group"}, table)
    body = (e("header", None, e("h1", None, title), listed), e("section", None, scroll))
    return page(title, body, styles=["base.css", "report.css"], scripts=[])


def _cell(verdict: Verdict) -> Child:
    text = f"{verdict.value} {MARKS[verdict].sign}"
    return e("td", {"data-verdict": verdict.value}, text)
