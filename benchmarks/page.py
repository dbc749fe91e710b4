"""All that one run of the benchmarks found, and the page of it."""

from __future__ import annotations

import platform
import statistics
import subprocess
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path

from benchmarks.timing.agreement import Agreement
from benchmarks.timing.measure import Figure, Result
from jinja2 import Environment, StrictUndefined

TEMPLATE = Path(__file__).with_name("results.md.j2")

TITLES = {
    "online": "Online, one step per row: Timescales families",
    "robot": "Online, one step per row: a robot's requirements",
    "many": "Many monitors on one stream of 20 signals",
    "bound": "A deadline from 10 to 100,000 rows",
    "unsteady": "Values that change and cross at every row",
    "failing": "Values that change at every row, formulas that fail at 1 % and at 30 % of them",
    "margins": "Robustness, of values that change and cross at every row",
    "batch": "Columns in memory",
    "process": "Whole processes, from the file to the verdict",
}


@dataclass(frozen=True, slots=True)
class Goal:
    """What is to be reached in one mode.

    Attributes:
        mode: what is measured.
        section: whose results count.
        ours: label of our form.
        peer: label of the peer.
        form: of the formulas.
        times: the peer is to need so many times our CPU time, in the median of the workloads,
        least: and at least so many times on each of them.
        changing: only results where at most this share of the rows changes.
    """

    mode: str
    section: str
    ours: str
    peer: str
    form: str
    times: float
    least: float
    changing: float = 1.0


GOALS = (
    Goal("online, one step from Python", "online", "rvmon step", "sentil", "future", 3, 2),
    Goal("online, one step from Python", "online", "rvmon step", "reelay", "past", 8, 5),
    Goal("online, one step from Python", "online", "rvmon step", "mstlo", "future", 5, 2),
    Goal("online, one step from Python", "online", "rvmon step", "rtamt", "past", 300, 300),
    Goal("online, only what changed", "online", "rvmon step, changes", "reelay", "past", 8, 5),
    Goal("values that change at every row", "unsteady", "rvmon step", "sentil", "future", 3, 2),
    Goal("values that change at every row", "unsteady", "rvmon step", "mstlo", "future", 5, 2),
    Goal("formulas that fail at 1 % and 30 %", "failing", "rvmon step", "sentil", "future", 3, 2),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "sentil", "future", 3, 2),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "reelay", "past", 8, 5),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "mstlo", "future", 5, 2),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "sentil", "future", 3, 2),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "reelay", "past", 8, 5),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "R2U2 C, memory", "future", 2, 1.5),
    Goal("a deadline of 10 to 100,000 rows", "bound", "rvmon step", "sentil", "future", 3, 2),
    Goal("robustness, each sample", "margins", "rvmon, each sample", "sentil", "future", 1.5, 1),
    Goal("robustness, one attempt", "margins", "rvmon, one attempt", "sentil", "future", 1.5, 1),
    Goal("robustness, columns", "margins", "rvmon offline", "sentil offline", "future", 1, 1),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay", "past", 30, 30),
    Goal(
        "batch in memory, ≤ 10 % of rows change",
        "batch",
        "rvmon evaluate",
        "reelay C++",
        "past",
        5,
        5,
        changing=0.1,
    ),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay C++", "past", 1.5, 1.5),
    Goal("whole process, CSV", "process", "rvmon run, csv", "reelay C++, csv", "past", 0.5, 0.5),
    Goal(
        "whole process, Parquet", "process", "rvmon run, parquet", "reelay, parquet", "past", 5, 5
    ),
)

FLATNESS = 1.2
"""The most by which bound 100,000 may cost more than bound 10."""


@dataclass(frozen=True, slots=True)
class Findings:
    """One run.

    Attributes:
        command: that prints it.
        peers: their versions by name.
        results: all measured workloads.
        agreements: by contender and workload.
        differences: lines of the table of readings.
        tables: titles, and lines below them: whole files, what grows.
        absent: what was not measured, and why.
        minutes: that it took.
    """

    command: str
    peers: dict[str, str]
    results: tuple[Result, ...] = ()
    agreements: tuple[Agreement, ...] = ()
    differences: tuple[str, ...] = ()
    tables: tuple[tuple[str, tuple[str, ...]], ...] = ()
    absent: dict[str, str] = field(default_factory=dict)
    minutes: int = 0


def machine() -> str:
    name = platform.processor() or platform.machine()
    for line in _lines(Path("/proc/cpuinfo")):
        if line.startswith("model name"):
            name = line.partition(":")[2].strip()
            break
    cores = sum(line.startswith("processor") for line in _lines(Path("/proc/cpuinfo")))
    python = f"{platform.python_implementation()} {platform.python_version()}"
    return f"{name}, {cores} cores, {platform.system()} {platform.release()}, {python}"


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def commit() -> str:
    """The commit that is measured, as far as git knows it."""
    words = ["git", "-C", str(TEMPLATE.parent), "describe", "--always", "--dirty", "--abbrev=8"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    return done.stdout.strip() or "unknown"


def render(findings: Findings) -> str:
    """The page, Markdown."""
    environment = Environment(  # noqa: S701 - it is no page of HTML
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True, undefined=StrictUndefined
    )
    compared = [entry for entry in findings.agreements if entry.compared]
    return environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        found=findings,
        machine=machine(),
        versions={"rvmon": f"{version('rvmon')} ({commit()})", **findings.peers},
        goals=list(_goals(findings)),
        sections=list(_sections(findings.results)),
        agreed=list(_agreed(compared)),
        remarks=list(_remarks(findings.agreements, compared)),
    )


