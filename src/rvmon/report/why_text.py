"""The explanation of an attempt by its subformulas, as text for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence

from rvmon.analysis.subformulas import Breakdown, PartTruth
from rvmon.language.checked.specification import Requirement
from rvmon.report import wording
from rvmon.report.printer import Line
from rvmon.report.tracks import Track, signal_texts
from rvmon.trace.time import format_instant
from rvmon.verdicts.attempt import Attempt

WIDTH = 80
PLOT = 46  # columns of the drawing; the formulas take the rest

TRUE, FALSE, UNKNOWN, RISES, FALLS, PULSE, DIP = "▇▁?╱╲●○"
LEGEND = (
    f"{TRUE} true  {FALSE} false  {UNKNOWN} not known"
    f"  {PULSE} true for a moment  {DIP} false for a moment"
)


def why_lines(
    breakdown: Breakdown, requirement: Requirement, values: Mapping[str, Sequence[str]]
) -> Iterator[Line]:
    """The verdict with its reason, a row per subformula of trigger and consequent, and values."""
    attempt = breakdown.attempt
    yield [(f"{attempt.name}  ", "bold"), wording.verdict_text(attempt.verdict)]
    for line in _sentences(breakdown, requirement):
        yield [wording.wrapped(line, WIDTH)]
    yield []
    yield from _axis(breakdown)
    part = ""
    for part_truth in breakdown.part_truths:
        if part_truth.part != part:
            part = part_truth.part
            yield [(f"  {part}", "bold")]
        yield from _row(part_truth, breakdown)
    yield [(f"  {LEGEND}", "dim")]
    if values:
        yield []
        instants = ["at the trigger", "at the end"][: len(next(iter(values.values())))]
        yield _columns("  values", instants, "bold")
        for name, texts in values.items():
            yield _columns(f"    {name}", texts)


def attempt_values(
    tracks: Sequence[Track], attempt: Attempt, last: int
) -> dict[str, Sequence[str]]:
    """The value of each signal at the trigger and, if it is later, at `last` (ticks)."""
    texts = [signal_texts(tracks, t) for t in sorted({attempt.triggered, last})]
    return {name: [one[name] for one in texts] for name in texts[0]}


def _columns(first: str, others: Sequence[str], style: str = "") -> Line:
    cells = "".join(f"{other:<{PLOT // 2}}" for other in others)
    return [(f"{first:<{WIDTH - PLOT}}{cells}".rstrip(), style)]


def _sentences(breakdown: Breakdown, requirement: Requirement) -> Iterator[str]:
    attempt = breakdown.attempt
    if requirement.text:
        yield requirement.text
    yield from wording.instants_of(attempt)
    for name, value in attempt.captured.items():
        yield f"{name} = {value}"
    if attempt.reason:
        yield wording.reason_text(attempt, breakdown.late)
    if attempt.forecast is not None:
        yield wording.forecast_sentence(attempt.forecast)


def _axis(breakdown: Breakdown) -> Iterator[Line]:
    """The time axis with marks at the trigger and the decision."""
    attempt = breakdown.attempt
    marks = [" "] * PLOT
    marks[_column(attempt.triggered, breakdown)] = "▼"
    if attempt.decided is not None:
        column = _column(attempt.decided, breakdown)
        marks[column] = wording.MARKS[attempt.verdict].sign
    first, last = (format_instant(t, attempt.origin) for t in (breakdown.start, breakdown.end))
    margin = " " * (WIDTH - PLOT)
    yield [(f"{margin}{first}{last:>{PLOT - len(first)}}", "dim")]
    yield [f"{margin}{''.join(marks)}".rstrip()]


def _column(t: int, breakdown: Breakdown) -> int:
    span = breakdown.end - breakdown.start + 1
    return min(max((t - breakdown.start) * PLOT // span, 0), PLOT - 1)


def _row(part_truth: PartTruth, breakdown: Breakdown) -> Iterator[Line]:
    room = WIDTH - PLOT - 2
    indent = "  " + "  " * min(part_truth.depth + 1, 6)
    lines = textwrap.wrap(part_truth.text, room - len(indent)) or [""]
    for line in lines[:-1]:
        yield [f"{indent}{line}"]
    cells = (_cell(part_truth, breakdown, column) for column in range(PLOT))
    yield [f"{indent + lines[-1]:<{WIDTH - PLOT}}{''.join(cells)}"]


def _cell(part_truth: PartTruth, breakdown: Breakdown, column: int) -> str:
    """One column: the truth of the formula over its ticks, with changes as edges or pulses."""
    span = breakdown.end - breakdown.start + 1
    low = breakdown.start + column * span // PLOT
    high = max(breakdown.start + (column + 1) * span // PLOT - 1, low)
    true, false = _touches(part_truth.true, low, high), _touches(part_truth.false, low, high)
    if true and not false:
        return TRUE
    if not true:
        # One unknown tick makes the column unknown: it must be false throughout.
        known = any(a <= low and high <= b for a, b in part_truth.false)
        return FALSE if known else UNKNOWN
    if _inside(part_truth.true, low, high):
        return PULSE
    if _inside(part_truth.false, low, high):
        return DIP
    # Both truths extend beyond the column, one at each end.
    return FALLS if _touches(part_truth.true, low, low) else RISES


def _inside(spans: Sequence[tuple[int, int]], low: int, high: int) -> bool:
    """Whether all spans that intersect [low, high] lie within it."""
    return all(low <= a and b <= high for a, b in spans if a <= high and low <= b)


def _touches(spans: Sequence[tuple[int, int]], low: int, high: int) -> bool:
    return any(a <= high and low <= b for a, b in spans)
