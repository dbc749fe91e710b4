"""Items on the page of coverage: lists, heat maps of crosses, and which tests hit what."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Collection, Sequence
from itertools import product

from rvmon.coverage.model import Group, Item, combination
from rvmon.report.coverage_summary import Summary, cell_text, is_grid
from rvmon.report.coverage_tests import test_link
from rvmon.report.markup import Child, e, scroll, with_code
from rvmon.spec.checked.goals import BinKind

SHORT, LONG = 8, 40
"""Items of a list that is always open, and of one that is open if something is missing."""

PALE, STRONG = 12, 62
"""Percent of colour in the cell that was hit least, and in the one hit most often."""


def item_link(summary: Summary, place: int) -> ET.Element:
    """An item's name that leads to the tests that hit it."""
    return _linked(summary, place, summary.item_name(place))


def groups_sections(summary: Summary) -> list[ET.Element]:
    """All items: crosses as heat maps, other groups as lists beside each other."""
    maps: list[Child] = []
    lists: list[Child] = []
    for number, group in enumerate(summary.coverage.model.groups.values()):
        score = summary.scores[group.name]
        about = f"{group.subject.value}, {score.covered:,} of {score.items:,} covered"
        title = (*with_code(group.name), e("small", None, about))
        if is_grid(group):
            heading = e("h3", {"id": f"g{number}"}, *title)
            maps.append(e("div", {"class": "cross"}, heading, _heat_map(summary, group)))
        else:
            lists.append(
                e(
                    "details",
                    {"id": f"g{number}", "open": _is_open(summary, group)},
                    e("summary", None, e("h3", None, *title)),
                    _list(summary, group),
                )
            )
    sections = []
    if maps:
        grid = e("div", {"class": "crosses"}, *maps)
        crosses = [group for group in summary.coverage.model.groups.values() if is_grid(group)]
        sections.append(e("section", None, e("h2", None, "Crosses"), grid, _key(crosses)))
    if lists:
        grid = e("div", {"class": "lists"}, *lists)
        sections.append(e("section", None, e("h2", None, "Other groups"), grid))
    return sections


def _is_open(summary: Summary, group: Group) -> bool:
    """Whether a list is short, or something in it is to be seen."""
    if len(group.items) <= SHORT:
        return True
    own = range(summary.starts[group.name], summary.starts[group.name] + len(group.items))
    return len(own) <= LONG and any(one in own for one in (*summary.holes, *summary.illegal))


def hitters_list(summary: Summary, listed: Collection[int]) -> ET.Element:
    """By item the tests that hit it: a cell's address opens one of these over the page."""
    lines = []
    numbers = {name: number for number, name in enumerate(summary.coverage.model.groups)}
    for place, tests in sorted(summary.hitters.items()):
        links: list[Child] = []
        for test in tests:
            known = test in listed
            links += [test_link(summary, test) if known else summary.record(test).name, " "]
        more = int(summary.totals.tests[place]) - len(tests)
        back = f"#g{numbers[summary.coverage.items[place][0]]}"
        lines.append(
            e(
                "li",
                {"id": f"i{place}"},
                e("a", {"class": "close", "href": back, "title": "close"}, "×"),
                e("b", None, *with_code(summary.item_name(place))),
                f" {summary.hit_text(place)}",
                e("p", None, *links, f"and {more:,} more" if more > 0 else None),
            )
        )
    return e("ul", {"class": "hitters"}, *lines)


def _linked(summary: Summary, place: int, text: str) -> ET.Element:
    if not summary.totals.counts[place]:
        return e("span", None, *with_code(text))
    return e("a", {"href": f"#i{place}", "title": summary.hit_text(place)}, *with_code(text))


