"""The contents of a recording as HTML page and as text: each name over time, with its gaps."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from itertools import pairwise

from rvmon.language.checked.specification import Requirement
from rvmon.recordings.starter.observed_values import Column, Profile, Stretch
from rvmon.report.html import e, render
from rvmon.report.printer import Printer
from rvmon.report.time_axis import View, moment, round_instants
from rvmon.report.tracks import names_of_requirement, share_of
from rvmon.report.wording import duration_text, first_of
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND, format_stamp, format_stamped

_BARS = "▁▂▃▄▅▆▇█"
_WIDTH = 20
_LONG = 3  # an interval between updates longer than this many usual ones is a gap

_MOST_LABELS = 4
_LONGEST = 16  # the most characters shown of a label

_FEW = 3


def print_look(profile: Profile, requirements: Sequence[Requirement], printer: Printer) -> None:
    """Print the names that each requirement reads, then the others by topic."""
    span = duration_text(profile.end - profile.start)
    start = format_stamp(profile.start)
    printer.sentences(f"{profile.path}: {profile.samples:,} samples in {span}, from {start}")
    for outage in profile.outages:
        printer.sentences(f"lost: {_lost(outage, profile.start)}", "yellow")
    for title, columns in grouped(profile, requirements):
        if title:
            printer.sentences(title, "bold")
        rows = []
        for column in columns:
            kind, rate, gap, about = facts(column)
            rate = f"{rate}, gap {gap}" if gap else rate
            rows.append((_short(column.name, title), kind, about, rate, spark(column, profile)))
        printer.columns(rows, right=(3,), wraps=(0, 1, 2, 3))
    for why in dict.fromkeys(profile.left_out.values()):
        names = [name for name, reason in profile.left_out.items() if reason == why]
        printer.sentences(f"left out: {first_of(names, _FEW)}: {why}", "bright_black")


def _lost(outage: Outage, start: int) -> str:
    names = "everything" if outage.names is None else first_of(sorted(outage.names), _FEW)
    return f"{names} from {format_stamped(outage.since, start)} on: {outage.why}"


def grouped(
    profile: Profile, requirements: Sequence[Requirement]
) -> Iterator[tuple[str, list[Column]]]:
    """The columns by title: of each requirement, then of each topic, constant ones last."""
    by_name = {column.name: column for column in profile.columns}
    read: set[str] = set()
    for requirement in requirements:
        names = [name for name in names_of_requirement(requirement) if name in by_name]
        read.update(names)
        yield f"{requirement.id}  {requirement.text}", [by_name[name] for name in names]
    rest: dict[str, list[Column]] = {}
    for column in profile.columns:
        if column.name not in read:
            rest.setdefault(column.shape.source, []).append(column)
    for source, columns in rest.items():
        title = source or ("not read by any requirement" if requirements else "")
        yield title, sorted(columns, key=is_constant)


def is_constant(column: Column) -> bool:
    """Whether a signal never changes its value."""
    return not column.is_event and len(column.course.extremes) < 2


def facts(column: Column) -> tuple[str, str, str, str]:
    """The kind with unit, the rate, the longest gap or "", and the range or labels."""
    shape = column.shape
    kind = "event" if shape.kind is None else str(shape.kind)
    kind += f" [{shape.unit}]" if shape.unit else ""
    rate = f"{column.rate:.3g} Hz" if column.rate else f"{column.updates}×"
    gap = column.longest_gap / TICKS_PER_SECOND
    is_gap = gap * column.rate > _LONG and not column.is_event
    return kind, rate, f"{gap:.3g} s" if is_gap else "", values(column)


def values(column: Column) -> str:
    """The range of a number, or the values of labels."""
    labels = list(column.course.labels)
    if labels:
        more = f", {len(labels) - _MOST_LABELS} more" if len(labels) > _MOST_LABELS else ""
        shown = [label if len(label) <= _LONGEST else f"{label[:_LONGEST]}…" for label in labels]
        return f"{', '.join(shown[:_MOST_LABELS])}{more}"
    if column.is_event:
        return f"{column.occurrences:,} times" if column.occurrences != 1 else "once"
    if column.shape.kind is Kind.BOOL:
        taken = column.course.extremes
        return " and ".join(word for word, n in (("false", 0.0), ("true", 1.0)) if n in taken)
    if column.low is None or column.high is None:
        return "unknown"
    if column.shape.kind is Kind.INT and column.low != column.high:
        return f"{column.low:.0f} … {column.high:.0f}"
    if column.low == column.high:
        # `+ 0` turns negative zero into zero.
        return f"always {column.low + 0:.9g}"
    # As few digits as distinguish the ends of the range.
    digits = next(
        digits
        for digits in (5, 7, 9, 12, 17)
        if f"{column.low:.{digits}g}" != f"{column.high:.{digits}g}"
    )
    return f"{column.low + 0:.{digits}g} … {column.high + 0:.{digits}g}"


def spark(column: Column, profile: Profile) -> str:
    """The course of a signal or event in `_WIDTH` characters, blank where nothing was updated."""
    if is_constant(column):
        return ""
    stretches = column.course.until(profile.end)
    lows = [stretch.low for stretch in stretches if stretch.low is not None]
    highs = [stretch.high for stretch in stretches if stretch.high is not None]
    low, high = min(lows, default=0.0), max(highs, default=0.0)
    drawn = ""
    for place in range(_WIDTH):
        first = place * len(stretches) // _WIDTH
        place_stretches = stretches[first : max(first + 1, (place + 1) * len(stretches) // _WIDTH)]
        shares = [
            share_of(bound, low, high)
            for stretch in place_stretches
            for bound in (stretch.low, stretch.high)
            if bound is not None and not column.is_event
        ]
        occurs = any(stretch.updates and stretch.high != 0.0 for stretch in place_stretches)
        if column.is_event and occurs:
            drawn += "│"
        elif shares:
            share = sum(shares) / len(shares)
            drawn += _BARS[min(len(_BARS) - 1, int(share * len(_BARS)))]
        else:
            drawn += " "
    return drawn.rstrip()


_HEIGHT = 40
_EDGE = 3

_OPEN = 8  # the number of topics that are unfolded at first


def look_page(profile: Profile, requirements: Sequence[Requirement]) -> str:
    """The page of a recording; names are grouped by requirement, the remaining ones by topic."""
    span = profile.end - profile.start
    groups = [
        {
            "title": title or "names",
            "is_open": place < max(_OPEN, len(requirements)),
            "rows": [_row(column, title, profile) for column in columns],
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
        about=f"{profile.samples:,} samples in {duration_text(span)}, "
        f"{len(profile.columns):,} names.",
        lost=[f"Lost: {_lost(outage, profile.start)}." for outage in profile.outages],
        marks=_marks(profile.start, profile.end),
        groups=groups,
        left_out=left_out,
    )


_LAST = 0.95  # the greatest place of a mark; the label of a later one would have no room


def _marks(start: int, end: int) -> list[tuple[str, str]]:
    """Round instants since the start, each with its place in per cent."""
    view = View(start, max(end, start + 1))
    shares = [(view.fraction(t), t) for t in round_instants(view, start, count=5)]
    return [(f"{100 * share:.2f}", moment(t, start, view)) for share, t in shares if share < _LAST]


def _short(name: str, title: str) -> str:
    """A name without the prefix of its topic."""
    return name.removeprefix(f"{title.strip('/').replace('/', '.')}.")


def _row(column: Column, title: str, profile: Profile) -> dict[str, object]:
    kind, rate, gap, values = facts(column)
    return {
        "name": column.name,
        "short": _short(column.name, title),
        "about": ", ".join(one for one in (kind, rate, gap and f"gap {gap}") if one),
        "range": values,
        "drawing": None if is_constant(column) else _drawing(column, profile),
    }


def _drawing(column: Column, profile: Profile) -> ET.Element:
    stretches = column.course.until(profile.end)
    # At least one stretch wide, so that a short recording or outage is visible.
    wide = max(1.0, (profile.end - profile.start) / column.course.length)
    svg = e("svg", {"viewBox": f"0 0 {wide:.2f} {_HEIGHT}", "preserveAspectRatio": "none"})
    for outage in profile.outages:
        if outage.names is None or column.name in outage.names:
            left = (outage.since - profile.start) / column.course.length
            long = max(1.0, (outage.until - outage.since) / column.course.length)
            box = {"x": f"{left:.1f}", "width": f"{long:.1f}", "y": 0, "height": _HEIGHT}
            svg.append(e("rect", {**box, "class": "lost"}))
    if column.is_event:
        for place, stretch in enumerate(stretches):
            if stretch.updates and stretch.high != 0.0:
                svg.append(e("path", {"class": "event", "d": f"M{place} 4V{_HEIGHT - 4}"}))
        return svg
    for first, run in _runs(stretches):
        svg.append(e("path", {"class": "course", "d": _area(first, run, stretches)}))
    return svg


def _runs(stretches: Sequence[Stretch]) -> Iterator[tuple[int, list[Stretch]]]:
    """The maximal runs of stretches without a gap; short silences are bridged."""
    filled = [place for place, stretch in enumerate(stretches) if stretch.low is not None]
    steps = sorted(after - before for before, after in pairwise(filled))
    # The median, as silences are longer than the usual step and would raise a mean.
    usual = steps[len(steps) // 2] if steps else 1
    first = 0
    for place in range(1, len(filled) + 1):
        if place == len(filled) or filled[place] - filled[place - 1] > 3 * usual:
            run = filled[first:place]
            yield run[0], [stretches[one] for one in range(run[0], run[-1] + 1)]
            first = place


def _area(first: int, run: Sequence[Stretch], stretches: Sequence[Stretch]) -> str:
    """The outline from the least to the greatest value of each stretch."""
    low = min(stretch.low for stretch in stretches if stretch.low is not None)
    high = max(stretch.high for stretch in stretches if stretch.high is not None)

    def y(number: float) -> str:
        return f"{_EDGE + share_of(number, high, low) * (_HEIGHT - 2 * _EDGE):.1f}"

    above, below = [], []
    for place, stretch in enumerate(run, first):
        if stretch.low is not None and stretch.high is not None:
            above.append(f"{place + 0.5:g} {y(stretch.high)}")
            below.append(f"{place + 0.5:g} {y(stretch.low)}")
    return f"M{'L'.join([*above, *reversed(below)])}Z"