def time_text(nanoseconds: float) -> str:
    """Nanoseconds in a unit that people read.

    >>> time_text(1.25), time_text(430.4), time_text(25_000), time_text(3.2e6)
    ('1.2 ns', '430 ns', '25.0 µs', '3.2 ms')
    """
    if nanoseconds < 10:
        return f"{nanoseconds:.1f} ns"
    if nanoseconds < 10_000:
        return f"{nanoseconds:.0f} ns"
    if nanoseconds < 1e6:
        return f"{nanoseconds / 1e3:.1f} µs"
    return f"{nanoseconds / 1e6:.1f} ms"


def ratio_text(ratio: float) -> str:
    """A ratio with two digits that count.

    >>> ratio_text(0.0712), ratio_text(4.96), ratio_text(231.4)
    ('0.071×', '5.0×', '231×')
    """
    if ratio < 0.995:
        return f"{ratio:.2g}×"
    return f"{ratio:.1f}×" if ratio < 99.5 else f"{ratio:.0f}×"


def _figure(result: Result, label: str) -> Figure | None:
    return next((figure for figure in result.figures if figure.label == label), None)


def _alike(agreements: Sequence[Agreement], result: Result, ours: Figure, peer: Figure) -> bool:
    """Whether verdicts were compared on this workload, and all and the timed ones were the same."""
    here = [a for a in agreements if a.form == result.form and a.name == result.name and a.compared]
    name = peer.label.split()[0].rstrip(",")
    checked = [a for a in here if a.label == name]
    whole = ours.rows == peer.rows == result.rows
    if whole and result.form == "past" and ours.violated != peer.violated:
        return False
    return bool(checked) and all(a.equal == a.compared for a in checked)


def _goals(findings: Findings) -> Iterator[tuple[str, ...]]:
    for goal in GOALS:
        pairs = [
            (ours.median, peer.median)
            for result in findings.results
            if result.section == goal.section and result.form == goal.form
            if (ours := _figure(result, goal.ours)) and (peer := _figure(result, goal.peer))
            if result.changing <= goal.changing
            if _alike(findings.agreements, result, ours, peer)
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
    flat = _flatness(findings)
    if flat is not None:
        wanted, mark = f"≤ {ratio_text(FLATNESS)}", "yes" if flat <= FLATNESS else "no"
        mode = "bound 10 to 100,000"
        yield mode, "rvmon step", "–", "–", "–", "–", ratio_text(flat), wanted, mark


def _flatness(findings: Findings) -> float | None:
    """The most that the longest deadline costs over the shortest, of both forms."""
    growths = []
    for form in ("past", "future"):
        times = [
            figure.median
            for result in findings.results
            if result.section == "bound" and result.form == form
            for figure in result.figures
            if figure.label == "rvmon step"
        ]
        if len(times) > 1:
            growths.append(times[-1] / times[0])
    return max(growths, default=None)


Section = tuple[str, list[str], list[list[str]], list[str]]
"""Title, contenders, rows, and who did not take part in how many workloads, and why."""


def _sections(results: Sequence[Result]) -> Iterator[Section]:
    for section, title in TITLES.items():
        own = [result for result in results if result.section == section]
        if not own:
            continue
        labels = list(dict.fromkeys(figure.label for one in own for figure in one.figures))
        rows = [
            [one.name, one.form, f"{one.rows:,}", f"{100 * one.changing:.0f} %"]
            + [_cell(_figure(one, label), one) for label in labels]
            for one in own
        ]
        refused = Counter(
            f"{label}: {why}"
            for one in own
            for label, why in one.refusals
            if not why.startswith("only ")  # the other form of the same property is measured
        )
        yield title, labels, rows, [f"{text} ({n})" for text, n in refused.items()]


def _cell(figure: Figure | None, result: Result) -> str:
    if figure is None:
        return "–"
    text = f"{time_text(figure.median)} ({time_text(figure.least)}–{time_text(figure.most)})"
    return text if figure.rows == result.rows else f"{text}, {figure.rows:,} rows"


def _agreed(compared: Sequence[Agreement]) -> Iterator[tuple[str, ...]]:
    for label, form in sorted({(entry.label, entry.form) for entry in compared}):
        own = [entry for entry in compared if (entry.label, entry.form) == (label, form)]
        names = {entry.name for entry in own}
        failing = {entry.name for entry in own if entry.false}
        figures = [
            sum(one) for one in zip(*((e.equal, e.compared, e.false) for e in own), strict=True)
        ]
        yield label, form, str(len(names)), str(len(failing)), *(f"{n:,}" for n in figures)


def _remarks(every: Sequence[Agreement], compared: Sequence[Agreement]) -> Iterator[str]:
    for entry in compared:
        if entry.equal < entry.compared:
            where = f"{entry.label} disagrees on {entry.name}, {entry.form}"
            yield f"{where}: {entry.equal} of {entry.compared}."
    calm = sorted({f"{e.label} on {e.name}, {e.form}" for e in compared if not e.false})
    if calm:
        yield "Ours was never FALSE, so that agreement says little: " + "; ".join(calm) + "."
    remarks = sorted({f"{e.label}: {e.remark}" for e in every if e.remark})
    if remarks:
        yield "Not compared, and so without a ratio: " + "; ".join(remarks) + "."
