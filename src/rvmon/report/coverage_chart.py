"""The chart of how coverage grew, test by test."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from rvmon.coverage.answers import Step
from rvmon.report.coverage_summary import Summary, strategy_name
from rvmon.report.markup import Child, e
from rvmon.report.percent import counted, share_text

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
