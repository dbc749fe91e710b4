"""Findings as a page."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.agreement import Agreement
from benchmarks.findings import ATTEMPT_BYTES, FLATNESS, GOALS, Findings, Goal
from benchmarks.measure import Figure, Result

TITLES = {
    "online": "Online, one step per row: Timescales families",
    "robot": "Online, one step per row: a robot's requirements",
    "many": "Many monitors on one stream of 20 signals",
    "bound": "A deadline from 10 to 100,000 rows",
    "unsteady": "Values that change and cross at every row",
    "failing": "Values that change at every row, formulas that fail at 1 % and at 30 % of them",
    "batch": "Columns in memory",
    "process": "Whole processes, from the file to the verdict",
}


def render(findings: Findings) -> str:
    """The page, Markdown."""
    lines = [
        "# Results",
        "",
        f"Written by `{findings.command}`. CPU time per row of the trace, median of the passes",
        "with the least and the most in brackets; contenders take turns. Times move with the",
        "machine, ratios in one run hold. A ratio is only given where both sides judged alike.",
        "",
        f"* Machine: {findings.machine}",
        f"* Versions: {', '.join(f'{k} {v}' for k, v in findings.versions.items())}",
        *(f"* Not measured: {name}: {why}" for name, why in findings.absent.items()),
        "",
        "## Goals",
        "",
        "Times are medians over the workloads that count; the ratio is the peer's time over ours:",
        "its median, and the least, which counts as much.",
        "",
        *_goals(findings),
    ]
    for section, title in TITLES.items():
        results = [result for result in findings.results if result.section == section]
        if results:
            lines += ["", f"## {title}", "", *_results(results), *_refusals(results)]
    if findings.r2u2:
        lines += ["", "## Many monitors beside R2U2", "", *findings.r2u2]
    if findings.files:
        lines += ["", "## Whole files, on all cores", "", *findings.files]
    if findings.open_attempts:
        lines += ["", "## Open attempts", "", *_open_attempts(findings)]
    if findings.agreements:
        lines += ["", "## Agreement", "", *_agreements(findings.agreements)]
    if findings.differences:
        lines += ["", "## Where the peers read otherwise", "", *findings.differences]
    return "\n".join(lines) + "\n"


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


@dataclass(frozen=True, slots=True)
class _Pairs:
    """Results in which two sides took part and judged alike."""

    ours: list[float]
    peers: list[float]

    @property
    def ratios(self) -> list[float]:
        """The peer's time over ours."""
        return [peer / own for own, peer in zip(self.ours, self.peers, strict=True)]


def _pairs(findings: Findings, goal: Goal) -> _Pairs:
    found = _Pairs([], [])
    for result in findings.results:
        counts = result.section == goal.section and result.form == goal.form
        if not counts or (goal.names and result.name not in goal.names):
            continue
        ours, peer = _figure(result, goal.ours), _figure(result, goal.peer)
        if ours is None or peer is None or result.changing > goal.changing:
            continue
        if _alike(findings.agreements, result, ours, peer):
            found.ours.append(ours.median)
            found.peers.append(peer.median)
    return found


def _alike(agreements: Sequence[Agreement], result: Result, ours: Figure, peer: Figure) -> bool:
    """Whether verdicts were compared on this workload, and all and the timed ones were the same."""
    here = [a for a in agreements if a.form == result.form and a.name == result.name and a.compared]
    name = peer.label.split()[0].rstrip(",")
    checked = [a for a in here if a.label == name]
    whole = ours.rows == peer.rows == result.rows
    if whole and result.form == "past" and ours.violated != peer.violated:
        return False
    return bool(checked) and all(a.equal == a.compared for a in checked)


