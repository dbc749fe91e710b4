"""What a recording holds, as one page: each name drawn over time, with its gaps."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from itertools import pairwise

from rvmon.report.look_text import facts, grouped, is_constant, lost_names
from rvmon.report.markup import e
from rvmon.report.pages import render
from rvmon.report.wording import duration_text
from rvmon.spec.checked.specification import Requirement
from rvmon.starter.column import Column, Profile, Stretch
from rvmon.trace.time import format_stamped

_HEIGHT = 40
_EDGE = 3

_OPEN = 8
"""Topics that are unfolded."""


def look_page(profile: Profile, requirements: Sequence[Requirement]) -> str:
    """The page.

    Args:
        profile: of the recording.
        requirements: that read it; without any it is by topic.
    """
    span = profile.end - profile.start
    groups = [
        {
            "title": title or "names",
            "is_open": place < max(_OPEN, len(requirements)),
            "rows": [_row(column, profile) for column in columns],
        }
        for place, (title, columns) in enumerate(grouped(profile, requirements))
    ]
    left_out: dict[str, list[str]] = {}
    for name, why in profile.left_out.items():
        left_out.setdefault(why, []).append(name)
    return render(
        "look.html",
        title=f"{profile.path.rpartition('/')[2]} – rvmon look",
        profile=profile,
        told=f"{profile.samples:,} samples in {duration_text(span)}, "
        f"{len(profile.columns):,} names.",
        lost=[
            f"Lost: {lost_names(one)}, "
            f"from {format_stamped(one.since, profile.start)} on: {one.why}."
            for one in profile.outages
        ],
        marks=[duration_text(span * part // 4) for part in range(5)],
        groups=groups,
        left_out=left_out,
    )


def _row(column: Column, profile: Profile) -> dict[str, object]:
    kind, rate, gap, values = facts(column)
    return {
        "name": column.name,
        "told": ", ".join(one for one in (kind, rate, gap and f"gap {gap}") if one),
        "range": values,
        "drawing": None if is_constant(column) else _drawing(column, profile),
    }


def _drawing(column: Column, profile: Profile) -> ET.Element:
    stretches = column.course.until(profile.end)
    count = len(stretches)
    svg = e("svg", {"viewBox": f"0 0 {count} {_HEIGHT}", "preserveAspectRatio": "none"})
    for outage in profile.outages:
        if outage.names is None or column.name in outage.names:
            left = (outage.since - profile.start) / column.course.length
            wide = max(1.0, (outage.until - outage.since) / column.course.length)
            box = {"x": f"{left:.1f}", "width": f"{wide:.1f}", "y": 0, "height": _HEIGHT}
            svg.append(e("rect", {**box, "class": "lost"}))
    if column.is_event:
        for place, one in enumerate(stretches):
            if one.updates and one.high != 0.0:
                svg.append(e("path", {"class": "event", "d": f"M{place} 4V{_HEIGHT - 4}"}))
        return svg
    for first, run in _runs(stretches):
        svg.append(e("path", {"class": "course", "d": _area(first, run, stretches)}))
    return svg


def _runs(stretches: Sequence[Stretch]) -> Iterator[tuple[int, list[Stretch]]]:
    """Stretches in a row in which something was said; short silences are no gaps."""
    said = [place for place, one in enumerate(stretches) if one.low is not None]
    steps = sorted(after - before for before, after in pairwise(said))
    usual = steps[len(steps) // 2] if steps else 1
    first = 0
    for place in range(1, len(said) + 1):
        if place == len(said) or said[place] - said[place - 1] > 3 * usual:
            run = said[first:place]
            yield run[0], [stretches[one] for one in range(run[0], run[-1] + 1)]
            first = place


def _area(first: int, run: Sequence[Stretch], stretches: Sequence[Stretch]) -> str:
    """The outline from the least to the greatest value of each stretch."""
    low = min(one.low for one in stretches if one.low is not None)
    high = max(one.high for one in stretches if one.high is not None)

    def y(number: float) -> str:
        share = (number - low) / (high - low) if high > low else 0.5
        return f"{_HEIGHT - _EDGE - share * (_HEIGHT - 2 * _EDGE):.1f}"

    above, below = [], []
    for place, one in enumerate(run, first):
        if one.low is not None and one.high is not None:
            above.append(f"{place + 0.5:g} {y(one.high)}")
            below.append(f"{place + 0.5:g} {y(one.low)}")
    return f"M{'L'.join([*above, *reversed(below)])}Z"
