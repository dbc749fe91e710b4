"""The page of one run: its attempts with reasons and timelines, and the command to repeat it."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import groupby, islice

from rvmon.report import panel_html
from rvmon.report.attempt_panels import Panel, RunPage, opening, panel_id, panels_of
from rvmon.report.html import e, render
from rvmon.report.time_axis import View, moment, whole_run
from rvmon.report.timeline import axis_row, place_of
from rvmon.report.tracks import PLACES, Outline, Scene, Track, TrackKind
from rvmon.report.wording import forecast_sentence, health_facts, instants_of, value_text
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TICKS_PER_SECOND, format_stamped
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report

UNITS = 1000  # SVG units per metre; and integer steps per radian
MILLISECOND = 1_000_000  # a millisecond in ticks


def scene_svg(scene: Scene, instant: int) -> ET.Element:
    """Draw a scene at an instant (ticks)."""
    left, bottom, right, top = (round(edge * UNITS) for edge in scene.view)
    # In SVG, y grows downwards, so every z and every angle is negated.
    drawing = e(
        "svg",
        {"viewBox": f"{left} {-top} {right - left} {top - bottom}", "role": "img"},
        e("title", None, "The scene at the cursor's instant"),
    )
    index = max(bisect_right(scene.frames, instant, key=lambda frame: frame[0]) - 1, 0)
    pose = scene.frames[index][1] if scene.frames else ()
    for outline in scene.outlines:
        group = e("g", {"class": f"body {outline.role}"}, _shape(outline))
        if outline.body in scene.bodies and pose:
            body = scene.bodies.index(outline.body)
            x, z, angle = pose[3 * body : 3 * body + 3]
            group.set("data-body", str(body))
            turn = f"rotate({-math.degrees(angle):.1f})"
            group.set("transform", f"translate({x * UNITS:.0f} {-z * UNITS:.0f}) {turn}")
        drawing.append(group)
    return drawing


def scene_data(scene: Scene, origin: int) -> dict[str, object]:
    """The frames as small integers, delta-encoded.

    Times are milliseconds since `origin`, positions millimetres, angles milliradians.
    """
    times = [(t - origin) // MILLISECOND for t, _ in scene.frames]
    columns = zip(*(pose for _, pose in scene.frames), strict=True)
    values = [[round(value * UNITS) for value in column] for column in columns]
    return {"times": _differences(times), "values": [_differences(column) for column in values]}


def _shape(outline: Outline) -> ET.Element:
    corners = [(round(x * UNITS), round(-z * UNITS)) for x, z in outline.corners]
    radius = round(outline.radius * UNITS)
    match corners:
        case [(x, y)]:
            return e("circle", {"cx": x, "cy": y, "r": radius})
        case [(x1, y1), (x2, y2)]:
            width = 2 * radius
            style = f"stroke-width:{width}" if width else None
            return e("line", {"x1": x1, "y1": y1, "x2": x2, "y2": y2, "style": style})
        case _:
            points = " ".join(f"{x},{y}" for x, y in corners)
            return e("polygon", {"points": points})


def _differences(values: list[int]) -> list[int]:
    return [value - before for before, value in zip([0, *values], values, strict=False)]


WORST_FIRST = (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS, Verdict.NOT_TRIGGERED)

MOST_DRAWN = 5_000  # the most attempts drawn per requirement and verdict in the overview


def run_page(content: RunPage) -> str:
    """The page of a run as HTML.

    Without scripts it shows all attempts, one below the other. The script shows one at a time,
    moves the cursor and plays the scene. An address that ends in `#R2` opens on requirement R2.
    """
    report, samples, scene = content.run.report, content.run.samples, content.scene
    panels = panels_of(content)
    requirement, attempt = opening(report)
    first = next(panel for panel in panels if panel.id == panel_id(requirement, attempt))
    view = whole_run(report, samples[0].t if samples else report.origin)
    cut = [
        name
        for name, counts in report.counts.items()
        if any(n > MOST_DRAWN for n in counts.values())
    ]
    return render(
        "run.html",
        title=panel_html.headline(content.run.name, first, report.origin).replace("`", ""),
        spec=content.spec,
        run=content.run,
        report=report,
        back=content.back,
        back_to=content.back_to,
        rows=_rows(report, panels, view),
        axis=axis_row(view, report.origin),
        cut=cut,
        most_drawn=MOST_DRAWN,
        panels=panels,
        first=first,
        timeline_of=lambda panel: panel_html.panel_timeline(
            panel, content.spec.requirements[panel.requirement], report
        ),
        parts_of=lambda panel: panel_html.parts_timeline(panel, report),
        siblings=partial(_siblings, panels, report),
        scene=None if scene is None else scene_svg(scene, first.instant),
        command=content.command,
        facts=content.facts,
        script=script_data(content, panels, view),
        distinct=dict.fromkeys,
        instants_of=instants_of,
        stamped=format_stamped,
        health_facts=health_facts,
        forecast_sentence=forecast_sentence,
        has_unknown=panel_html.has_unknown,
        headline=panel_html.headline,
        value_text=value_text,
        moment=moment,
        spec_lines=panel_html.spec_lines,
    )


Bar = tuple[str, Verdict]  # the CSS position of an attempt, and its verdict


def _rows(
    report: Report, panels: Sequence[Panel], view: View
) -> list[tuple[str, Panel, list[Bar]]]:
    """A row per requirement, the worst first: its id, worst panel and bars."""
    worst: dict[str, Panel] = {}
    for panel in sorted(panels, key=lambda panel: WORST_FIRST.index(panel.verdict)):
        worst.setdefault(panel.requirement, panel)
    rows = []
    for name in sorted(worst, key=lambda name: WORST_FIRST.index(report.verdicts[name])):
        bars = [(place_of(left, width), shown) for left, width, shown in _bars(report, name, view)]
        rows.append((name, worst[name], bars))
    return rows


def _siblings(panels: Sequence[Panel], report: Report, panel: Panel) -> tuple[list[Panel], int]:
    """The panels of the same requirement, and the number of its attempts that are not shown."""
    siblings = [one for one in panels if one.requirement == panel.requirement and one.attempt]
    return siblings, max(sum(report.counts[panel.requirement].values()) - len(siblings), 0)


def _bars(report: Report, name: str, view: View) -> Iterator[tuple[float, float, Verdict]]:
    """The bars over the run: left edge, width, and the worst verdict of overlapping attempts."""
    import numpy as np

    places: list[Verdict | None] = [None] * PLACES
    # The worst verdict last, as it overwrites the others.
    for verdict in (Verdict.PASS, Verdict.INCONCLUSIVE, Verdict.FAIL):
        spans = [
            (one.triggered, view.end if one.decided is None else one.decided)
            for one in islice(report.of(name, verdict), MOST_DRAWN)
        ]
        instants = np.array(spans, np.int64).reshape(-1, 2).T
        shares = (instants - view.start) / (view.end - view.start)
        first, last = np.clip(shares * PLACES, 0, PLACES - 1).astype(np.int64)
        # At each place, the attempts that start there minus those that ended at the place before.
        changes = np.bincount(first, minlength=PLACES + 1)
        changes -= np.bincount(last + 1, minlength=PLACES + 1)
        for place in np.flatnonzero(changes.cumsum()).tolist():
            places[place] = verdict
    at = 0
    for shown, group in groupby(places):
        count = len(list(group))
        if shown is not None:
            yield at / PLACES, count / PLACES, shown
        at += count


READ_OUT = 2_000  # the most values of a track that the cursor can read out


def script_data(content: RunPage, panels: Sequence[Panel], view: View) -> dict[str, object]:
    """The data for the page's script as JSON values; times are in seconds since the origin."""
    origin = content.run.report.origin
    document: dict[str, object] = {
        "start": _seconds(view.start, origin),
        "end": _seconds(view.end, origin),
        "panels": {panel.id: _panel_data(panel, origin) for panel in panels},
    }
    if content.scene is not None:
        document["scene"] = scene_data(content.scene, origin)
    return document


def _panel_data(panel: Panel, origin: int) -> dict[str, object]:
    attempt = panel.attempt
    return {
        "requirement": panel.requirement,
        "start": _seconds(panel.view.start, origin),
        "end": _seconds(panel.view.end, origin),
        "instant": _seconds(panel.instant, origin),
        "trigger": None if attempt is None else _seconds(attempt.triggered, origin),
        "tracks": {
            track.name: _track_data(track, panel.view, origin)
            for track in panel.tracks
            if track.kind is not TrackKind.EVENT
        },
    }


def _track_data(track: Track, view: View, origin: int) -> dict[str, object]:
    inside = track.between(view.start + 1, view.end)
    # Thinned without regard to extremes: the cursor's numbers need none, the drawing has its own.
    inside = inside[:: len(inside) // READ_OUT + 1]
    changes = [(view.start, track.value_at(view.start)), *inside]
    return {
        "unit": track.unit,
        "t": [_seconds(t, origin) for t, _ in changes],
        "v": [_finite(value) for _, value in changes],
    }


def _seconds(instant: int, origin: int) -> float:
    return (instant - origin) / TICKS_PER_SECOND


def _finite(value: Scalar) -> Scalar:
    """A value that JSON can represent: infinities become text."""
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
