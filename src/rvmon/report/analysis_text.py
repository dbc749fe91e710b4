"""Remarks of an analysis for the terminal: timelines of conflicts, and what was not decided."""

from __future__ import annotations

from rvmon.explain.analysed import Analysis
from rvmon.report.example_text import picture_of
from rvmon.spec.checked.specification import CheckedSpec


def analysis_lines(analysis: Analysis, spec: CheckedSpec) -> list[str]:
    """The lines to print below the findings."""
    lines: list[str] = []
    for conflict, example in analysis.timelines:
        ids = list(dict.fromkeys(conflict.ids))
        fails = f"one of {', '.join(ids)} fails" if len(ids) > 1 else f"{ids[0]} fails"
        lines += [f"After this, {fails}, whatever comes:"]
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
    if examination.sets_undecided:
        lines.append(f"not decided for {examination.sets_undecided} larger sets")
    if examination.whole_sets is not None:
        lines.append(f"sets of more than {examination.whole_sets} were not all looked at")
    if not examination.implications_done:
        lines.append("not all were looked at whether others imply them")
    return lines
