"""The parts of a requirement on the page of a run: when each was true."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from itertools import groupby

from rvmon.explain.anatomy import Strand
from rvmon.report.markup import Child, e
from rvmon.report.panel import Panel
from rvmon.report.timeline import axis_row, guides_of
from rvmon.report.track_rows import truth_row
from rvmon.report.tracks import Track, TrackKind
from rvmon.trace.sample import Scalar
from rvmon.verdict.verdict import Verdict

DEEPEST = 8
"""Parts that lie deeper are not indented further."""


def parts_details(panel: Panel, origin: int, end: int) -> ET.Element | None:
    """A row for the trigger and for each part of what is owed; nothing if there are none.

    Args:
        panel: with strands.
        origin: the instant from which people count seconds, ticks.
        end: the last instant of the run, ticks.
    """
    if not panel.strands or panel.attempt is None:
        return None
    rows: list[Child] = []
    for part, strands in groupby(panel.strands, key=lambda strand: strand.part):
        rows.append(e("div", {"class": "part"}, part))
        rows += [_row(strand, panel, end) for strand in strands]
    rows.append(axis_row(panel.view, origin))
    overlay = e(
        "div",
        {"class": "overlay"},
        *guides_of(panel.attempt, panel.view, end, panel.late),
        e("div", {"class": "cursor"}),
    )
    open_ = panel.attempt.verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE)
    return e(
        "details",
        {"class": "parts", "open": open_},
        e("summary", None, "when each part of it was true"),
        e("div", {"class": "timeline"}, *rows, overlay),
        e(
            "p",
            {"class": "legend"},
            e("span", None, e("i", {"class": "key on"}), "true"),
            e("span", None, e("i", {"class": "key unknown"}), "not known"),
        ),
    )


def _row(strand: Strand, panel: Panel, end: int) -> ET.Element:
    indent = f"padding-left:{0.7 * min(strand.depth, DEEPEST):g}rem"
    label = e("code", {"style": indent}, strand.text)
    track = Track(strand.text, TrackKind.SWITCH, _changes(strand))
    return truth_row(label, track, panel.view, end)


def _changes(strand: Strand) -> tuple[tuple[int, Scalar], ...]:
    """From when on it is true, false, or not known."""
    stretches: Sequence[tuple[int, int, bool]] = sorted(
        [(a, b, True) for a, b in strand.true] + [(a, b, False) for a, b in strand.false]
    )
    changes: list[tuple[int, Scalar]] = []
    after: int | None = None
    for first, last, value in stretches:
        if after is not None and first > after:
            changes.append((after, None))
        changes.append((first, value))
        after = last + 1
    if after is not None:
        changes.append((after, None))
    return tuple(changes)
