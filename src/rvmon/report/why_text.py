"""An attempt taken apart, drawn in the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rvmon.explain.dissect import Anatomy, Strand
from rvmon.explain.spans import Spans
from rvmon.report.style import MARKS, verdict_text
from rvmon.report.terminal import wrapped
from rvmon.report.wording import forecast_sentence, with_afterword
from rvmon.spec.checked.specification import Requirement
from rvmon.trace.time import format_ticks

if TYPE_CHECKING:
    from rich.text import Text

WIDTH = 80
PLOT = 46
"""Columns of the drawing; the rest is for the formulas."""

TRUE, FALSE, UNKNOWN, RISES, FALLS, PULSE, DIP = "▇▁?╱╲●○"
LEGEND = f"{TRUE} true  {FALSE} false  {UNKNOWN} not known  {PULSE} true for a moment"


def why_lines(anatomy: Anatomy, requirement: Requirement) -> Iterator[Text]:
    """The verdict with its reason, then a row for the trigger and for each part of what is owed."""
    from rich.text import Text

    attempt = anatomy.attempt
    yield Text.assemble((f"{attempt.name}  ", "bold"), verdict_text(attempt.verdict))
    for line in _sentences(anatomy, requirement):
        yield Text(wrapped(line, WIDTH))
    yield Text("")
    yield from _axis(anatomy)
    part = ""
    for strand in anatomy.strands:
        if strand.part != part:
            part = strand.part
            yield Text(f"  {part}", style="bold")
        yield from _row(strand, anatomy)
    yield Text(f"  {LEGEND}", style="dim")


def _sentences(anatomy: Anatomy, requirement: Requirement) -> Iterator[str]:
    attempt = anatomy.attempt
    if requirement.text:
        yield requirement.text
    decided = "" if attempt.decided is None else f", decided {_instant(attempt.decided, anatomy)}"
    yield f"triggered {_instant(attempt.triggered, anatomy)}{decided}"
    for name, value in attempt.captured.items():
        yield f"{name} = {value}"
    if attempt.reason:
        yield with_afterword(attempt, anatomy.late)
    if attempt.forecast is not None:
        yield forecast_sentence(attempt.forecast)


def _instant(t: int, anatomy: Anatomy) -> str:
    return format_ticks(t - anatomy.origin)


def _axis(anatomy: Anatomy) -> Iterator[Text]:
    """Where the trigger and the decision are."""
    from rich.text import Text

    attempt = anatomy.attempt
    marks = [" "] * PLOT
    marks[_column(attempt.triggered, anatomy)] = "▼"
    if attempt.decided is not None:
        column = _column(attempt.decided, anatomy)
        marks[column] = MARKS[attempt.verdict].sign
    first, last = _instant(anatomy.start, anatomy), _instant(anatomy.end, anatomy)
    margin = " " * (WIDTH - PLOT)
    yield Text(f"{margin}{first}{last:>{PLOT - len(first)}}", style="dim")
    yield Text(f"{margin}{''.join(marks)}".rstrip())


def _column(t: int, anatomy: Anatomy) -> int:
    span = anatomy.end - anatomy.start + 1
    return min(max((t - anatomy.start) * PLOT // span, 0), PLOT - 1)


def _row(strand: Strand, anatomy: Anatomy) -> Iterator[Text]:
    from rich.text import Text

    room = WIDTH - PLOT - 2
    indent = "  " + "  " * min(strand.depth + 1, 6)
    lines = textwrap.wrap(strand.text, room - len(indent)) or [""]
    for line in lines[:-1]:
        yield Text(f"{indent}{line}")
    cells = (_cell(strand, anatomy, column) for column in range(PLOT))
    yield Text(f"{indent + lines[-1]:<{WIDTH - PLOT}}{''.join(cells)}")


def _cell(strand: Strand, anatomy: Anatomy, column: int) -> str:
    """One column: what the formula is in its ticks."""
    span = anatomy.end - anatomy.start + 1
    low = anatomy.start + column * span // PLOT
    high = max(anatomy.start + (column + 1) * span // PLOT - 1, low)
    true, false = _touches(strand.true, low, high), _touches(strand.false, low, high)
    if not (true and false):
        whole = strand.true if true else strand.false
        known = any(a <= low and high <= b for a, b in whole)
        return UNKNOWN if not known and not true else TRUE if true else FALSE
    if _inside(strand.true, low, high):
        return PULSE
    if _inside(strand.false, low, high):
        return DIP
    begins, ends = _touches(strand.true, low, low), _touches(strand.true, high, high)
    if begins is ends:
        return DIP if begins else PULSE
    return FALLS if begins else RISES


def _inside(spans: Spans, low: int, high: int) -> bool:
    """Whether all that touches a stretch of time lies within it."""
    return all(low <= a and b <= high for a, b in spans if a <= high and low <= b)


def _touches(spans: Spans, low: int, high: int) -> bool:
    return any(a <= high and low <= b for a, b in spans)
