"""Reports of recordings as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from rvmon.diagnostics import snippet
from rvmon.language.checked.properties import BinKind
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.report.terminal import Terminal, wrapped
from rvmon.report.wording import (
    MARKS,
    SHOWN,
    SHOWN_PER_REQUIREMENT,
    first_of,
    forecast_sentence,
    full_reason,
    health_facts,
    instants_of,
    verdict_text,
    without_attempts,
)
from rvmon.texts import counted
from rvmon.trace.time import format_stamped
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, LazyAttempts
from rvmon.verdicts.report import Report
from rvmon.verdicts.run_coverage import CoveredBin, CoveredGroup


def together(several: Sequence[Sequence[CoveredGroup]]) -> list[CoveredGroup]:
    """The sum of the coverage of several runs by one specification, without first instants."""
    return [
        replace(
            groups[0], bins=tuple(map(_sum, zip(*(group.bins for group in groups), strict=True)))
        )
        for groups in zip(*several, strict=True)
    ]


def _sum(bins: Sequence[CoveredBin]) -> CoveredBin:
    return replace(bins[0], hits=sum(covered_bin.hits for covered_bin in bins), first=None)


def coverage_lines(groups: Sequence[CoveredGroup]) -> Iterator[str]:
    """Per group, a line with the hits of its bins, and one with its holes if it has any.

    >>> low = CoveredBin("low", BinKind.GOAL, 1, 4)
    >>> high = CoveredBin("high", BinKind.GOAL, 3, 1)
    >>> for line in coverage_lines([CoveredGroup("size", "coverpoint", (low, high))]):
    ...     print(line)
    size: 1 of 2 covered; hit: low 4, high 1
    size: not covered: high (1 of 3)
    """
    for group in groups:
        wanted = [covered_bin for covered_bin in group.bins if covered_bin.kind is BinKind.GOAL]
        holes = [covered_bin for covered_bin in wanted if covered_bin.is_hole]
        hit = [
            f"{_name(covered_bin)} {covered_bin.hits:,}"
            for covered_bin in group.bins
            if covered_bin.hits
        ]
        covered = f"{group.name}: {len(wanted) - len(holes):,} of {len(wanted):,} covered"
        yield f"{covered}; hit: {first_of(hit, SHOWN)}" if hit else covered
        if holes:
            yield f"{group.name}: not covered: {first_of([*map(_missing, holes)], SHOWN)}"


def _name(covered_bin: CoveredBin) -> str:
    return (
        covered_bin.name
        if covered_bin.kind is BinKind.GOAL
        else f"{covered_bin.name} ({covered_bin.kind})"
    )


def _missing(covered_bin: CoveredBin) -> str:
    return (
        covered_bin.name
        if covered_bin.goal == 1
        else f"{covered_bin.name} ({covered_bin.hits:,} of {covered_bin.goal:,})"
    )


def print_reports(
    reports: Sequence[Report], spec: CheckedSpec, *, counts_only: bool = False
) -> None:
    """Print the verdicts on each recording, and for several recordings their counts.

    Every F comes with cause, window and line of the specification, every I with its obligation.
    """
    console = Terminal()
    for report in () if counts_only else reports:
        print_report(report, spec, console)
    if len(reports) > 1 or (reports and counts_only):
        console.print(_runs_table(reports))
        for name in reports[0].goals:
            count = sum(report.goals[name] is Verdict.PASS for report in reports)
            state = f"met, shown by {count} of {len(reports)}" if count else "open"
            console.print(f"cover goal {name}: {state}")
        _print_coverage(together([report.coverage for report in reports]), console)


def print_report(report: Report, spec: CheckedSpec, console: Console) -> None:
    """Print the verdicts on one recording."""
    end = "" if report.end is None else f"  to {format_stamped(report.end, report.origin)}"
    console.print(Text.assemble((report.trace or spec.name, "bold"), f"{end}  by {spec.name}"))
    if spec.requirements:
        console.print(_verdict_table(report, spec))
    for name, found in report.verdicts.items():
        if name in report.misses:
            why = without_attempts(found, report.misses[name])
            console.print(_silence_text(name, found, why, console.width))
        for verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE):
            for attempt in islice(report.of(name, verdict), SHOWN_PER_REQUIREMENT):
                console.print(
                    _attempt_text(attempt, spec.requirements[name], report, console.width)
                )
            rest = report.counts.get(name, {}).get(verdict, 0) - SHOWN_PER_REQUIREMENT
            if rest > 0:
                console.print(f"… and {rest} more {verdict} of {name}", style="dim")
    if report.goals:
        console.print(_goals_text(report.goals))
    _print_coverage(report.coverage, console)
    for hit in report.illegal:
        console.print(hit.sentence(report.origin), style="bold red", markup=False)
    if report.health:
        console.print("input health:")
    for names, fact in health_facts(report.health, report.origin):
        console.print(f"  {names}  {fact}")


def _print_coverage(groups: Sequence[CoveredGroup], console: Console) -> None:
    if groups:
        console.print("coverage:")
    for line in coverage_lines(groups):
        console.print(wrapped(line, console.width), markup=False)


def _verdict_table(report: Report, spec: CheckedSpec) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("", "verdict", "attempts"):
        table.add_column(heading, no_wrap=True)
    least = _least_robustness(report)
    if least:
        table.add_column("robustness", no_wrap=True)
    levels = any(spec.requirements[name].severity for name in report.verdicts)
    if levels:
        table.add_column("severity", no_wrap=True)
    table.add_column("requirement", style="dim")
    for name, verdict in report.verdicts.items():
        counts = report.counts[name]
        listed = "  ".join(f"{count} {kind}" for kind, count in counts.items() if count)
        figure = [least.get(name, "–")] if least else []
        one = spec.requirements[name]
        level = [one.severity or "–"] if levels else []
        text = f"{one.text}  [{', '.join(one.tags)}]".lstrip() if one.tags else one.text
        table.add_row(name, verdict_text(verdict), listed or "–", *figure, *level, text)
    return table


def _least_robustness(report: Report) -> dict[str, str]:
    """By requirement the least robustness of its attempts, where it was measured."""
    if isinstance(report.attempts, LazyAttempts):
        return {}  # robustness was not measured
    least: dict[str, float] = {}
    for attempt in report.attempts:
        if attempt.robustness is not None:
            known = least.get(attempt.requirement, attempt.robustness)
            least[attempt.requirement] = min(known, attempt.robustness)
    return {name: f"{value:.4g}" for name, value in least.items()}


def _goals_text(goals: Mapping[str, Verdict]) -> Text:
    words = {Verdict.PASS: "shown", Verdict.INCONCLUSIVE: "not shown, still possible at the end"}
    text = Text("cover goals:\n")
    for name, verdict in goals.items():
        sign = MARKS[verdict].sign
        text.append(f"  {name}  {verdict} {sign}  {words.get(verdict, 'not shown')}\n")
    return text


def _silence_text(name: str, verdict: Verdict, why: str, width: int) -> Text:
    sentence = f"\n{wrapped(why, width)}\n"
    return Text.assemble((f"{name} ", "bold"), verdict_text(verdict), sentence)


def _attempt_text(attempt: Attempt, requirement: Requirement, report: Report, width: int) -> Text:
    first, *rest = instants_of(attempt)
    when = "\n  ".join([f"attempt {attempt.numbered}, {first}", *rest])
    if attempt.robustness is not None:
        when += f", robustness {attempt.robustness:.4g}"
    text = Text.assemble(
        (f"{attempt.requirement} ", "bold"), verdict_text(attempt.verdict), f"  {when}\n"
    )
    if attempt.reason:
        text.append(f"{wrapped(full_reason(attempt, report), width)}\n")
    if attempt.forecast is not None:
        text.append(f"  {forecast_sentence(attempt.forecast)}\n")
    span = requirement.span
    if attempt.blame is not None and span is not None:
        span = type(span)(span.source, attempt.blame.start, attempt.blame.end)
        text.append(snippet(span, width=width))
    return text


def _runs_table(reports: Sequence[Report]) -> Table:
    title = counted(len(reports), "recording")
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("")
    for verdict in Verdict:
        table.add_column(verdict.value, justify="right")
    for name in reports[0].verdicts:
        seen = [report.verdicts[name] for report in reports]
        table.add_row(name, *(str(seen.count(verdict)) for verdict in Verdict))
    return table