def _list(summary: Summary, group: Group) -> ET.Element:
    rows = []
    for place, item in summary.places(group):
        tests = int(summary.totals.tests[place])
        kind = summary.kind_text(place, item)
        rows.append(
            e(
                "tr",
                None,
                e("th", {"scope": "row"}, *with_code(item.name), e("small", None, kind)),
                _cell(summary, place, item, _most(summary, group)),
                e("td", None, f"{tests:,}" if tests else ""),
                e("td", {"class": "text first"}, _first(summary, place)),
            )
        )
    names = ("item", "hits", "tests", "first hit by")
    head = e("tr", None, *(e("th", None, name) for name in names))
    grid = e("table", {"class": "items"}, e("thead", None, head), e("tbody", None, *rows))
    return scroll(grid)


def _first(summary: Summary, place: int) -> Child:
    first = int(summary.totals.first[place])
    return None if first < 0 else test_link(summary, first)


def _heat_map(summary: Summary, group: Group) -> ET.Element:
    """A cross: the bins of the last axis from left to right, those of the others nested."""
    *down, (across, columns) = group.axes.items()
    places = {item.name: (place, item) for place, item in summary.places(group)}
    most = _most(summary, group)
    heads: list[Child] = [e("th", {"class": "axis"}, axis) for axis, _ in down] or [e("th")]
    heads += [e("th", {"scope": "col"}, name) for name in columns]
    above = e(
        "tr",
        None,
        e("th", {"colspan": max(len(down), 1)}),
        e("th", {"colspan": len(columns), "class": "axis"}, across),
    )
    rows = []
    for number, bins in enumerate(product(*(names for _, names in down))):
        cells: list[Child] = _row_heads([names for _, names in down], number) or [e("th")]
        for name in columns:
            known = places.get(combination([*bins, name]))
            cells.append(e("td") if known is None else _cell(summary, *known, most))
        rows.append(e("tr", None, *cells))
    head = e("thead", None, above, e("tr", None, *heads))
    grid = e("table", {"class": "heat"}, head, e("tbody", None, *rows))
    return scroll(grid)


def _row_heads(axes: Sequence[Sequence[str]], number: int) -> list[Child]:
    """The heads of a row: a bin stands once, beside all rows that it is in."""
    heads: list[Child] = []
    span = math.prod(map(len, axes))
    for names in axes:
        each = span // len(names)
        if number % each == 0:
            name = names[number // each % len(names)]
            heads.append(e("th", {"scope": "row", "rowspan": each if each > 1 else None}, name))
        span = each
    return heads


def _cell(summary: Summary, place: int, item: Item, most: int) -> ET.Element:
    kind, count = summary.kind(place, item), int(summary.totals.counts[place])
    text = cell_text(kind, item.goal, count)
    style = None
    match kind:
        case BinKind.IGNORE:
            look = "ignored"
        case BinKind.ILLEGAL:
            look = "illegal hit" if count else "illegal"
        case BinKind.GOAL if count < item.goal:
            look = "hole"
        case BinKind.GOAL:
            look = "covered"
            share = math.log(count) / math.log(most) if most > 1 else 1.0
            style = f"--share:{PALE + (STRONG - PALE) * share:.0f}%"
    return e("td", {"class": look, "style": style}, _linked(summary, place, text))


def _most(summary: Summary, group: Group) -> int:
    """The hits of the item of a group that was hit most often."""
    start = summary.starts[group.name]
    return int(summary.totals.counts[start : start + len(group.items)].max(initial=0))


def _key(groups: Sequence[Group]) -> ET.Element:
    """What the cells of heat maps mean, of those that there are."""
    items = [item for group in groups for item in group.items.values()]
    kinds = {item.kind for item in items}
    keys = [("covered", "7", "covered: hits"), ("hole", "0", "hole")]
    if any(item.goal > 1 for item in items):
        keys.append(("hole", "1/3", "hit once, goal 3"))
    if BinKind.ILLEGAL in kinds:
        keys += [("illegal", "!", "illegal"), ("illegal hit", "2 !", "illegal, hit")]
    if BinKind.IGNORE in kinds:
        keys.append(("ignored", "–", "ignored"))
    parts = [
        e("span", None, e("i", {"class": f"heat-key {look}"}, sign), f" {word}")
        for look, sign, word in keys
    ]
    return e("p", {"class": "soft keys"}, *parts)
