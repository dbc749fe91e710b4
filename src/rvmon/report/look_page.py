"""What a recording holds, as one page: each name drawn over time, with its gaps."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from itertools import pairwise

from rvmon.report.afterword import duration_text
from rvmon.report.look_text import facts, grouped, is_constant, lost_names
from rvmon.report.markup import Child, e, page
from rvmon.spec.checked.specification import Requirement
from rvmon.starter.column import Column, Profile
from rvmon.starter.course import Stretch
from rvmon.trace.time import format_ticks

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
    groups = list(grouped(profile, requirements))
    body = [_head(profile), _axis(profile)]
    for place, (title, columns) in enumerate(groups):
        rows = [_row(column, profile) for column in columns]
        is_open = place < max(_OPEN, len(requirements))
        count = e("small", None, f" {len(columns):,}")
        summary = e("summary", None, e("b", None, title or "names"), count)
        body.append(e("details", {"open": is_open}, summary, *rows))
    if profile.left_out:
        summary = e("summary", None, e("b", None, "left out"))
        body.append(e("details", None, summary, *_left(profile)))
    name = profile.path.rpartition("/")[2]
    return page(f"{name} – rvmon look", body, styles=["base.css", "look.css"], scripts=[])


def _head(profile: Profile) -> ET.Element:
    span = duration_text(profile.end - profile.start)
    told = f"{profile.samples:,} samples in {span}, {len(profile.columns):,} names."
    lost: list[Child] = []
    for one in profile.outages:
        at = format_ticks(one.since - profile.start)
        lost.append(e("p", {"class": "lost"}, f"Lost: {lost_names(one)}, from {at} on: {one.why}."))
    return e("header", None, e("h1", None, profile.path), e("p", {"class": "soft"}, told), *lost)


def _axis(profile: Profile) -> ET.Element:
    span = profile.end - profile.start
    marks = [e("span", None, duration_text(span * part // 4)) for part in range(5)]
    return e("div", {"class": "row axis"}, e("div"), e("div", {"class": "marks"}, *marks))


def _left(profile: Profile) -> Iterator[ET.Element]:
    for why in dict.fromkeys(profile.left_out.values()):
        names = [name for name, reason in profile.left_out.items() if reason == why]
        yield e("p", {"class": "soft"}, e("code", None, ", ".join(names)), f": {why}")


def _row(column: Column, profile: Profile) -> ET.Element:
    kind, rate, gap, values = facts(column)
    told = ", ".join(one for one in (kind, rate, gap and f"gap {gap}") if one)
    name = e("div", {"class": "name"}, e("code", None, column.name), e("small", None, told))
    plot = e("div", {"class": "plot"}, e("small", None, values))
    if not is_constant(column):
        plot.append(_drawing(column, profile))
    return e("div", {"class": "row"}, name, plot)


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
