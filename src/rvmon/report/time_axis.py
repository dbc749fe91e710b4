"""The stretch of time that a timeline shows around an attempt."""

from __future__ import annotations

import math
import re

from msgspec import Struct

from rvmon.trace.time import TICKS_PER_SECOND, format_ticks, ticks_of_text
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report import Report

MARGIN = 0.2  # the margin on either side, relative to the attempt's length

SMALLEST_MARGIN = TICKS_PER_SECOND
"""The least margin in ticks, for attempts that are decided at once; less if the run is short."""

STEPS = (1, 2, 5)

_SECONDS = re.compile(r"\b(\d+\.\d+) s\b")

SHOWN_DIGITS = 4  # the last shown digit of an instant is 1/1000 to 1/10000 of the view


class View(Struct, frozen=True):
    """The stretch `[start, end]` in ticks, `start < end`."""

    start: int
    end: int

    def fraction(self, instant: int) -> float:
        """The place of an instant: 0 at the start, 1 at the end."""
        return (instant - self.start) / (self.end - self.start)


def view_of(attempt: Attempt, report: Report, late: int | None = None) -> View:
    """The view from before the trigger to after the decision and the deadline.

    A late response at `late` (ticks) is included if it is near.
    """
    decided = report.end if attempt.decided is None else attempt.decided
    blame = () if attempt.blame is None else (*attempt.blame.window, *attempt.blame.at)
    shown = (attempt.triggered, decided, attempt.deadline, *blame)
    instants = [instant for instant in shown if instant is not None]
    first, last = min(instants), max(instants)
    # A later response would squeeze the attempt into less than half of the view; then its label
    # points out of the view instead.
    if late is not None and late - last <= last - first:
        last = max(last, late)
    length = 0 if report.end is None else max(report.end - report.origin, 0)
    margin = max(round((last - first) * MARGIN), min(SMALLEST_MARGIN, length // 4), 2)
    # A quarter of the margin beyond the run makes its start and end visible.
    little = margin // 4
    start = max(first - margin, min(report.origin, first) - little)
    if report.end is None:
        return View(start, last + margin)
    return View(start, max(min(last + margin, max(report.end, last) + little), start + 1))


def whole_run(report: Report, first: int) -> View:
    """The view of the whole run, which starts with a sample at `first`."""
    last = first if report.end is None else report.end
    return View(first, max(last, first + 1))


def round_instants(view: View, origin: int, count: int = 6) -> list[int]:
    """Round instants within a view, about `count` of them, for the labels of an axis.

    >>> second = 1_000_000_000
    >>> [t // second for t in round_instants(View(0, 10 * second), 0)]
    [0, 2, 4, 6, 8, 10]
    """
    rough = max((view.end - view.start) / count, 1)
    power = 10 ** math.floor(math.log10(rough))
    step = next((power * step for step in STEPS if power * step >= rough), 10 * power)
    first = -((origin - view.start) // step) * step + origin
    return list(range(first, view.end + 1, step))


def moment(instant: int, origin: int, view: View) -> str:
    """An instant as seconds since the origin, rounded to what can be distinguished in a view.

    This hides the one tick between a missed deadline and its decision.

    >>> moment(3_234_567_891, 0, View(0, 10_000_000_000)), moment(17, 5, View(0, 20))
    ('3.235 s', '12 ns')
    """
    digits = math.ceil(math.log10(view.end - view.start)) - SHOWN_DIGITS
    since = instant - origin
    return format_ticks(since if digits <= 0 else round(since, -digits))


def with_moments(sentence: str, view: View) -> str:
    """A sentence with its exact instants and durations rounded as by `moment`.

    >>> with_moments("never since 25.682548547 s", View(0, 10_000_000_000))
    'never since 25.683 s'
    """
    return _SECONDS.sub(lambda seconds: moment(ticks_of_text(seconds[1]), 0, view), sentence)
