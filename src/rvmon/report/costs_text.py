"""What judging costs, as a table for the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.diagnostics.shown import shown_line
from rvmon.monitor.compiled.costs import CompileReport
from rvmon.report.plain_table import plain_table
from rvmon.spec.print.printer import format_duration

_HEAD = ("", "judged by", "locations", "clocks", "letters", "decided within", "open attempts")


def costs_text(reports: Mapping[str, CompileReport]) -> str:
    """A line per requirement: what judges it, its size, what an open attempt costs."""
    return plain_table([_HEAD, *(_row(name, report) for name, report in reports.items())])


def _row(name: str, report: CompileReport) -> tuple[str, ...]:
    name = shown_line(name)
    reach = "any time" if report.horizon is None else format_duration(report.horizon)
    letters = f"{report.letters:,}"
    if not report.locations:
        return name, report.judge, "–", "–", letters, reach, f"in one network: {report.why}"
    sizes = (f"{report.locations}", f"{report.clocks}", letters, reach)
    return name, report.judge, *sizes, _open(report)


def _open(report: CompileReport) -> str:
    """How open attempts are kept, and what a change or a due time costs."""
    if report.horizon == 0:
        return "none: decided at once"
    if not report.in_runs:
        return "one by one: a step for each that is open"
    steps = "1 step" if report.steps == 1 else f"at most {report.steps} steps"
    return f"in runs: {report.bytes_per_attempt} bytes each, {steps} for all together"
