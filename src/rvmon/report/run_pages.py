"""Write the pages of judged recordings, and a list of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from rvmon.report.folder import made
from rvmon.report.run_html import run_page
from rvmon.report.run_index import Listed, run_index
from rvmon.report.run_page import JudgedRun, RunPage
from rvmon.results.known import NONE_KNOWN, KnownFailures
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