def _goals(findings: Findings) -> Iterator[str]:
    yield "| mode | we | | peer | | workloads | ratio (least to most) | goal | met |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for goal in GOALS:
        pairs = _pairs(findings, goal)
        ratios = pairs.ratios
        if not ratios:
            own, other, text, mark = "–", "–", "not measured", "–"
        else:
            median = statistics.median(ratios)
            own = time_text(statistics.median(pairs.ours))
            other = time_text(statistics.median(pairs.peers))
            text = f"{ratio_text(median)} ({ratio_text(min(ratios))} to {ratio_text(max(ratios))})"
            is_met = median >= goal.times and min(ratios) >= goal.least
            mark = "yes" if is_met else "no"
        yield (
            f"| {goal.mode} | {goal.ours} | {own} | {goal.peer} | {other} | {len(ratios)} | "
            f"{text} | ≥ {ratio_text(goal.times)}, least ≥ {ratio_text(goal.least)} | {mark} |"
        )
    flat = _flatness(findings)
    if flat is not None:
        mark = "yes" if flat <= FLATNESS else "no"
        yield (
            f"| bound 10 to 100,000 | rvmon step | – | – | – | – | {ratio_text(flat)} | "
            f"≤ {ratio_text(FLATNESS)} | {mark} |"
        )
    if findings.open_attempts:
        most = max(findings.open_attempts, key=lambda entry: entry.attempts)
        least = min(findings.open_attempts, key=lambda entry: entry.attempts)
        growth = most.median / least.median
        mark = "yes" if most.size <= ATTEMPT_BYTES and growth <= FLATNESS else "no"
        yield (
            f"| {least.attempts} to {most.attempts:,} open attempts | rvmon step | "
            f"{time_text(most.median)} | – | – | – | "
            f"{ratio_text(growth)} a sample, {most.size:.0f} bytes each | "
            f"constant, ≤ {ATTEMPT_BYTES} bytes | {mark} |"
        )


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


def _results(results: Sequence[Result]) -> Iterator[str]:
    labels = list(dict.fromkeys(f.label for result in results for f in result.figures))
    yield "| workload | form | rows | changing | " + " | ".join(labels) + " |"
    yield "|---|---|---|---|" + "---|" * len(labels)
    for result in results:
        cells = [_cell(_figure(result, label), result) for label in labels]
        yield (
            f"| {result.name} | {result.form} | {result.rows:,} | {100 * result.changing:.0f} % | "
            + " | ".join(cells)
            + " |"
        )


def _refusals(results: Sequence[Result]) -> Iterator[str]:
    """Who did not take part in how many workloads, and why."""
    counts = Counter(
        f"{label}: {why}"
        for result in results
        for label, why in result.refusals
        if not why.startswith("only ")  # the other form of the same property is measured
    )
    if counts:
        yield ""
        yield "Not measured: " + "; ".join(f"{text} ({n})" for text, n in counts.items()) + "."


def _cell(figure: Figure | None, result: Result) -> str:
    if figure is None:
        return "–"
    text = f"{time_text(figure.median)} ({time_text(figure.least)}–{time_text(figure.most)})"
    return text if figure.rows == result.rows else f"{text}, {figure.rows:,} rows"


def _open_attempts(findings: Findings) -> Iterator[str]:
    yield "| open attempts | CPU per sample | bytes per attempt |"
    yield "|---|---|---|"
    for entry in findings.open_attempts:
        size = f"{entry.size:.0f}" if entry.attempts >= 1_000 else "–"
        spread = f"({time_text(entry.least)}–{time_text(entry.most)})"
        yield f"| {entry.attempts:,} | {time_text(entry.median)} {spread} | {size} |"


def _agreements(agreements: Sequence[Agreement]) -> Iterator[str]:
    yield "Verdicts compared row by row, at the end of each trace and on damaged traces, and the"
    yield "instant of the first failure. rtamt judges the past by the stepping that is timed."
    yield ""
    yield "| peer | form | workloads | with our FALSE | equal | of | our FALSE among them |"
    yield "|---|---|---|---|---|---|---|"
    compared = [entry for entry in agreements if entry.compared]
    for label, form in sorted({(entry.label, entry.form) for entry in compared}):
        own = [entry for entry in compared if (entry.label, entry.form) == (label, form)]
        names = {entry.name for entry in own}
        failing = {entry.name for entry in own if entry.false}
        equal, count = sum(e.equal for e in own), sum(e.compared for e in own)
        false = sum(e.false for e in own)
        yield (
            f"| {label} | {form} | {len(names)} | {len(failing)} | {equal:,} | {count:,} | "
            f"{false:,} |"
        )
    for entry in compared:
        if entry.equal < entry.compared:
            yield ""
            yield (
                f"{entry.label} disagrees on {entry.name}, {entry.form}: "
                f"{entry.equal} of {entry.compared}."
            )
    calm = sorted({f"{e.label} on {e.name}, {e.form}" for e in compared if not e.false})
    if calm:
        yield ""
        yield "Ours was never FALSE, so that agreement says little: " + "; ".join(calm) + "."
    remarks = sorted({f"{e.label}: {e.remark}" for e in agreements if e.remark})
    if remarks:
        yield ""
        yield "Not compared, and so without a ratio: " + "; ".join(remarks) + "."
