"""Measure the cost of rvmon and its peers, and write the page of results.

    python -m benchmarks.results [--quick] [--only SECTION …] [--r2u2 FOLDER] [--out FILE]

All contenders evaluate the same formulas on the same rows, one row at a time or in columns; `batch`
has 10^5 and 10^6 rows. `files` are whole processes. They compare families of formulas with reelay's
C++, which is built if g++ and Boost are installed, and read a robot's files: a large one, compared
with DuckDB, the same as other programs write it, many, and a tiny one. A ratio is the cost of the
first contender of a group over that of another, given only if both find the same failures. `cliffs`
are hard streams beside comparable easy ones. `differences` are formulas that peers read
differently. The page is printed or written to a file; `--quick` takes minutes.
"""

from __future__ import annotations

import csv
import os
import platform
import re
import statistics
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jinja2
import msgspec
from benchmarks.peers import differences
from benchmarks.peers.environment import Environment, prepare
from benchmarks.program import program, table
from benchmarks.timing import cliffs, files
from benchmarks.timing.agreement import Agreement, by_peer, compare, margins_alike
from benchmarks.timing.r2u2 import R2u2
from benchmarks.timing.race import Figure, Result, Theirs, Worker, contenders, measure, say
from benchmarks.timing.workload import FORMS, QUICK, SECTIONS, Size

HERE = Path(__file__).parent
TEMPLATE = HERE / "results.md.j2"
BUILT_FOR = ("many", "bound")
"""The sections with R2U2: only two, because it must be built for each workload."""

TITLES = {
    "online": "Online, one step per row: Timescales families",
    "many": "Many monitors on one stream of 20 signals",
    "bound": "A deadline from 10 to 100,000 rows",
    "unsteady": "Values that change and cross at every row",
    "failing": "Values that change at every row, formulas that fail at 1 % and at 30 % of them",
    "margins": "Robustness, of values that change and cross at every row",
    "batch": "Columns in memory",
    "files": "Whole processes, from the file to the verdict, on all cores",
    "cliffs": "Hard streams beside their quiet neighbours",
    "differences": "Where the peers read otherwise",
}

FLATNESS = 1.2
"""The highest allowed ratio between the cost of bound 100,000 and that of bound 10."""


@dataclass(frozen=True, slots=True)
class Goal:
    """The goal for one mode of use."""

    mode: str  # what is measured
    section: str  # whose results count
    ours: str  # label of our form
    peer: str  # label of the peer
    form: str  # of the formulas
    times: float  # required ratio of the peer's CPU time to ours, in the median of the workloads
    least: float  # required ratio on each workload
    changing: float  # only results in which at most this share of the rows changes


def run(size: Size, sections: Sequence[str], r2u2: Path | None) -> dict[str, Any]:
    """Measure the chosen sections, reporting progress; return the data of the page."""
    began, environment = time.monotonic(), prepare()
    results, agreements, tables = list[Result](), list[Agreement](), dict[str, str]()
    for section in sections:
        if section not in SECTIONS:
            say(section)
            tables[TITLES[section]] = "\n".join(TOLD[section](size, environment))
            continue
        racing = [*contenders(environment, section)]
        if r2u2 is not None and section in BUILT_FOR:
            racing.append(R2u2(r2u2))
        for workload in SECTIONS[section](size):
            say(f"{section}: {workload.name}, {workload.form}")
            result = measure(workload, racing, size.repeats, size.pass_seconds)
            results.append(result)
            if section == "margins":
                sentil = [one for one in racing if isinstance(one, Theirs)]
                agreements += [margins_alike(workload, one) for one in sentil[:1]]
            else:
                agreements += compare(workload, result.figures, racing, size.step_seconds)
        for one in racing:
            if isinstance(one, Worker):
                one.close()
    absent = dict(environment.missing)
    if r2u2 is None:
        absent["R2U2"] = "the package index has none; `--r2u2` with a clone of its repository"
    if left := [title for one, title in TITLES.items() if one not in sections]:
        absent["sections"] = "; ".join(left)
    said = content(results, agreements)
    return said | {
        "minutes": round((time.monotonic() - began) / 60),
        "machine": machine(),
        "versions": {"rvmon": f"{version('rvmon')} ({_commit()})", **environment.versions},
        "absent": absent,
        "sections": said["sections"] | tables,
    }


