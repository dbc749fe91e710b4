"""The page of one run: what failed, why, when, and how to see it again."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from rvmon.report.markup import Child, data, e, page
from rvmon.report.overview import overview
from rvmon.report.panel import Panel
from rvmon.report.panel_html import headline, panel_section
from rvmon.report.panels_of import opening, panel_id, panels_of
from rvmon.report.run_page import RunPage
from rvmon.report.scene_html import scene_data, scene_svg
from rvmon.report.tracks import Track, TrackKind
from rvmon.report.view import View, whole_run
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TICKS_PER_SECOND


def run_page(content: RunPage) -> str:
    """Write the page of a run.

    Without a script it shows all attempts one below the other; the script shows one at a time,
    moves the cursor and plays the scene. An address that ends in `#R2` opens on requirement R2.
    """
    panels = panels_of(content)
    requirement, attempt = opening(content.run.report)
    first = next(panel for panel in panels if panel.id == panel_id(requirement, attempt))
    sections = [panel_section(panel, panels, content) for panel in panels]
    samples = content.run.samples
    view = whole_run(content.run.report, samples[0].t if samples else content.run.report.origin)
    sentence = headline(content.run.name, first, content.run.report.origin)
    body = (
        overview(content, panels, view),
        e("main", {"data-open": first.id}, *sections, _aside(content, first)),
        data("run", script_data(content, panels, view)),
    )
    return page(sentence.replace("`", ""), body, styles=["base.css", "run.css"], scripts=["run.js"])


def _aside(content: RunPage, first: Panel) -> ET.Element:
    parts: list[Child] = []
    if content.scene is not None:
        parts.append(e("figure", {"class": "scene"}, scene_svg(content.scene, first.instant)))
    parts.append(
        e(
            "div",
            {"class": "command"},
            e("span", None, "see it again"),
            e("code", {"id": "command"}, *_words(content.command)),
            e("button", {"type": "button", "class": "copy"}, "copy"),
        )
    )
    facts: list[Child] = []
    for name, value in content.facts:
        facts += [e("dt", None, name), e("dd", None, value)]
    if facts:
        parts.append(e("dl", {"class": "facts"}, *facts))
    parts.append(_health(content))
    return e("aside", None, *parts)


def _words(command: str) -> list[Child]:
    """A command that breaks anywhere but within an option."""
    words: list[Child] = []
    for word in command.split(" "):
        words += [e("span", None, word) if word.startswith("-") else word, " "]
    return words[:-1]


def _health(content: RunPage) -> ET.Element | None:
    findings = []
    for one in content.run.report.health:
        times = "" if one.count == 1 else f", {one.count} times"
        remark = f": {one.remark}" if one.remark else ""
        findings.append(
            e("li", None, e("code", None, one.name), f" {one.kind.value}{times}{remark}")
        )
    findings += [e("li", None, str(one)) for one in content.run.report.illegal]
    if not findings:
        return None
    return e("div", {"class": "health"}, e("h2", None, "Input health"), e("ul", None, *findings))


READ_OUT = 2_000
"""Values of a track that the cursor can read out, at most."""


def script_data(content: RunPage, panels: Sequence[Panel], view: View) -> dict[str, object]:
    """All of it, as JSON can hold it; times are seconds since the origin."""
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
    inside = [change for change in track.changes if view.start < change[0] <= view.end]
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
    """JSON knows no infinity."""
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
