"""What a recording holds, for a terminal: a line a name, drawn over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.table import Table
from rich.text import Text

from rvmon.report.wording import duration_text
from rvmon.spec.checked.specification import Requirement
from rvmon.starter.column import Column, Profile
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND, format_stamp, format_stamped

_BARS = "▁▂▃▄▅▆▇█"
_WIDTH = 20
_LONG = 3
"""Between two updates usual times so much is a gap."""

_MOST_LABELS = 4
_LONGEST = 16
"""Characters of a label."""

_FEW = 3


def look_tables(profile: Profile, requirements: Sequence[Requirement]) -> Iterator[Table | Text]:
    """The names under the requirements that read them, and those that nothing reads by topic."""
    span = duration_text(profile.end - profile.start)
    start = format_stamp(profile.start)
    yield Text(f"{profile.path}: {profile.samples:,} samples in {span}, from {start}")
    for one in profile.outages:
        since = format_stamped(one.since, profile.start)
        yield Text(f"lost: {lost_names(one)} from {since} on: {one.why}", "yellow")
    for title, columns in grouped(profile, requirements):
        table = Table(title=title, title_justify="left", title_style="bold", box=None)
        table.show_header = False
        for justify in ("left", "left", "left", "right", "left"):
            table.add_column(justify=justify, overflow="fold")
        table.columns[-1].no_wrap = True
        for column in columns:
            kind, rate, gap, told = facts(column)
            rate = f"{rate}, gap {gap}" if gap else rate
            name = column.name.removeprefix(f"{title.strip('/').replace('/', '.')}.")
            table.add_row(name, kind, told, rate, spark(column, profile))
        yield table
    for why in dict.fromkeys(profile.left_out.values()):
        names = [name for name, reason in profile.left_out.items() if reason == why]
        more = f" and {len(names) - _FEW:,} more" if len(names) > _FEW else ""
        yield Text(f"left out: {', '.join(names[:_FEW])}{more}: {why}", "bright_black")


def lost_names(outage: Outage) -> str:
    """The names that were lost, the first of them if they are many."""
    if outage.names is None:
        return "everything"
    names = sorted(outage.names)
    more = f" and {len(names) - _FEW:,} more" if len(names) > _FEW else ""
    return f"{', '.join(names[:_FEW])}{more}"


def grouped(
    profile: Profile, requirements: Sequence[Requirement]
) -> Iterator[tuple[str, list[Column]]]:
    """The columns under titles: of requirements, then of topics, what is constant last."""
    from rvmon.report.tracks import concerned_names

    by_name = {column.name: column for column in profile.columns}
    read: set[str] = set()
    for requirement in requirements:
        names = [name for name in concerned_names(requirement) if name in by_name]
        read.update(names)
        yield f"{requirement.id}  {requirement.text}", [by_name[name] for name in names]
    rest: dict[str, list[Column]] = {}
    for column in profile.columns:
        if column.name not in read:
            rest.setdefault(column.shape.source, []).append(column)
    for source, columns in rest.items():
        title = source or ("what nothing reads" if requirements else "")
        yield title, sorted(columns, key=is_constant)


def is_constant(column: Column) -> bool:
    """Whether its value is always the same."""
    said = [one for one in column.course.stretches if one.low is not None]
    return not column.is_event and len({one.low for one in said} | {one.high for one in said}) < 2


def facts(column: Column) -> tuple[str, str, str, str]:
    """Kind with unit, rate, longest gap if it is one, and range or labels."""
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
        shown = [one if len(one) <= _LONGEST else f"{one[:_LONGEST]}…" for one in labels]
        return f"{', '.join(shown[:_MOST_LABELS])}{more}"
    if column.is_event:
        return f"{column.updates:,} times"
    if column.shape.kind is Kind.BOOL:
        first = column.course.stretches
        seen = {one.low for one in first} | {one.high for one in first}
        words = {"false": 0.0, "true": 1.0}
        return " and ".join(word for word, number in words.items() if number in seen)
    if column.low is None or column.high is None:
        return "unknown"
    if column.shape.kind is Kind.INT and column.low != column.high:
        return f"{column.low:.0f} … {column.high:.0f}"
    if column.low == column.high:
        return f"always {column.low + 0:.9g}"
    digits = next(
        digits
        for digits in (5, 7, 9, 12, 17)
        if f"{column.low:.{digits}g}" != f"{column.high:.{digits}g}"
    )
    return f"{column.low + 0:.{digits}g} … {column.high + 0:.{digits}g}"


def spark(column: Column, profile: Profile) -> str:
    """The course in a few characters; a blank is where nothing was said."""
    if is_constant(column):
        return ""
    stretches = column.course.until(profile.end)
    lows = [one.low for one in stretches if one.low is not None]
    highs = [one.high for one in stretches if one.high is not None]
    low, high = min(lows, default=0.0), max(highs, default=0.0)
    drawn = ""
    for place in range(_WIDTH):
        first = place * len(stretches) // _WIDTH
        own = stretches[first : max(first + 1, (place + 1) * len(stretches) // _WIDTH)]
        numbers = [
            (one.low + one.high) / 2 for one in own if one.low is not None and one.high is not None
        ]
        if column.is_event and any(one.updates and one.high != 0.0 for one in own):
            drawn += "│"
        elif numbers and not column.is_event:
            share = (sum(numbers) / len(numbers) - low) / (high - low) if high > low else 0.5
            drawn += _BARS[min(len(_BARS) - 1, int(share * len(_BARS)))]
        else:
            drawn += " "
    return drawn.rstrip()