TOLD: Mapping[str, Callable[[Size, Environment], Iterator[str]]] = {
    "files": files.lines,
    "cliffs": lambda size, _: cliffs.lines(2 * size.rows // 5, size.repeats),
    "differences": lambda _, environment: differences.lines(environment),
}
"""The functions that make the tables of sections without a race."""


def machine() -> str:
    found = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    name = found[1] if found else platform.machine()
    python = f"{platform.python_implementation()} {platform.python_version()}"
    return f"{name}, {os.cpu_count()} cores, {platform.system()} {platform.release()}, {python}"


def _commit() -> str:
    """The measured commit, if git knows it."""
    words = ["git", "-C", str(HERE), "describe", "--always", "--dirty", "--abbrev=8"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"


def content(results: Sequence[Result], agreements: Sequence[Agreement]) -> dict[str, Any]:
    """The data of the page from figures: goals, a table per section, agreement of verdicts."""
    compared = [one for one in agreements if one.compared]
    sections: dict[str, list[Result]] = {}
    for one in results:
        sections.setdefault(TITLES[one.section], []).append(one)
    return {
        "goals": [*_met(results, compared)],
        "sections": {title: "\n".join(_section(own)) for title, own in sections.items()},
        "compared": compared,
        "agreed": [*_agreed(compared)],
        "calm": {f"{one.label} on {one.name}, {one.form}" for one in compared if not one.false},
        "remarks": {f"{one.label}: {one.remark}" for one in agreements if one.remark},
    }


def page(said: Mapping[str, Any]) -> str:
    """The page, as Markdown."""
    template = jinja2.Template(TEMPLATE.read_text("utf-8"), undefined=jinja2.StrictUndefined)
    made: str = template.render(said, table=lambda *one: "\n".join(table(*one)))
    return f"{made}\n"


def time_text(nanoseconds: float) -> str:
    """Nanoseconds in a readable unit.

    >>> time_text(1.25), time_text(430.4), time_text(25_000), time_text(3.2e6)
    ('1.2 ns', '430 ns', '25.0 µs', '3.2 ms')
    """
    for limit, unit, shown in ((10, 1, ".1f"), (1e4, 1, ".0f"), (1e6, 1e3, ".1f")):
        if nanoseconds < limit:
            return f"{nanoseconds / unit:{shown}} {'µs' if unit > 1 else 'ns'}"
    return f"{nanoseconds / 1e6:.1f} ms"


def ratio_text(ratio: float) -> str:
    """A ratio with two significant digits.

    >>> ratio_text(0.0712), ratio_text(4.96), ratio_text(231.4)
    ('0.071×', '5.0×', '231×')
    """
    if ratio < 0.995:
        return f"{ratio:.2g}×"
    return f"{ratio:.1f}×" if ratio < 99.5 else f"{ratio:.0f}×"


def _figure(result: Result, label: str) -> Figure | None:
    return next((figure for figure in result.figures if figure.label == label), None)


def _alike(compared: Sequence[Agreement], result: Result, ours: Figure, peer: Figure) -> bool:
    """Whether verdicts were compared on this workload and all agreed, also in the timed run."""
    about = (by_peer(peer.label), result.name, result.form)
    checked = [one for one in compared if (one.label, one.name, one.form) == about]
    whole = ours.rows == peer.rows == result.rows
    if whole and result.form == "past" and ours.violated != peer.violated:
        return False
    return bool(checked) and all(one.equal == one.compared for one in checked)


def _met(results: Sequence[Result], compared: Sequence[Agreement]) -> Iterator[Sequence[str]]:
    """A row for each goal."""
    rows = csv.DictReader((HERE / "goals.csv").read_text("utf-8").splitlines())
    for goal in msgspec.convert([*rows], list[Goal], strict=False):
        pairs = [
            (ours.median, peer.median)
            for result in results
            if (result.section, result.form) == (goal.section, goal.form)
            if (ours := _figure(result, goal.ours)) and (peer := _figure(result, goal.peer))
            if result.changing <= goal.changing
            if _alike(compared, result, ours, peer)
        ]
        own, other, text, mark = "–", "–", "not measured", "–"
        if pairs:
            ratios = [peer / ours for ours, peer in pairs]
            median, least = statistics.median(ratios), min(ratios)
            own, other = (time_text(statistics.median(side)) for side in zip(*pairs, strict=True))
            text = f"{ratio_text(median)} ({ratio_text(least)} to {ratio_text(max(ratios))})"
            mark = "yes" if median >= goal.times and least >= goal.least else "no"
        wanted = f"≥ {ratio_text(goal.times)}, least ≥ {ratio_text(goal.least)}"
        yield goal.mode, goal.ours, own, goal.peer, other, str(len(pairs)), text, wanted, mark
    growths = []
    for form in FORMS:
        bounds = [one for one in results if (one.section, one.form) == ("bound", form)]
        times = [f.median for one in bounds if (f := _figure(one, "rvmon step"))]
        growths += [times[-1] / times[0]] if len(times) > 1 else []
    if growths:  # the highest ratio of the cost of the longest deadline to the shortest
        flat, wanted = max(growths), f"≤ {ratio_text(FLATNESS)}"
        about = ("bound 10 to 100,000", "rvmon step", "–", "–", "–", "–")
        yield *about, ratio_text(flat), wanted, "yes" if flat <= FLATNESS else "no"


def _section(own: Sequence[Result]) -> Iterator[str]:
    """A row for each workload, and which contenders were not measured, how often and why."""
    labels = list(dict.fromkeys(figure.label for one in own for figure in one.figures))
    rows = (
        [one.name, one.form, f"{one.rows:,}", f"{100 * one.changing:.0f} %"]
        + [_cell(_figure(one, label), one) for label in labels]
        for one in own
    )
    yield from table(["workload", "form", "rows", "changing", *labels], rows)
    refused = Counter(
        f"{label}: {why}"
        for one in own
        for label, why in one.refusals
        if not why.startswith("only ")  # the other form of the same property is measured
    )
    if refused:
        told = "; ".join(f"{text} ({n})" for text, n in refused.items())
        yield from ("", f"Not measured: {told}.")


def _cell(figure: Figure | None, result: Result) -> str:
    if figure is None:
        return "–"
    text = f"{time_text(figure.median)} ({time_text(figure.least)}–{time_text(figure.most)})"
    return text if figure.rows == result.rows else f"{text}, {figure.rows:,} rows"


def _agreed(compared: Sequence[Agreement]) -> Iterator[Sequence[str]]:
    for label, form in sorted({(entry.label, entry.form) for entry in compared}):
        own = [entry for entry in compared if (entry.label, entry.form) == (label, form)]
        figures = ((1, entry.false > 0, entry.equal, entry.compared, entry.false) for entry in own)
        yield label, form, *(f"{sum(one):,}" for one in zip(*figures, strict=True))


def main(
    *,
    quick: bool = False,
    only: Sequence[str] = (*TITLES,),
    r2u2: Path | None = None,
    out: Path | None = None,
) -> None:
    """Measure all or some sections, and print or write the page."""
    names = {str(r2u2): "FOLDER", str(out): "FILE"}  # hide paths of this machine
    shown = [names.get(one, one) for one in sys.argv[1:]]
    command = " ".join(["python -m benchmarks.results", *shown])
    text = page({"command": command, **run(QUICK if quick else Size(), only, r2u2)})
    if out is None:
        print(text)
    else:
        out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
