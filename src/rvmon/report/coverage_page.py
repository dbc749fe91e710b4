"""The page of coverage, for who decides what to test next: what is wrong, what is missing."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence

from rvmon.coverage.answers import Comparison, Step
from rvmon.report.coverage_items import groups_sections, hitters_list, item_link
from rvmon.report.coverage_summary import (
    LISTED,
    Summary,
    counted,
    name_of,
    share_text,
    strategy_name,
)
from rvmon.report.coverage_tests import letter, listed_tests, test_link, tests_section
from rvmon.report.markup import Child, e, page, scroll, with_code
from rvmon.report.percent import percent_text
from rvmon.report.table_html import legend, table_html
from rvmon.verdict.verdict import Verdict

WIDTH, HEIGHT = 1000, 100
"""Units of the drawing, which is stretched to the width of the page."""

COLOURS = 6
"""Strategies that have a colour of their own; the others share one."""

DOTS = 300
"""Tests with a dot that leads to their line; of more, only the line is drawn."""


def growth_chart(summary: Summary) -> ET.Element:
    """Draw the share that is covered after each test.

    The dots on the line of all tests have the colour of the strategy that added something there.
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
    """Steps from nothing to the share of all: a point before and behind each rise."""
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
    """Which line is whose, with what it reached alone."""
    parts = [e("span", None, e("i", {"class": "line all"}), "all tests")]
    for name, steps in summary.alone.items():
        reached = f"{share_text(steps[-1].share)} with {counted(len(steps), 'test')}"
        text = f"{strategy_name(name)} alone: {reached}"
        parts.append(e("span", None, e("i", {"class": f"line s{numbers[name]}"}), text))
    return e("p", {"class": "soft keys"}, *parts)


OPEN = 30
"""Lines of a list that is shown at once; of a longer one, the rest is behind a click."""


def coverage_page(summary: Summary) -> str:
    """Write the page; it needs no script and nothing but itself."""
    listed = listed_tests(summary)
    body: list[Child] = [
        _header(summary),
        _wrong(summary),
        _known(summary),
        _overview(summary),
        _comparison(summary),
        _holes(summary),
        _unreachable(summary),
        _verdicts(summary),
        _growth(summary),
        *groups_sections(summary),
        tests_section(summary, listed),
        e("footer", None, legend()),
        hitters_list(summary, listed),
    ]
    title = f"{share_text(summary.share)} covered: {summary.name}"
    return page(title, body, styles=["base.css", "report.css", "coverage.css"], scripts=[])


def _header(summary: Summary) -> ET.Element:
    tests = len(summary.coverage.entries)
    parts = ["nothing to cover" if summary.is_void else f"{share_text(summary.share)} covered"]
    if summary.illegal:
        parts.append(f"{counted(len(summary.illegal), 'illegal item')} hit")
    if summary.not_fine:
        parts.append(f"{len(summary.not_fine):,} of {counted(tests, 'test')} not fine")
    if summary.holes:
        parts.append(counted(len(summary.holes), "hole"))
    about = e("p", {"class": "soft"}, e("code", None, summary.name), f": {summary.tests_text()}")
    return e("header", None, e("h1", None, ", ".join(parts)), about)


def _wrong(summary: Summary) -> ET.Element | None:
    """Illegal hits, then tests that failed or did not complete."""
    parts: list[Child] = []
    for heading, places in (
        ("Illegal hits", summary.illegal),
        ("Hit, and said to be unreachable", summary.contradicted),
    ):
        hits = [
            e("li", None, item_link(summary, place), f" {summary.hit_text(place)}")
            for place in places
        ]
        parts += [e("h3", None, heading), *_list(hits)] if hits else []
    if summary.not_fine:
        lines = [_fault(summary, fault, places) for fault, places in summary.faults.items()]
        parts += [e("h3", None, "Tests that failed or did not complete"), *_list(lines)]
    if not parts:
        return None
    return e("section", {"class": "wrong", "data-verdict": "F"}, e("h2", None, "Wrong"), *parts)


def _known(summary: Summary) -> ET.Element | None:
    """What failed as it was known to."""
    if not summary.known:
        return None
    lines = [_fault(summary, fault, places) for fault, places in summary.known.items()]
    return e("section", None, e("h2", None, "Failed as expected"), *_list(lines))


def _fault(summary: Summary, fault: str, places: Sequence[int]) -> ET.Element:
    links: list[Child] = []
    for place in places[:LISTED]:
        links += [test_link(summary, place), " "]
    rest = len(places) - LISTED
    more = f"and {rest:,} more" if rest > 0 else None
    return e("li", None, f"{fault}: {counted(len(places), 'test')} ", *links, more)


def _overview(summary: Summary) -> ET.Element:
    total = e(
        "tr",
        {"class": "total"},
        e("th", {"scope": "row"}, "total"),
        e("td", {"class": "text"}),
        e("td", None, _bar(summary.share)),
        e("td"),
        e("td", None, share_text(summary.share)),
    )
    rows: list[ET.Element] = []
    whole: list[ET.Element] = []
    for place, group in enumerate(summary.coverage.model.groups.values()):
        score = summary.scores[group.name]
        share = score.covered / score.items if score.items else 1.0
        about = group.subject.value
        about += "" if group.weight == 1 else f", weight {group.weight}" if group.weight else ""
        about += "" if group.weight else ", not in the total"
        link = e("a", {"href": f"#g{place}"}, *with_code(group.name))
        row = e(
            "tr",
            None,
            e("th", {"scope": "row"}, link),
            e("td", {"class": "text soft"}, about),
            e("td", None, _bar(share)),
            e("td", None, f"{score.covered:,} of {score.items:,}"),
            e("td", None, percent_text(score.covered, score.items)),
        )
        (whole if share == 1 else rows).append(row)
    parts: list[Child] = [e("h2", None, "Covered")]
    if len(rows) + len(whole) <= OPEN:
        rows += whole
    elif whole:
        heading = e("summary", None, f"{counted(len(whole), 'group')} covered")
        parts.append(e("details", None, heading, _groups(whole)))
    parts.insert(1, _groups([total, *rows]))
    return e("section", None, *parts)


