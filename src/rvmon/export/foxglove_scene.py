"""A scene as messages that Foxglove draws.

Source: the schema `foxglove.SceneUpdate`,
https://docs.foxglove.dev/docs/visualization/message-schemas/scene-update.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from rvmon.report.scene import Outline, Scene
from rvmon.trace.time import TICKS_PER_SECOND

SCENE = "/rvmon/scene"
"""Its topic."""

_THIN = 0.006
"""Metres: how thick the line about a polygon is at least."""

_LINE_STRIP, _LINE_LOOP = 0, 1

_COLOURS = {
    "link": (0.35, 0.5, 0.75),
    "gripper": (0.2, 0.3, 0.55),
    "piece": (0.95, 0.6, 0.1),
    "person": (0.85, 0.55, 0.45),
    "gaze": (0.9, 0.85, 0.3),
}
"""By role; what has none is grey."""


def scene_updates(scene: Scene) -> Iterator[tuple[int, dict[str, Any]]]:
    """Ticks and content of a message for each frame."""
    places = {name: place for place, name in enumerate(scene.bodies)}
    for t, flat in scene.frames:
        poses = {name: flat[3 * place : 3 * place + 3] for name, place in places.items()}
        found: dict[str, list[dict[str, Any]]] = {"lines": [], "spheres": []}
        for outline in scene.outlines:
            pose = _pose(*poses.get(outline.body, (0.0, 0.0, 0.0)))
            kind, drawn = _drawn(outline)
            found[kind].append({"pose": pose, "color": _colour(outline.role), **drawn})
        entity = {
            "timestamp": seconds_and_rest(t),
            "frame_id": "world",
            "id": "scene",
            "lifetime": seconds_and_rest(0),
            "frame_locked": False,
            **found,
        }
        yield t, {"deletions": [], "entities": [entity]}


def seconds_and_rest(ticks: int) -> dict[str, int]:
    """An instant as Foxglove's messages write it.

    >>> seconds_and_rest(1_500_000_000)
    {'sec': 1, 'nsec': 500000000}
    """
    seconds, rest = divmod(ticks, TICKS_PER_SECOND)
    return {"sec": seconds, "nsec": rest}


def _pose(x: float, z: float, angle: float) -> dict[str, Any]:
    """A body in the upright plane: its angle turns x to z."""
    turned = {"x": 0.0, "y": -math.sin(angle / 2), "z": 0.0, "w": math.cos(angle / 2)}
    return {"position": {"x": x, "y": 0.0, "z": z}, "orientation": turned}


def _drawn(outline: Outline) -> tuple[str, Mapping[str, Any]]:
    """A disc as a sphere, a bar and a polygon as lines."""
    if len(outline.corners) == 1:
        return "spheres", {"size": dict.fromkeys("xyz", 2 * outline.radius)}
    return "lines", {
        "type": _LINE_STRIP if len(outline.corners) == 2 else _LINE_LOOP,
        "thickness": max(2 * outline.radius, _THIN),
        "scale_invariant": False,
        "points": [{"x": x, "y": 0.0, "z": z} for x, z in outline.corners],
        "colors": [],
        "indices": [],
    }


def _colour(role: str) -> dict[str, float]:
    return dict(zip("rgba", (*_COLOURS.get(role, (0.6, 0.6, 0.6)), 1.0), strict=True))
