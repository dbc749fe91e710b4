"""The pages of judged recordings, and their index."""

from __future__ import annotations

import os.path
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from msgspec import Struct

from rvmon.files import output_folder, write_file
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.report.attempt_panels import JudgedRun, RunPage
from rvmon.report.html import render
from rvmon.report.run_html import run_page
from rvmon.report.wording import in_short
from rvmon.trace.sample import Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.known_failures import NONE_KNOWN, KnownFailures
from rvmon.verdicts.report import Report

_BROKEN = "cannot be evaluated"
_KNOWN = "fail as known"
ASKED = "name, failed requirement, severity"  # the placeholder of the search field of the index

_GROUPS = {
    _BROKEN: _BROKEN,
    "F": "fail",
    "I": "inconclusive",
    _KNOWN: _KNOWN,
    "NT": "not triggered",
    "P": "pass",
}
"""The groups of the index in order; a recording belongs to the group of its worst verdict."""


class Listed(Struct, frozen=True):
    """A recording in the index."""

    name: str  # its display name
    page: str  # the address of its page; "" if it has none
    report: Report | None  # the verdicts; `None` if it could not be judged
    error: str = ""  # the reason why it could not be judged


class _Row(NamedTuple):
    """The row of a recording: its group, the text for searches, and a cell per requirement."""

    one: Listed
    group: str
    searched: str
    why: str
    cells: Sequence[tuple[str, Verdict, str | None, bool]]


def run_index(spec: CheckedSpec, recordings: Sequence[Listed], known: KnownFailures) -> str:
    """The index as HTML; without scripts it is complete, but cannot be filtered."""
    places = list(_GROUPS)
    rows = [_row(recording, spec, known) for recording in recordings]
    rows.sort(key=lambda row: (places.index(row.group), -len(_failed(row.one))))
    counts = Counter(row.group for row in rows)
    groups = [(group, words, counts[group]) for group, words in _GROUPS.items() if counts[group]]
    return render(
        "index.html",
        title=f"{len(recordings):,} recordings, checked against {spec.name}",
        totals=[f"{count:,} {words}" for _, words, count in groups],
        folder=_folder([recording.name for recording in recordings]),
        requirements=list(_requirements(spec, recordings)),
        asked=ASKED,
        groups=groups,
        rows=rows,
    )


def _requirements(
    spec: CheckedSpec, recordings: Sequence[Listed]
) -> Iterator[tuple[Requirement, Counter[Verdict], str]]:
    """Each requirement with its counts of verdicts, its severity and tags."""
    reports = [recording.report for recording in recordings if recording.report is not None]
    for name in reports[0].verdicts if reports else ():
        requirement = spec.requirements[name]
        about = {"severity": requirement.severity, "tags": ", ".join(requirement.tags)}
        more = "; ".join(f"{word}: {value}" for word, value in about.items() if value)
        yield requirement, Counter(report.verdicts[name] for report in reports), more


def _folder(names: Sequence[str]) -> str:
    """The common folder of all names, with its slash; "" if there is none."""
    shared = os.path.commonprefix(list(names))  # noqa: RUF071 - it is cut at a slash
    return shared[: shared.rfind("/") + 1]


def _failed(listed: Listed) -> list[str]:
    verdicts = {} if listed.report is None else listed.report.verdicts
    return [name for name, verdict in verdicts.items() if verdict is Verdict.FAIL]


def _group(listed: Listed, known: KnownFailures) -> str:
    if listed.report is None:
        return _BROKEN
    if known.failures(listed.report) or listed.report.illegal:
        return "F"
    verdicts = set(listed.report.verdicts.values())
    if Verdict.FAIL in verdicts:
        return _KNOWN
    order = (Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED)
    return next((verdict.value for verdict in order if verdict in verdicts), "P")


def _row(listed: Listed, spec: CheckedSpec, known: KnownFailures) -> _Row:
    failed = _failed(listed)
    searched = [listed.name, *failed, *dict.fromkeys(spec.requirements[n].severity for n in failed)]
    why, cells = "", []
    if listed.report is None:
        why = f"{_BROKEN}: {in_short(listed.error.removeprefix(f'{listed.name}: '))}"
    else:
        failures, expected = known.failures(listed.report), known.expected(listed.report)
        cells = [
            _cell(listed.report, name, "" if name in failures else expected.get(name, ""))
            for name in listed.report.verdicts
        ]
    return _Row(listed, _group(listed, known), " ".join(searched).strip().lower(), why, cells)


def _cell(report: Report, requirement: str, known: str) -> tuple[str, Verdict, str | None, bool]:
    """A cell: requirement, verdict, reason, and whether its failure is known."""
    verdict = report.verdicts[requirement]
    reason = f"known: {known}" if known else None
    if reason is None and verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE):
        first = next(report.of(requirement, verdict), None)
        reason = None if first is None else first.reason
    return requirement, verdict, reason, bool(known)


COMPARED = 10
"""The most recordings searched for a nearest passing attempt; each has to be read again."""

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
        folder: receives the pages; created if needed.
        spec: the specification.
        reports: one per recording.
        read: returns the samples of a recording, given its name.
        command: returns the command line that judges a recording again, given its name.
        broken: names and errors of the recordings that could not be judged.
        known: the known failures.

    Returns:
        The written files; the index, if any, is the last.
    """
    output_folder(folder)
    passing = [report for report in reports if Verdict.PASS in report.verdicts.values()]
    # Only these keep their samples open together; any other recording is read for its page alone.
    others = [_judged(report, read) for report in passing[:COMPARED]]
    several = len(reports) + len(broken) > 1
    names = _file_names([report.trace for report in reports])
    written = []
    for report, name in zip(reports, names, strict=True):
        law = f"law {report.law}"
        content = RunPage(
            run=_judged(report, read),
            spec=spec,
            command=command(report.trace),
            others=[other for other in others if other.report is not report],
            facts=[("recording", _shown(report.trace)), ("specification", f"{spec.name}, {law}")],
            back=INDEX if several else "",
            back_to="all recordings",
        )
        path = folder / name
        write_file(path, run_page(content))
        written.append(path)
    if several:
        path = folder / INDEX
        listed = [
            Listed(_shown(report.trace), name, report)
            for report, name in zip(reports, names, strict=True)
        ]
        listed += [Listed(_shown(trace), "", None, error) for trace, error in broken]
        write_file(path, run_index(spec, listed, known))
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
        # On some file systems `A.html` and `a.html` are one file.
        while name.lower() in taken:
            count += 1
            name = f"{stem}-{count}.html"
        taken.add(name.lower())
        names.append(name)
    return names
