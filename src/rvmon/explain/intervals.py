"""Sets of ticks as sorted, disjoint, closed intervals, and the temporal operators on them."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from itertools import pairwise

Spans = tuple[tuple[int, int], ...]
"""Closed intervals of ticks, ascending, none touching the next."""

FOREVER = 1 << 63
"""Later than any tick."""


def union(intervals: Iterable[tuple[int, int]]) -> Spans:
    """The ticks of some intervals; empty ones are dropped.

    >>> union([(5, 7), (1, 2), (3, 4)])
    ((1, 7),)
    """
    merged: list[tuple[int, int]] = []
    for low, high in sorted(intervals):
        if low > high:
            continue
        if merged and low <= merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], max(merged[-1][1], high))
        else:
            merged.append((low, high))
    return tuple(merged)


def holds(spans: Spans, t: int) -> bool:
    """Whether a tick lies in one of the spans."""
    place = bisect_right(spans, t, key=lambda span: span[0])
    return place > 0 and t <= spans[place - 1][1]


def both(left: Spans, right: Spans) -> Spans:
    """The ticks that lie in both."""
    return union((max(a, c), min(b, d)) for a, b in left for c, d in right)


def outside(spans: Spans, low: int, high: int) -> Spans:
    """The ticks from `low` to `high` that lie in none.

    >>> outside(((2, 3),), 0, 5)
    ((0, 1), (4, 5))
    """
    edges = [(low - 1, low - 1), *spans, (high + 1, high + 1)]
    return union((a + 1, b - 1) for (_, a), (b, _) in pairwise(edges))
