"""What the script of a run's page needs: values under the cursor, frames of the scene."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rvmon.report.panel import Panel
from rvmon.report.run_page import RunPage
from rvmon.report.scene_html import scene_data
from rvmon.report.tracks import Track, TrackKind
from rvmon.report.view import View
from rvmon.trace.sample import Scalar
from rvmon.trace.time import TICKS_PER_SECOND

READ_OUT = 2_000
"""Values of a track that the cursor can read out, at most."""


def script_data(content: RunPage, panels: Sequence[Panel]) -> dict[str, object]:
    """All of it, as JSON can hold it; times are seconds since the origin."""
    origin = content.run.report.origin
    document: dict[str, object] = {
        "panels": {panel.id: _panel_data(panel, origin) for panel in panels}
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