def _groups(rows: Sequence[ET.Element]) -> ET.Element:
    return scroll(e("table", {"class": "groups"}, e("tbody", None, *rows)))


def _comparison(summary: Summary) -> ET.Element | None:
    found = summary.comparison
    if found is None:
        return None
    places = {item: place for place, item in enumerate(summary.coverage.items)}
    change = f": {share_text(found.before)} → {share_text(found.after)}"
    parts: list[Child] = [e("p", None, e("code", None, summary.earlier_name), change)]
    for heading, items, verdict in (
        ("New illegal hits", found.illegal, Verdict.FAIL),
        ("Lost", found.lost, Verdict.INCONCLUSIVE),
        ("Newly covered", found.gained, Verdict.PASS),
        ("No longer in the model", found.dropped, Verdict.NOT_TRIGGERED),
    ):
        if items:
            head = e("h3", {"data-verdict": verdict.value}, f"{heading} ", _count(items))
            names = (
                item_link(summary, places[item]) if item in places else name_of(item)
                for item in items
            )
            parts += [head, *_list([e("li", None, name) for name in names])]
    parts += _changes(found)
    if len(parts) == 1:
        parts.append(e("p", {"class": "soft"}, "Nothing else changed."))
    return e("section", None, e("h2", None, "Since an earlier campaign"), *parts)


def _changes(found: Comparison) -> Sequence[Child]:
    if not found.verdicts:
        return ()
    lines = [
        e(
            "li",
            None,
            f"{one.test}: {one.requirement} ",
            _verdict(one.before),
            " → ",
            _verdict(one.after),
        )
        for one in found.verdicts
    ]
    return e("h3", None, "Verdicts that changed ", _count(found.verdicts)), *_list(lines)


def _verdicts(summary: Summary) -> ET.Element | None:
    table = summary.verdicts()
    if not table.requirements:
        return None

    examples: dict[tuple[str, str, Verdict], str] = {}
    for place, entry in enumerate(summary.coverage.entries):
        for name, verdict in entry.record.verdicts.items():
            key = (strategy_name(entry.record.strategy), name, verdict)
            examples.setdefault(key, f"#t{place}")

    def link(strategy: str, name: str, verdict: Verdict) -> str | None:
        return examples.get((strategy, name, verdict))

    return e("section", None, e("h2", None, "Verdicts"), table_html(table, link=link))


def _holes(summary: Summary) -> ET.Element | None:
    if not summary.holes:
        return None
    lines = []
    for place in summary.holes:
        count, goal = int(summary.totals.counts[place]), int(summary.goals.goal[place])
        why = "; ".join(summary.coverage.reasons.get(summary.coverage.items[place], ()))
        of = f"{count:,} of {counted(goal, 'hit')}" if goal > 1 else "never hit"
        lines.append(
            e(
                "li",
                None,
                item_link(summary, place),
                e("span", {"class": "soft"}, f" {of}"),
                *(with_code(f": {why}") if why else ()),
                e("br"),
                e("small", None, *with_code(str(summary.hole_texts[place]))),
            )
        )
    return e("section", None, e("h2", None, "Holes ", _count(lines)), *_list(lines))


def _unreachable(summary: Summary) -> ET.Element | None:
    """What is no goal, as it cannot be hit: by the reasons."""
    if not summary.unreachable:
        return None
    lines = []
    for reason, places in summary.unreachable.items():
        names: list[Child] = []
        for place in places:
            names += [", " if names else ": ", item_link(summary, place)]
        lines.append(e("li", None, *with_code(reason), *names))
    count = e("small", None, f"{sum(map(len, summary.unreachable.values())):,}")
    heading = e("summary", None, e("h2", None, "No goals, as they cannot be hit ", count))
    return e("section", None, e("details", None, heading, *_list(lines)))


def _growth(summary: Summary) -> ET.Element | None:
    if len(summary.coverage.entries) < 2:
        return None
    order = summary.ranking
    names: list[Child] = []
    for step in order[:OPEN]:
        names += [test_link(summary, step.entry), " "]
    more = f"… and {len(order) - OPEN:,} more" if len(order) > OPEN else None
    return e(
        "section",
        None,
        e("h2", None, "Growth"),
        growth_chart(summary),
        e("p", {"class": "order"}, f"{summary.ranking_text()}: ", *names, more),
    )


def _verdict(verdict: Verdict | None) -> Child:
    return "–" if verdict is None else letter(verdict)


def _list(lines: Sequence[ET.Element]) -> list[ET.Element]:
    """Lines, the first of them at once."""
    first = e("ul", {"class": "lines"}, *lines[:OPEN])
    if len(lines) <= OPEN:
        return [first]
    rest = e("ul", {"class": "lines"}, *lines[OPEN:])
    more = e("summary", None, f"{len(lines) - OPEN:,} more")
    return [first, e("details", None, more, rest)]


def _bar(share: float) -> ET.Element:
    filled = e("span", {"style": f"width:{share:.2%}"})
    return e("span", {"class": "bar", "aria-hidden": "true"}, filled)


def _count(items: Iterable[object]) -> ET.Element:
    return e("small", None, f"{sum(1 for _ in items):,}")
