"""Remarks of an analysis for the terminal: timelines of conflicts, and what was not decided."""

from __future__ import annotations

from rvmon.explain.analysed import Analysis
from rvmon.report.example_text import picture_of
from rvmon.spec.checked import CheckedSpec


def analysis_lines(analysis: Analysis, spec: CheckedSpec) -> list[str]:
    """The lines to print below the findings."""
    lines: list[str] = []
    for conflict, example in analysis.timelines:
        lines += [f"After this, one of {', '.join(conflict.ids)} fails, whatever comes:"]
        drawn = {name for sample in example.samples for name in sample.values}
        lines += [line.plain for line in picture_of(example, spec, drawn)]
        lines.append("")
    examination = analysis.examination
    if examination.undecided:
        lines.append(f"not decided alone: {', '.join(examination.undecided)}")
    if examination.pairs_undecided:
        lines.append(
            f"not decided for {examination.pairs_undecided} of {examination.pairs} pairs that "
            "read a common name"
        )
    if not examination.triples_done:
        lines.append("sets of three were not all looked at within the budget")
    return lines
