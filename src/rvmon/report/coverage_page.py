"""The coverage page: faults, holes, crosses, tests and growth."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from functools import partial

from markupsafe import Markup

from rvmon.coverage import Group, Item, TestRecord
from rvmon.coverage.analysis import Step
from rvmon.language.checked.properties import BinKind
from rvmon.report.coverage_summary import LISTED, Summary, cell_look, is_grid, strategy_name
from rvmon.report.html import Child, e, render, table_html
from rvmon.report.verdict_table import VerdictTable
from rvmon.texts import counted, share_text
from rvmon.verdicts import Verdict

WIDTH, HEIGHT = 1000, 100
"""The size of the drawing in SVG units; it is stretched to the width of the page."""

COLOURS = 6  # the number of strategies with a colour of their own; the others share one
DOTS = 300  # the most tests marked by dots with links; with more, only the line is drawn


def growth_chart(summary: Summary) -> ET.Element:
    """Draw the covered share after each test.

    A dot on the line of all tests has the colour of the strategy whose test added items there.
    """
    count = len(summary.coverage.entries)
    numbers = {name: min(at, COLOURS) for at, name in enumerate(summary.strategies)}
    several = len(numbers) > 1
    lines = [("all", summary.steps)]
    if several:
        lines += [(f"s{numbers[name]}", steps) for name, steps in summary.alone.items()]
    drawing = e(
        "svg",
        {"viewBox": f"0 0 {WIDTH} {HEIGHT}", "preserveAspectRatio": "none", "aria-hidden": "true"},
        *(e("polyline", {"class": look, "points": _points(steps, count)}) for look, steps in lines),
    )
    levels = [
        e("span", {"class": "level", "style": f"bottom:{level}%"}, f"{level} %")
        for level in (0, 50, 100)
    ]
    plot = e("div", {"class": "plot"}, *levels, drawing, *_dots(summary, numbers, count))
    first, last = e("span", None, "0"), e("span", None, counted(count, "test"))
    ends = e("p", {"class": "soft ends"}, first, last)
    return e("figure", {"class": "growth"}, plot, ends, _key(summary, numbers) if several else None)


def _points(steps: Sequence[Step], count: int) -> str:
    """The points of a step line from 0: one before and one after each rise."""
    points, level = [(0.0, 0.0)], 0.0
    for number, step in enumerate(steps, 1):
        if step.share != level:
            points += [(number / count, level), (number / count, step.share)]
            level = step.share
    points.append((len(steps) / count, level))
    return " ".join(f"{x * WIDTH:.5g},{(1 - y) * HEIGHT:.4g}" for x, y in points)


def _dots(summary: Summary, numbers: dict[str, int], count: int) -> list[Child]:
    adding = [(number, step) for number, step in enumerate(summary.steps, 1) if step.added]
    if len(adding) > DOTS:
        return []
    dots: list[Child] = []
    for number, step in adding:
        record = summary.record(step.entry)
        added = counted(len(step.added), "item")
        dots.append(
            e(
                "a",
                {
                    "class": f"dot s{numbers[record.strategy]}",
                    "href": f"#t{step.entry}",
                    "title": f"{record.name}: {added} more, {share_text(step.share)}",
                    "style": f"left:{number / count:.2%};bottom:{step.share:.2%}",
                },
            )
        )
    return dots


def _key(summary: Summary, numbers: dict[str, int]) -> ET.Element:
    """The legend of the lines, with the share that each strategy reached alone."""
    parts = [e("span", None, e("i", {"class": "line all"}), "all tests")]
    for name, steps in summary.alone.items():
        reached = f"{share_text(steps[-1].share)} with {counted(len(steps), 'test')}"
        text = f"{strategy_name(name)} alone: {reached}"
        parts.append(e("span", None, e("i", {"class": f"line s{numbers[name]}"}), text))
    return e("p", {"class": "soft keys"}, *parts)


OPEN = 30  # the most lines of a list shown at once; the rest is folded

SHORT, LONG = 8, 40
"""The most items of a list that is always unfolded, and of one that is if it has a hole."""

PALE, STRONG = 12, 62
"""Percent of colour in the cells with the fewest and with the most hits."""

MOST = 2_000  # up to so many tests all are listed; of more, only the notable ones
NAMED = 4  # the most items named that a test added; the rest is counted


def coverage_page(summary: Summary) -> str:
    """The page as HTML; self-contained and without scripts."""
    model = summary.coverage.model
    numbered = list(enumerate(model.groups.values()))
    scored = [(number, group, summary.scores[group.name]) for number, group in numbered]
    groups = [one for one in scored if one[2].items]
    whole = [group for group in groups if group[2].covered == group[2].items]
    rest = [group for group in groups if group not in whole]
    hides_whole = len(groups) > OPEN
    crosses = [one for one in numbered if is_grid(one[1])]
    listed = listed_tests(summary)
    verdicts = summary.verdicts()
    return render(
        "coverage.html",
        title=f"{share_text(summary.share)} covered: {summary.name}",
        headline=_headline(summary),
        summary=summary,
        open=OPEN,
        listed_tests=LISTED,
        shown_groups=rest if hides_whole else [*rest, *whole],
        whole_groups=whole if hides_whole else [],
        changes=summary.changes(),
        place_of={item: place for place, item in enumerate(summary.coverage.items)},
        table=_linked(summary, verdicts) if verdicts.requirements else None,
        chart=growth_chart(summary) if len(summary.coverage.entries) > 1 else None,
        crosses=crosses,
        lists=[one for one in numbered if not is_grid(one[1])],
        keys=_keys([group for _, group in crosses]),
        grid_of=partial(_grid, summary),
        look_of=partial(_look, summary),
        is_open=partial(_is_open, summary),
        most_hits=partial(_most_hits, summary),
        listed=listed,
        unlisted=len(summary.coverage.entries) - len(listed),
        columns=_columns(summary, listed),
        verdicts_of=_verdicts_of,
        added=partial(_added, summary),
        number_of={group.name: number for number, group in numbered},
    )


def _headline(summary: Summary) -> str:
    tests = len(summary.coverage.entries)
    parts = ["nothing to cover" if summary.is_empty else f"{share_text(summary.share)} covered"]
    if summary.illegal:
        parts.append(f"{counted(len(summary.illegal), 'illegal item')} hit")
    if summary.not_fine:
        parts.append(f"{len(summary.not_fine):,} of {counted(tests, 'test')} with problems")
    if summary.holes:
        parts.append(counted(len(summary.holes), "hole"))
    return ", ".join(parts)


def _linked(summary: Summary, table: VerdictTable) -> Markup:
    """The table of tests by verdict, with each count linked to an example."""
    examples: dict[tuple[str, str, Verdict], str] = {}
    for place, entry in enumerate(summary.coverage.entries):
        for name, verdict in entry.record.verdicts.items():
            key = (strategy_name(entry.record.strategy), name, verdict)
            examples.setdefault(key, f"#t{place}")
    return table_html(table, link=lambda *key: examples.get(key))


def _is_open(summary: Summary, group: Group) -> bool:
    """Whether a list of items is unfolded: it is short, or has a hole or an illegal hit."""
    if len(group.items) <= SHORT:
        return True
    places = range(summary.starts[group.name], summary.starts[group.name] + len(group.items))
    wrong = (*summary.holes, *summary.illegal)
    return len(places) <= LONG and any(place in places for place in wrong)


def _look(summary: Summary, place: int, item: Item, most: int) -> tuple[str, float | None, str]:
    """The CSS class, percent of colour and text of an item's cell.

    The colour is logarithmic in the hits, up to `most`.
    """
    kind, count = summary.kind(place, item), int(summary.totals.counts[place])
    look, text = cell_look(kind, item.goal, count)
    if look != "covered":
        return look, None, text
    # Hits vary by orders of magnitude: on a linear scale most cells would look alike.
    share = math.log(count) / math.log(most) if most > 1 else 1.0
    return look, PALE + (STRONG - PALE) * share, text


def _most_hits(summary: Summary, group: Group) -> int:
    start = summary.starts[group.name]
    return int(summary.totals.counts[start : start + len(group.items)].max(initial=0))


def _grid(summary: Summary, group: Group) -> dict[str, object]:
    """A cross as values of the template: its axes, rows, and the most hits of an item.

    A row consists of its heads, each with the number of rows that it spans, and its items with
    their places.
    """
    grid = summary.grid(group)
    axes = [group.axes[name] for name in grid.down]
    rows = [(_heads(axes, number), items) for number, (_, items) in enumerate(grid.rows)]
    return {**grid._asdict(), "rows": rows, "most": _most_hits(summary, group)}


def _heads(axes: Sequence[Sequence[str]], number: int) -> list[tuple[str, int]]:
    """The heads of a row, each with its span; a bin appears only in the first row of its span."""
    heads = []
    span = math.prod(map(len, axes))
    for names in axes:
        each = span // len(names)
        if number % each == 0:
            heads.append((names[number // each % len(names)], each))
        span = each
    return heads


def _keys(groups: Sequence[Group]) -> list[tuple[str, str, str]]:
    """The legend of the cells that occur in heat maps."""
    items = [item for group in groups for item in group.items.values()]
    kinds = {item.kind for item in items}
    keys = [("covered", "7", "covered: hits"), ("hole", "0", "hole")]
    if any(item.goal > 1 for item in items):
        keys.append(("hole", "1/3", "hit once, goal 3"))
    if BinKind.ILLEGAL in kinds:
        keys += [("illegal", "!", "illegal"), ("illegal hit", "2 !", "illegal, hit")]
    if BinKind.IGNORE in kinds:
        keys.append(("ignored", "–", "ignored"))
    return keys


def listed_tests(summary: Summary) -> Collection[int]:
    """The tests that have a line: all, or those mentioned elsewhere on the page."""
    every = range(len(summary.coverage.entries))
    if len(every) <= MOST:
        return every
    wanted = {*summary.not_fine, *(step.entry for step in summary.ranking)}
    wanted.update(step.entry for step in summary.steps if step.added)
    wanted.update(place for place in every if summary.unique[place])
    wanted.update(place for place in summary.totals.first.tolist() if place >= 0)
    for place in summary.illegal:
        wanted.update(summary.first_hitters[place])
    # The first test with each verdict of each requirement: the table of counts links to it.
    seen: set[tuple[str, str, Verdict]] = set()
    for place in every:
        record = summary.record(place)
        shown = {(record.strategy, *item) for item in record.verdicts.items()}
        if not shown <= seen:
            seen |= shown
            wanted.add(place)
    return dict.fromkeys(sorted(wanted))


def _columns(summary: Summary, listed: Collection[int]) -> list[str]:
    """The columns of the list of tests that have contents; campaigns only if there are several."""
    shown = {
        "campaign": len(summary.coverage.campaigns) > 1,
        "strategy": any(summary.strategies),
        "seed": any(summary.record(place).seed is not None for place in listed),
        "recording": any(summary.record(place).recording for place in listed),
    }
    return [name for name, is_shown in shown.items() if is_shown]


def _verdicts_of(record: TestRecord) -> Iterator[tuple[str, Verdict, str]]:
    """The failed requirements, and the count of each other verdict; as text, letter, text."""
    if record.failed:
        yield "", Verdict.FAIL, f" {', '.join(record.failed)}"
    if known := record.failed_as_expected:
        yield "", Verdict.FAIL, f" {', '.join(known)} as expected"
    counts = Counter(record.verdicts.values())
    for verdict in (Verdict.INCONCLUSIVE, Verdict.NOT_TRIGGERED, Verdict.PASS):
        if counts[verdict]:
            yield f"{counts[verdict]:,} ", verdict, ""


def _added(summary: Summary, added: Sequence[int]) -> str:
    names = [summary.item_name(place) for place in added[:NAMED]]
    more = [f"and {len(added) - NAMED:,} more"] if len(added) > NAMED else []
    return ", ".join([*names, *more])
